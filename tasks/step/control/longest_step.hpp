#pragma once
/// The longest step that is ever chosen where steps are automatic.

#include "model/parameters/parameters.hpp"
#include "tasks/step/control/step_choice.hpp"

namespace cvtflow::tasks {

/// Of halves StepChoice::longest_step. Whole pins have no stiff friction in joints that a step could leave something of: at 2.5 us slip,
/// tensions and losses are those at 1.4 us to a thousandth (decision 84) [s].
[[nodiscard]] inline double longest_automatic_step(model::PinDetail pins) noexcept {
    return pins == model::PinDetail::whole ? 2.5e-6 : StepChoice::longest_step;
}

}  // namespace cvtflow::tasks
