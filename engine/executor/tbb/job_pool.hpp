#pragma once
/// Independent jobs side by side on a separate arena: as many resident workers as threads, each asking for the next job until there is
/// none. One more thread writes what they hand over.

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <thread>
#include <vector>

#include "engine/thread/guards.hpp"

namespace cvtflow::engine {

/// Runs jobs on that many threads. Jobs may themselves run parallel executors: their arenas hire the threads that have left this one.
/// @param pin   whether each worker stays on a separate processor
/// @param next  called by one thread at a time; the number of a job, nothing when there is none any more for this worker
/// @param work  called by any worker 0 … threads - 1 for its job; what it throws ends the jobs and is thrown here
void run_jobs(int threads, bool pin, const std::function<std::optional<long>(int worker)>& next,
              const std::function<void(int worker, long job)>& work);

/// One thread that takes rows of bytes, in the order in which they come. At most `slots` wait; post() then blocks. Nothing is allocated
/// after construction. Where the system has no thread for it, post() writes.
class WriterThread {
public:
    /// @param write called on the writer's thread; what it throws comes out of the next post() or of finish(), and ends the writing
    WriterThread(std::size_t slots, std::size_t row_bytes, std::function<void(std::span<const std::byte>)> write);
    ~WriterThread();
    WriterThread(const WriterThread&) = delete;
    WriterThread& operator=(const WriterThread&) = delete;

    /// Copies the row. Any thread.
    void post(std::span<const std::byte> row);
    /// Waits until all rows are written and ends the thread.
    void finish();

private:
    void work();
    void write_here(std::span<const std::byte> row);
    void stop() noexcept;

    std::vector<std::vector<std::byte>> ring_;
    std::vector<std::byte> current_;
    std::size_t first_ = 0, count_ = 0;
    bool ending_ = false;
    std::exception_ptr error_;
    std::function<void(std::span<const std::byte>)> write_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::thread thread_;
};

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
