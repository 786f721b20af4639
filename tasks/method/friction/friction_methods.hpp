#pragma once
/// Methods that take friction apart from all other forces.

#include <string>
#include <string_view>
#include <vector>

#include "tasks/method/method_choice.hpp"

namespace cvtflow::tasks {

[[nodiscard]] std::vector<MethodProgram> friction_methods();
/// The same method with all of its numbers in double precision: the name itself, but for those whose stages are in single.
[[nodiscard]] std::string in_double_precision(std::string_view method);

}  // namespace cvtflow::tasks
