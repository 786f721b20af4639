#pragma once
/// Several equal steps of one method as one step of another.

#include "engine/method/stage_plan.hpp"

namespace cvtflow::engine {

/// `count` steps of h/count in a row. Order stays, the stability region grows by count. Without error estimate.
/// @throws std::invalid_argument for count < 1
[[nodiscard]] StagePlan repeated(const StagePlan& plan, int count);

}  // namespace cvtflow::engine
