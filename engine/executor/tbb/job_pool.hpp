#pragma once
/// Independent jobs side by side on a separate arena: as many resident workers as threads, each asking for the next job until there is
/// none.

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>

#include "engine/thread/guards.hpp"

namespace cvtflow::engine {

/// Runs jobs on that many threads. Jobs may themselves run parallel executors: their arenas hire the threads that have left this one.
/// @param pin   whether each worker stays on a separate processor
/// @param next  called by one thread at a time; the number of a job, nothing when there is none any more for this worker
/// @param work  called by any worker 0 … threads - 1 for its job; what it throws ends the jobs and is thrown here
void run_jobs(int threads, bool pin, const std::function<std::optional<long>(int worker)>& next,
              const std::function<void(int worker, long job)>& work);

/// Values that are computed once each, by the first thread that needs them; other threads wait.
class OnceEach {
public:
    /// @return true: the caller has to make it and call made(). false: it exists already, or was given up
    [[nodiscard]] bool claim(std::uint64_t key);
    void made(std::uint64_t key) noexcept;

private:
    std::map<std::uint64_t, bool> ready_;
    std::mutex mutex_;
    std::condition_variable changed_;
};

}  // namespace cvtflow::engine
