#pragma once
/// Stability of the methods that take friction apart, on the damped oscillator.
///
/// Histories are part of the step: a leapfrog knows the elastic force of the step before. Stages of friction are as many as this
/// oscillator's own friction needs; in a chain the stiffest contact decides, and more stages allow softer ones longer steps than shown.

#include "tasks/method/friction/additive/additive_table.hpp"
#include "tasks/method/friction/implicit_leapfrog.hpp"
#include "tasks/method/friction/staged/kick_tables.hpp"
#include "tasks/method/program_stability.hpp"

namespace cvtflow::tasks {

[[nodiscard]] ProgramStability leapfrog_stability(Kick kick);
[[nodiscard]] ProgramStability leapfrog_stability(const DirkTable& table);
[[nodiscard]] ProgramStability additive_stability(const AdditiveTable& table);

}  // namespace cvtflow::tasks
