#pragma once
/// How fast threads meet.

namespace cvtflow::bench {

/// Time of one cycle of threads that meet, do nothing, and meet again, without yielding: median over batches of 64 cycles [s]. A lower
/// bound for every executor on a quiet machine.
/// @param threads the calling one included   @param seconds after which no further batch begins
/// @param longest_wait for another thread [s]
/// @return infinite if the threads cannot be started, or one of them lets the caller wait for longer
[[nodiscard]] double bare_barrier_cycle(int threads, double seconds, double longest_wait) noexcept;

}  // namespace cvtflow::bench
