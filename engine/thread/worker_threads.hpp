#pragma once
/// Threads that outlive runs (oneTBB keeps its workers for the next arena), and shortages of threads.

namespace cvtflow::engine {

/// Ends oneTBB's workers and waits until they are gone; the next run starts new ones. To be called while no run is under way.
/// @return false if another user in this process keeps them: another thread that has used oneTBB and lives on, or a global_control
[[nodiscard]] bool end_worker_threads() noexcept;

/// Of this process: a process that is forked off has another one, and none of the threads.
[[nodiscard]] long process_number() noexcept;

/// The system would not start as many threads as a run wanted, which then had fewer, down to the caller alone. Results do not depend on it.
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

}  // namespace cvtflow::engine
