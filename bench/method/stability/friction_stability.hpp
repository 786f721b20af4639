#pragma once
/// The test equation of methods that take friction apart: an oscillator whose friction acts inside the step.

#include "bench/method/product_names.hpp"
#include "bench/method/stability/program_stability.hpp"
#include "tasks/method/friction/kick_tables.hpp"

namespace cvtflow::bench {

/// Friction in stages of RKC, of order 2, damped more than usual: less leaves friction forces behind, more costs stages.
extern const Kick rkc_kick;
inline constexpr double rkc_kick_damping = 10.0;  ///< [1]

[[nodiscard]] ProgramStability leapfrog_stability(const Kick& kick);
/// Stability with converged sweeps over contacts: friction by backward Euler on velocities.
[[nodiscard]] ProgramStability backward_euler_leapfrog_stability();
/// Of rigid pins: one implicit kick, all of it at the coordinates.
[[nodiscard]] ProgramStability rigid_leapfrog_stability();

}  // namespace cvtflow::bench
