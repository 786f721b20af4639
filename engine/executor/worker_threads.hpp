#pragma once
/// Threads that outlive runs: oneTBB keeps its workers for the next arena.

namespace cvtflow::engine {

/// Ends oneTBB's workers and waits until they are gone; the next run starts new ones. To be called while no run is under way.
/// @return false if somebody else in this process keeps them: another thread that has used oneTBB and lives on, or a global_control
[[nodiscard]] bool end_worker_threads() noexcept;

}  // namespace cvtflow::engine
