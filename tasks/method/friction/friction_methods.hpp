#pragma once
/// Methods that take friction apart from all other forces.

#include <string>
#include <string_view>
#include <vector>

#include "tasks/method/friction/additive/additive_table.hpp"
#include "tasks/method/friction/implicit_leapfrog.hpp"
#include "tasks/method/friction/staged/kick_tables.hpp"
#include "tasks/method/method_choice.hpp"
#include "tasks/method/program_stability.hpp"

namespace cvtflow::tasks {

[[nodiscard]] std::vector<MethodProgram> friction_methods();
/// The same method with all of its numbers in double precision: the name itself, but for those whose stages are in single.
[[nodiscard]] std::string in_double_precision(std::string_view method);

[[nodiscard]] ProgramStability leapfrog_stability(Kick kick);
[[nodiscard]] ProgramStability leapfrog_stability(const DirkTable& table);
[[nodiscard]] ProgramStability additive_stability(const AdditiveTable& table);

}  // namespace cvtflow::tasks
