#pragma once
/// Stability of the methods that solve with the whole state, with the exact Jacobian.

#include "tasks/method/implicit/linear_plan.hpp"
#include "tasks/method/program_stability.hpp"

namespace cvtflow::tasks {

[[nodiscard]] ProgramStability linear_stability(const LinearPlan& plan);
/// All variants converge to the same step.
[[nodiscard]] ProgramStability trapezoidal_stability();

}  // namespace cvtflow::tasks
