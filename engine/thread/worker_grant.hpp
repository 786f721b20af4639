#pragma once
/// How many threads the system has for us: asked before a runtime begins to start its own, because oneTBB and OpenMP take a refusal badly
/// (a crash in the graph's destructor, uncaught exceptions in workers, exit(1)). Private to engine and to the measurements of bench.

namespace cvtflow::engine {

/// Starts that many threads at once and lets them go. @return how many of them began
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
    /// oneTBB was refused what had just been there: it will start nothing more in this process.
    void refused() noexcept;

private:
    int requested_;
    int workers_ = 0;
    bool fresh_ = false;
};

/// Whether oneTBB was refused a thread: it then waits forever for workers that never began.
[[nodiscard]] bool workers_were_refused() noexcept;
/// Workers have ended; the next request is tried again.
void forget_workers() noexcept;

/// Number of members of an OpenMP team that may be requested: its runtime keeps a team for every thread that ever began one.
[[nodiscard]] int team_grant(int threads) noexcept;

/// Remembers the largest shortage for thread_shortage().
void note_shortage(int requested, int had) noexcept;

}  // namespace cvtflow::engine
