#pragma once
/// The longest step with which small disturbances of a state die out, measured on the step that the simulation takes (real_step.hpp).

#include <string_view>

#include "tasks/scene/scene.hpp"
#include "tasks/step/integration_state.hpp"

namespace cvtflow::bench {

struct MeasuredLimit {
    double step = 0.0;     ///< longest stable one; infinite if longest_tried is [s]
    bool refused = false;  ///< longer ones are not unstable: the method does not take them
};
/// A step is unstable if disturbances of three states in a row grow: at a single state a contact may reach its kink within the step, which
/// linear stability does not cover.
/// @param expected where the search begins [s]; infinite: at lengths up to longest_tried
[[nodiscard]] MeasuredLimit measured_step_limit(const tasks::Scene& scene, std::string_view method, const tasks::FrozenStart& start,
                                                double expected);

}  // namespace cvtflow::bench
