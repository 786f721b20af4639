#pragma once
/// Both shafts as terminals of an FMU (FMI 3): what a tool connects in one go.

#include <string>
#include <vector>

#include "tools/program/output/fmu/fmu_variables.hpp"

namespace cvtflow::tools {

/// terminalsAndIcons/terminalsAndIcons.xml: a bus for each shaft, with its inputs and with the outputs whose names begin with it. Empty if
/// no variable belongs to a shaft.
[[nodiscard]] std::string terminals_text(const std::vector<FmuVariable>& variables);

}  // namespace cvtflow::tools
