#include "engine/executor/tbb/contention_backoff.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <ctime>

namespace cvtflow::engine {

namespace {

using std::chrono::nanoseconds;

nanoseconds wall_now() noexcept { return std::chrono::steady_clock::now().time_since_epoch(); }

}  // namespace

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
    const bool pushed = now.taken_away > begin_.taken_away;  // a thread that slept of its own will lost nothing
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
