#include "engine/thread/backoff.hpp"

#include <sys/resource.h>
#include <algorithm>
#include <cstdint>
#include <ctime>
#include <thread>

#include "engine/thread/pinning.hpp"

namespace cvtflow::engine {

namespace {

using std::chrono::nanoseconds;

nanoseconds pauses(const ExecutorOptions& options) {
    if (options.threads > Processors().count()) return nanoseconds(0);
    if (options.spin >= 0.0) return nanoseconds(static_cast<std::int64_t>(1e3 * options.spin));
    switch (options.wait) {
        case Wait::spin: return std::chrono::milliseconds(2);
        case Wait::balanced: return std::chrono::microseconds(20);
        case Wait::passive: return std::chrono::microseconds(5);
    }
    return nanoseconds(0);
}

nanoseconds wall_now() noexcept { return std::chrono::steady_clock::now().time_since_epoch(); }

}  // namespace

Backoff::Backoff(const ExecutorOptions& options)
    : max_pauses_(pauses(options)),
      yields_(options.wait == Wait::passive ? nanoseconds(std::chrono::microseconds(100)) : nanoseconds::max()) {}

void Backoff::rest(nanoseconds waited) const noexcept {
    if (waited < pauses_) {
        for (int i = 0; i < 4; ++i) pause();
    } else if (waited - pauses_ < yields_) {
        std::this_thread::yield();
    } else {
        std::this_thread::sleep_for(std::chrono::microseconds(50));
    }
}

void Backoff::learn(nanoseconds waited) noexcept {
    const nanoseconds min_growth = std::chrono::microseconds(1);
    pauses_ = waited > pauses_ ? pauses_ / 2 : std::min(max_pauses_, 2 * pauses_ + min_growth);
}

ProcessorUse ProcessorUse::now() noexcept {
    ProcessorUse use;
#if defined(RUSAGE_THREAD) && defined(CLOCK_THREAD_CPUTIME_ID)
    timespec processor{};
    rusage counts{};
    if (clock_gettime(CLOCK_THREAD_CPUTIME_ID, &processor) != 0 || getrusage(RUSAGE_THREAD, &counts) != 0) return use;
    use.processor = std::chrono::seconds(processor.tv_sec) + nanoseconds(processor.tv_nsec);
    use.taken_away = counts.ru_nivcsw;
#endif
    use.wall = wall_now();
    return use;
}

bool ContentionBackoff::due() noexcept { return wall_now() - begin_.wall >= window && due(ProcessorUse::now()); }

bool ContentionBackoff::due(const ProcessorUse& now) noexcept {
    const nanoseconds wall = now.wall - begin_.wall, lost = wall - (now.processor - begin_.processor);
    const bool pushed = now.taken_away > begin_.taken_away;  // a thread that slept lost nothing
    begin_ = now;
    if (pushed && lost > wall / 4) return true;
    undisturbed_ += wall;
    if (undisturbed_ > 2 * length_) length_ = shortest;
    return false;
}

void ContentionBackoff::returned(const ProcessorUse& now) noexcept {
    begin_ = now;
    undisturbed_ = {};
    length_ = std::min(longest, 2 * length_);
}

}  // namespace cvtflow::engine
