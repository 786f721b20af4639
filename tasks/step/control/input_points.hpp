#pragma once
/// Times at which an input may jump or bend.

#include "model/force/pulley.hpp"
#include "tasks/step/control/step_grid.hpp"
#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

/// First point after t of the tables of inputs that are in use; infinite: none. Between two points inputs are smooth in time. t [s]
[[nodiscard]] double next_input_point(const model::Parameters& parameters, const model::HeldInputs& held, double t) noexcept;

/// End of a step that begins now: the grid's next point, or a point of an input's table before it [s]. Inputs may jump at such points, and
/// their works are exact only where they are linear over a step. Reports a point that is now to the energy ledger: a fast transient may
/// follow.
[[nodiscard]] double next_step_end(Workspace& workspace, const StepGrid& grid) noexcept;

}  // namespace cvtflow::tasks
