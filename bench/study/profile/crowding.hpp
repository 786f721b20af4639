#pragma once
/// How much of a machine is ours just now: what every measurement of threads has to know.

namespace cvtflow::bench {

/// Number of processors that threads get, from the work that they do for `seconds`: each counts short pieces of arithmetic, and the number
/// of pieces times the time of the quickest is the time that its thread had a processor of full speed to itself. `threads` on a quiet
/// machine; less where others run, where a host takes time away, or where there are fewer processors. [1]
/// @throws std::runtime_error if the system has no threads for it
[[nodiscard]] double processors_got(int threads, double seconds);

/// Fraction of the requested processors below which a machine counts as crowded: speed-ups cannot be measured on it.
inline constexpr double crowded_below = 0.9;

}  // namespace cvtflow::bench
