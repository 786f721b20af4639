#pragma once
/// Threads that outlive runs (oneTBB keeps its workers for the next arena), how many of them the system has for us, and shortages.

#include <string>

namespace cvtflow::engine {

/// "2021.8, interface 12080" of the oneTBB in use, which may be newer than the one compiled against.
[[nodiscard]] std::string tbb_version();

/// Ends oneTBB's workers and waits until they are gone; the next run starts new ones. To be called while no run is under way.
/// @return false if another user in this process keeps them: another thread that has used oneTBB and lives on, or a global_control
[[nodiscard]] bool end_worker_threads() noexcept;

/// Identifies this process: a forked child has another number, and none of the threads.
[[nodiscard]] long process_number() noexcept;

/// The system did not start as many threads as a run requested, which then had fewer, down to the caller alone. Results do not depend on
/// it.
struct ThreadShortage {
    int requested = 0;  ///< 0: there has been no shortage
    int had = 0;        ///< the calling thread included

    /// Keeps the larger shortage.
    void note(int requested_now, int had_now) noexcept {
        if (requested_now - had_now > requested - had) *this = {requested_now, had_now};
    }
};

/// The largest shortage since the process began.
[[nodiscard]] ThreadShortage thread_shortage() noexcept;

/// Starts `count` threads at once and ends them. Called before a runtime starts threads, because oneTBB and OpenMP cannot handle a refusal
/// (a crash in the graph's destructor, uncaught exceptions in workers, exit(1)). @return number of threads that started
[[nodiscard]] int startable_threads(int count) noexcept;

/// A share of oneTBB's workers, which all runs of the process have together and which outlive them. Threads are tried only when more are
/// requested than ever before.
class WorkerGrant {
public:
    /// @param threads requested, the calling one included
    explicit WorkerGrant(int threads) noexcept;
    ~WorkerGrant();
    WorkerGrant(const WorkerGrant&) = delete;
    WorkerGrant& operator=(const WorkerGrant&) = delete;

    /// 1 … as many as requested.
    [[nodiscard]] int threads() const noexcept { return 1 + workers_; }
    /// Whether oneTBB may have to start workers for it.
    [[nodiscard]] bool fresh() const noexcept { return fresh_; }
    /// Call this after oneTBB failed to create a thread: it starts no further threads in this process.
    void refused() noexcept;

private:
    int requested_;
    int workers_ = 0;
    bool fresh_ = false;
};

/// Workers have ended; the next request is tried again.
void forget_workers() noexcept;

/// Remembers the largest shortage for thread_shortage().
void note_shortage(int requested, int had) noexcept;

}  // namespace cvtflow::engine
