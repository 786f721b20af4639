#include "engine/thread/worker_threads.hpp"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/version.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <latch>
#include <mutex>
#include <thread>
#include <vector>

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
