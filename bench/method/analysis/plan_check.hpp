#pragma once
/// Whether a table of stages can be executed. The product's are constant, and a test checks them; those of the laboratory are checked where
/// their order is derived.

#include "engine/method/stage_plan.hpp"

namespace cvtflow::bench {

/// Rejects a plan that cannot be executed, or whose result would depend on how the state is cut into segments:
/// slots out of range, sums of state factors other than 1 (error: 0) by more than 1e-12, slots read before they are written, slots written
/// in the stage that reads them (a neighbour's halo is combined from the old contents at the same time), and writes to the two slots 0.
/// @throws std::invalid_argument naming plan and stage
void validate(const engine::StagePlan& plan);

}  // namespace cvtflow::bench
