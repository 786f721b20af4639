#pragma once
/// Variables of an FMU: the catalogues of inputs, channels and parameters, numbered.

#include <cstdint>
#include <cvtflow/cvtflow.hpp>
#include <optional>
#include <string>
#include <vector>

namespace cvtflow::tools {

struct FmuVariable {
    std::uint32_t reference = 0;
    std::string kind;  ///< "time", "input", "output", "parameter"
    std::string name;  ///< as importers see it, structured: shaft_1.speed; elements are links.tension[0], …
    std::string unit;
    std::string description;
    std::size_t width = 1;
    double start = 0.0;
    std::string source;                        ///< name inside: shaft_1/speed
    std::size_t element = 0;                   ///< of the source
    std::optional<double> min = {}, max = {};  ///< range that is allowed [unit]
    double nominal = 0.0;                      ///< order of magnitude, a power of ten; 0: unknown [unit]
    std::string display_unit{};                ///< that people use; empty: the unit itself
};

/// Names; "all" alone: every one that has one number.
struct FmuChoice {
    std::vector<std::string> inputs;      ///< empty: all that the scene has
    std::vector<std::string> outputs;     ///< channels; empty: a dozen
    std::vector<std::string> parameters;  ///< keys; empty: a dozen
};

/// @param arrays whether variables may be arrays (FMI 3), else each element is a variable. @throws UsageError for unknown names
[[nodiscard]] std::vector<FmuVariable> fmu_variables(Simulation& simulation, const FmuChoice& choice, bool arrays);

/// The resource that an FMU reads them from (api/fmi/variables.hpp).
[[nodiscard]] std::string variables_text(const std::vector<FmuVariable>& variables);

}  // namespace cvtflow::tools
