#pragma once
/// Methods that take friction apart from all other forces.

#include <vector>

#include "tasks/method/method_choice.hpp"

namespace cvtflow::tasks {

[[nodiscard]] std::vector<MethodProgram> friction_methods();

}  // namespace cvtflow::tasks
