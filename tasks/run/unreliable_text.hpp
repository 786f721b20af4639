#pragma once
/// What is said of a run whose energy balance does not close, and of one that warms.

#include <string>

#include "model/machine/heat_balance.hpp"
#include "tasks/scene/scene.hpp"

namespace cvtflow::tasks {

/// One line, with what to do about it. @param suspicion EnergyLedger::suspicion(), above 1   @param setting run.step   @param step the last
/// one that was chosen [s]
[[nodiscard]] std::string unreliable_text(double suspicion, const AutoNumber& setting, double step);

/// A line about temperatures and where heat went; empty without a heat balance.
[[nodiscard]] std::string heat_text(const model::HeatBalance& heat);

}  // namespace cvtflow::tasks
