#pragma once
/// Stage states where kernels that work by ranges of links read them.

#include "tasks/workspace.hpp"

namespace cvtflow::tasks {

/// States of links first - 1 … last of a segment in a state vector, in the segment's window.
[[nodiscard]] const double* window_of(Workspace& workspace, const double* state, int segment) noexcept;

}  // namespace cvtflow::tasks
