#pragma once
/// Description of a method that is a table of stages.

#include <string>

#include "engine/method/stage_plan.hpp"

namespace cvtflow::bench {

/// Lines with everything that is derived from the table: stages, order, stability, growth and gain, error estimate.
/// @param length growth and gain are measured on [-length, 0]; 0: on the real interval of stability
[[nodiscard]] std::string method_figures(const engine::StagePlan& plan, double length = 0.0);

/// The table itself, a line per stage.
[[nodiscard]] std::string method_table(const engine::StagePlan& plan);

}  // namespace cvtflow::bench
