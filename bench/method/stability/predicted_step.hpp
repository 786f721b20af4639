#pragma once
/// The longest step with which small disturbances of a state die out, predicted: the step as a linear map of the linearised equations of
/// motion (step_map.hpp), chain, shafts, sheaves, cylinders, governor and control alike.

#include "bench/method/product_names.hpp"
#include "bench/method/stability/linear_chain.hpp"
#include "bench/method/stability/step_limit.hpp"
#include "tasks/method/method.hpp"

namespace cvtflow::bench {

/// @param expected start of the search; 0: the estimate of StepLimitBound [s]
[[nodiscard]] StepLimit predicted_step_limit(const LinearChain& chain, const Method& method, double expected = 0.0);
/// For one method.
[[nodiscard]] StepLimit predicted_step_limit(const model::Variator& variator, const model::Parameters& parameters, const Method& method,
                                             const FrozenStart& start);

/// Largest multiplier of a step of that length, 1 for what neither grows nor dies out; infinite if the method refuses it. A tenth of the
/// work of a limit. h [s]
[[nodiscard]] double predicted_growth(const LinearChain& chain, const Method& method, double h);

}  // namespace cvtflow::bench
