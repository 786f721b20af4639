#pragma once
/// The longest step with which small disturbances of a state die out, predicted and measured.
///
/// Predicted: the step as a linear map of the linearised equations of motion (step_map.hpp), chain, shafts, sheaves, cylinders, governor and control alike.
/// Measured: the step that the simulation takes (real_step.hpp). Both look for the step at which the largest multiplier passes 1 (growth.hpp).

#include <string_view>

#include "tasks/scene/scene.hpp"
#include "tasks/stability/linear_chain.hpp"
#include "tasks/step_limit.hpp"

namespace cvtflow::tasks {

/// Growth in a step that still counts as none.
inline constexpr double tolerated_growth = 1e-3;
/// A method that its test equation sets no limit, and that is stable with this, is said to be stable with any step: beyond, what grows by itself grows
/// so much in a step that it looks like the method's doing [s].
inline constexpr double longest_tried = 8e-6;

/// @param expected where to begin to look; 0: where StepLimitBound says [s]
/// @throws std::invalid_argument for a name that is no method's
[[nodiscard]] StepLimit predicted_step_limit(const LinearChain& chain, std::string_view method, double expected = 0.0);
/// For one method.
[[nodiscard]] StepLimit predicted_step_limit(const model::Variator& variator, const model::Parameters& parameters, std::string_view method, const FrozenStart& start);

/// Largest multiplier of a step of that length, 1 for what neither grows nor dies out; infinite if the method refuses it. A tenth of the work of a limit.
[[nodiscard]] double predicted_growth(const LinearChain& chain, std::string_view method, double h);

struct MeasuredLimit {
    double step = 0.0;       ///< longest stable one; infinite if longest_tried is [s]
    bool refused = false;    ///< longer ones are not unstable: the method does not take them
};
/// Unstable is a step after which disturbances of three states in a row have grown: at one alone a contact may come to its kink within the step, which
/// is not what linear stability speaks of.
/// @param expected where to begin to look [s]; infinite: at lengths up to longest_tried
[[nodiscard]] MeasuredLimit measured_step_limit(const Scene& scene, std::string_view method, const FrozenStart& start, double expected);

}  // namespace cvtflow::tasks
