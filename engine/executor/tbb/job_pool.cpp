#include "engine/executor/tbb/job_pool.hpp"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <system_error>

#include "engine/executor/tbb/tbb_section.hpp"
#include "engine/thread/floating_mode.hpp"
#include "engine/thread/pinning.hpp"
#include "engine/thread/worker_threads.hpp"

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

WriterThread::WriterThread(std::size_t slots, std::size_t row_bytes, std::function<void(std::span<const std::byte>)> write)
    : ring_(slots, std::vector<std::byte>(row_bytes)), current_(row_bytes), write_(std::move(write)) {
    try {
        thread_ = std::thread([this] { work(); });
    } catch (const std::system_error&) {
        note_shortage(2, 1);  // written by the thread that posts a row
    }
}

WriterThread::~WriterThread() { stop(); }

void WriterThread::work() {
    std::unique_lock hold(mutex_);
    for (;;) {
        changed_.wait(hold, [&] { return count_ > 0 || ending_; });
        if (count_ == 0) return;
        current_.swap(ring_[first_]);
        first_ = (first_ + 1) % ring_.size();
        --count_;
        changed_.notify_all();
        if (error_) continue;  // rows after a failure are dropped: their cases count as not done
        hold.unlock();
        std::exception_ptr failed;
        try {
            write_(current_);
        } catch (...) {
            failed = std::current_exception();
        }
        hold.lock();
        if (failed) error_ = failed;
    }
}

void WriterThread::post(std::span<const std::byte> row) {
    std::unique_lock hold(mutex_);
    changed_.wait(hold, [&] { return count_ < ring_.size() || error_; });
    if (error_) std::rethrow_exception(error_);
    if (!thread_.joinable()) return write_here(row);
    std::copy(row.begin(), row.end(), ring_[(first_ + count_) % ring_.size()].begin());
    ++count_;
    changed_.notify_all();
}

/// Writes one row, under the lock, in the order in which they come.
void WriterThread::write_here(std::span<const std::byte> row) {
    try {
        write_(row);
    } catch (...) {
        error_ = std::current_exception();
        throw;
    }
}

void WriterThread::stop() noexcept {
    {
        const std::lock_guard hold(mutex_);
        ending_ = true;
        changed_.notify_all();
    }
    if (thread_.joinable()) thread_.join();
}

void WriterThread::finish() {
    stop();
    if (error_) std::rethrow_exception(error_);
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
