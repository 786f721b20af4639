#pragma once
/// What a run reports of couplings and hydraulics: the parts of a machine that its shafts and sheaves are driven by.

#include "tasks/run/run.hpp"

namespace cvtflow::tasks {

/// Of the coupled shafts, as they are now.
[[nodiscard]] std::vector<CouplingReport> couplings_of(const Simulation& simulation);

/// Lines of the summary; empty without couplings and hydraulics.
[[nodiscard]] std::string outside_lines(const RunReport& report);

}  // namespace cvtflow::tasks
