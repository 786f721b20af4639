#pragma once
/// modelDescription.xml of an FMU, for both versions of the standard.

#include <string>
#include <vector>

#include "tools/program/output/fmu/fmu_variables.hpp"

namespace cvtflow::tools {

struct FmuFacts {
    std::string name;         ///< of the scene
    std::string identifier;   ///< of the library inside: a name in C
    std::string token;        ///< that tells this FMU from others
    std::string description;  ///< one line
    std::string author;       ///< empty: not stated
    std::string date;         ///< of generation, UTC, ISO 8601; empty: unknown
    double until = 0.0;       ///< of the default experiment [s]
};

[[nodiscard]] std::string model_description_2(const FmuFacts& facts, const std::vector<FmuVariable>& variables);
[[nodiscard]] std::string model_description_3(const FmuFacts& facts, const std::vector<FmuVariable>& variables);

/// terminalsAndIcons/terminalsAndIcons.xml: a bus for each shaft, with its inputs and with the outputs whose names begin with it. Empty if
/// no variable belongs to a shaft.
[[nodiscard]] std::string terminals_text(const std::vector<FmuVariable>& variables);

}  // namespace cvtflow::tools
