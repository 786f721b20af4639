#include "engine/executor/tbb/job_pool.hpp"

#include <oneapi/tbb/parallel_for.h>

#include <exception>

#include "engine/executor/tbb/tbb_section.hpp"
#include "engine/thread/floating_mode.hpp"
#include "engine/thread/pinning.hpp"

namespace cvtflow::engine {

void run_jobs(int threads, bool pin, const std::function<std::optional<long>(int)>& next, const std::function<void(int, long)>& work) {
    std::mutex mutex;
    std::exception_ptr error;
    const FloatingMode mode;
    const Processors processors;
    const auto worker = [&](int number) {
        const FloatingScope floating(mode);
        const Pin pinned(pin, processors, number);
        for (;;) {
            const std::optional<long> job = [&] {
                const std::lock_guard hold(mutex);
                return error ? std::nullopt : next(number);
            }();
            if (!job) return;
            try {
                work(number, *job);
            } catch (...) {
                const std::lock_guard hold(mutex);
                if (!error) error = std::current_exception();
            }
        }
    };
    TbbSection section(threads);
    section.execute([&](oneapi::tbb::task_group_context& context) {
        // One piece per worker; a worker that never arrives finds nothing left to do when its piece is run by another.
        oneapi::tbb::parallel_for(
            oneapi::tbb::blocked_range<int>(0, threads, 1),
            [&](const auto& range) {
                for (int number = range.begin(); number != range.end(); ++number) worker(number);
            },
            oneapi::tbb::simple_partitioner(), context);
    });
    if (error) std::rethrow_exception(error);
}

bool OnceEach::claim(std::uint64_t key) {
    std::unique_lock hold(mutex_);
    const auto [entry, is_first] = ready_.try_emplace(key, false);
    if (is_first) return true;
    const bool& ready = entry->second;
    changed_.wait(hold, [&ready] { return ready; });
    return false;
}

void OnceEach::made(std::uint64_t key) noexcept {
    const std::lock_guard hold(mutex_);
    if (const auto entry = ready_.find(key); entry != ready_.end()) entry->second = true;
    changed_.notify_all();
}

}  // namespace cvtflow::engine
