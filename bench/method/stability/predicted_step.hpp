#pragma once
/// The longest step with which small disturbances of a state die out, predicted: the step as a linear map of the linearised equations of
/// motion (step_map.hpp), chain, shafts, sheaves, cylinders, governor and control alike.

#include <functional>
#include <limits>

#include "bench/method/product_names.hpp"
#include "bench/method/stability/linear_chain.hpp"
#include "bench/method/stability/step_limit.hpp"
#include "tasks/method/method.hpp"

namespace cvtflow::bench {

// The search for the step at which disturbances begin to grow, by prediction and measurement alike.

/// Growth per step that still counts as none.
inline constexpr double growth_factor_tolerance = 1e-3;
/// A method without a limit on its test equation that is stable with this step counts as stable with any step: longer steps cannot
/// distinguish natural growth from instability [s].
inline constexpr double longest_tried = 8e-6;

/// First step tried of a method without limit [s].
inline constexpr double without_expectation = 1e-6;

/// Two steps, the longest stable and the shortest unstable one; infinite if none was unstable.
struct Bracket {
    double stable = 0.0, unstable = std::numeric_limits<double>::infinity();  ///< stable [s]
};

/// @param expected start of the search [s]; infinite or 0: at lengths up to longest_tried
[[nodiscard]] Bracket bracketed(double expected, const std::function<bool(double)>& stable);

/// @param expected start of the search; 0: the estimate of StepLimitBound [s]
[[nodiscard]] StepLimit predicted_step_limit(const LinearChain& chain, const Method& method, double expected = 0.0);
/// Limit of one method.
[[nodiscard]] StepLimit predicted_step_limit(const model::Variator& variator, const model::Parameters& parameters, const Method& method,
                                             const FrozenStart& start);

/// Largest multiplier of a step of that length, 1 for modes that neither grow nor decay; infinite if the method refuses it. A tenth of the
/// work of a limit. h [s]
[[nodiscard]] double predicted_growth(const LinearChain& chain, const Method& method, double h);

}  // namespace cvtflow::bench
