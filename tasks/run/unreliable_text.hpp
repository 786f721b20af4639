#pragma once
/// What is said of a run whose energy balance does not close.

#include <string>

#include "tasks/scene/scene.hpp"

namespace cvtflow::tasks {

/// One line, with what to do about it. @param suspicion EnergyLedger::suspicion(), above 1   @param setting run.step   @param step the last
/// one that was chosen [s]
[[nodiscard]] std::string unreliable_text(double suspicion, const AutoNumber& setting, double step);

}  // namespace cvtflow::tasks
