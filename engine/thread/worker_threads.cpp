#include "engine/thread/worker_threads.hpp"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/version.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <latch>
#include <limits>
#include <mutex>
#include <thread>
#include <vector>

#include "engine/thread/backoff.hpp"

namespace cvtflow::engine {

long process_number() noexcept { return getpid(); }

std::string tbb_version() { return std::string(TBB_runtime_version()) + ", interface " + std::to_string(TBB_runtime_interface_version()); }

namespace {

/// oneTBB's workers that this process has requested.
struct Workers {
    std::mutex mutex;
    int known = 0;   ///< number that could be started at once
    int in_use = 0;  ///< number in use by present runs
    bool refused = false;
    ThreadShortage shortage;
};

Workers& workers() noexcept {
    static Workers all;
    return all;
}

}  // namespace

int startable_threads(int count) noexcept {
    std::latch seen(1);
    int began = 0;
    std::vector<std::jthread> probes;
    try {
        probes.reserve(static_cast<std::size_t>(std::max(count, 0)));
        for (; began < count; ++began) probes.emplace_back([&seen] { seen.wait(); });
    } catch (const std::exception&) {
        // no more threads, or no memory for them: those that began are the answer
    }
    seen.count_down();
    return began;
}

namespace {

using Clock = std::chrono::steady_clock;

constexpr long batch = 64;

struct alignas(apart) Cycle {
    std::atomic<long> number{0};
};

/// Answers each cycle that is opened, until a negative number is.
void answer_cycles(const std::atomic<long>& opened, std::atomic<long>& answer) noexcept {
    for (long cycle = 1;; ++cycle) {
        long now = 0;
        while ((now = opened.load(std::memory_order_acquire)) >= 0 && now < cycle) {}
        if (now < 0) return;
        answer.store(cycle, std::memory_order_release);
    }
}

/// Threads that answer cycles leave at the end of its life.
struct Leaving {
    std::atomic<long>& opened;
    ~Leaving() { opened.store(-1, std::memory_order_release); }
};

/// @return whether it has reached the cycle within the longest wait
[[nodiscard]] bool reaches(const std::atomic<long>& other, long cycle, std::chrono::duration<double> longest_wait) noexcept {
    const auto polled = [&]() noexcept {
        constexpr int polls = 4096;  // without a reading of the clock, which would disturb what is measured
        for (int poll = 0; poll < polls; ++poll) {
            if (other.load(std::memory_order_acquire) >= cycle) return true;
        }
        return false;
    };
    if (polled()) return true;
    const auto begin = Clock::now();
    while (!polled()) {
        if (Clock::now() - begin >= longest_wait) return false;
    }
    return true;
}

}  // namespace

double bare_barrier_cycle(int threads, double seconds, double longest_wait) noexcept try {
    Cycle opened;
    std::vector<Cycle> answered(static_cast<std::size_t>(std::max(0, threads - 1)));
    std::vector<double> times;
    std::vector<std::jthread> others;
    const Leaving at_the_end{opened.number};
    for (Cycle& slot : answered) others.emplace_back([&opened, &slot] { answer_cycles(opened.number, slot.number); });
    const auto meet = [&](long cycle) {
        opened.number.store(cycle, std::memory_order_release);
        return std::ranges::all_of(
            answered, [&](const Cycle& other) { return reaches(other.number, cycle, std::chrono::duration<double>(longest_wait)); });
    };
    long cycle = 1;
    bool meeting = meet(cycle);  // all have begun
    const auto end = Clock::now() + std::chrono::duration<double>(seconds);
    while (meeting && (times.empty() || Clock::now() < end)) {
        const auto begin = Clock::now();
        for (const long last = cycle + batch; meeting && cycle < last;) meeting = meet(++cycle);
        times.push_back(std::chrono::duration<double>(Clock::now() - begin).count() / batch);
    }
    if (!meeting) return std::numeric_limits<double>::infinity();
    const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
    std::ranges::nth_element(times, middle);
    return *middle;
} catch (const std::exception&) {
    return std::numeric_limits<double>::infinity();  // no memory, or too few threads; those that began have left
}

WorkerGrant::WorkerGrant(int threads) noexcept : requested_(threads) {
    Workers& all = workers();
    const std::lock_guard hold(all.mutex);
    const int others = all.in_use, missing = others + threads - 1 - all.known;
    fresh_ = missing > 0 && !all.refused;
    if (fresh_) all.known += startable_threads(missing);
    workers_ = all.refused ? 0 : std::clamp(all.known - others, 0, threads - 1);
    all.in_use += workers_;
    if (workers_ + 1 < threads) all.shortage.note(threads, workers_ + 1);
}

WorkerGrant::~WorkerGrant() {
    const std::lock_guard hold(workers().mutex);
    workers().in_use -= workers_;
}

void WorkerGrant::refused() noexcept {
    Workers& all = workers();
    const std::lock_guard hold(all.mutex);
    all.in_use -= workers_;
    workers_ = 0;
    all.refused = true;
    all.shortage.note(requested_, 1);
}

void forget_workers() noexcept {
    const std::lock_guard hold(workers().mutex);
    workers().known = 0;
}

bool end_worker_threads() noexcept {
    {
        const std::lock_guard hold(workers().mutex);
        if (workers().refused) return false;  // oneTBB then waits forever for workers that never began
    }
    try {
        oneapi::tbb::task_scheduler_handle handle{oneapi::tbb::attach{}};
        if (!oneapi::tbb::finalize(handle, std::nothrow)) return false;
        forget_workers();
        return true;
    } catch (...) {
        return false;
    }
}

void note_shortage(int requested, int had) noexcept {
    const std::lock_guard hold(workers().mutex);
    workers().shortage.note(requested, had);
}

ThreadShortage thread_shortage() noexcept {
    const std::lock_guard hold(workers().mutex);
    return workers().shortage;
}

}  // namespace cvtflow::engine
