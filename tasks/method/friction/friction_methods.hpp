#pragma once
/// Methods that take friction apart from all other forces.

#include <string>
#include <string_view>
#include <vector>

#include "tasks/method/friction/kick_tables.hpp"
#include "tasks/method/method_choice.hpp"
#include "tasks/method/program_stability.hpp"

namespace cvtflow::tasks {

[[nodiscard]] std::vector<MethodProgram> friction_methods();
/// The same method with all of its numbers in double precision: the name itself, but for those whose stages are in single.
[[nodiscard]] std::string in_double_precision(std::string_view method);

[[nodiscard]] ProgramStability leapfrog_stability(Kick kick);
/// Of sweeps over contacts that have converged: friction by backward Euler on velocities.
[[nodiscard]] ProgramStability backward_euler_leapfrog_stability();

}  // namespace cvtflow::tasks
