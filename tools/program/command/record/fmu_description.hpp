#pragma once
/// Description of an FMU: its variables, from the catalogues of inputs, channels and parameters, and modelDescription.xml for both versions
/// of the standard.

#include <cstdint>
#include <cvtflow/cvtflow.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cvtflow::tools {

struct FmuVariable {
    std::uint32_t reference = 0;
    std::string kind;  ///< "time", "input", "output", "parameter"; "flag": a Boolean output
    std::string name;  ///< structured name, as importers see it: shaft_1.speed; elements are links.tension[0], …
    std::string unit;
    std::string description;
    std::size_t width = 1;
    double start = 0.0;
    std::string source;                        ///< name inside: shaft_1/speed
    std::size_t element = 0;                   ///< element of the source
    std::optional<double> min = {}, max = {};  ///< range that is allowed [unit]
    double nominal = 0.0;                      ///< order of magnitude, a power of ten; 0: unknown [unit]
    std::string display_unit{};                ///< usual unit; empty: `unit`
};

/// Names; "all" alone: every one that has one number.
struct FmuChoice {
    std::vector<std::string> inputs;      ///< empty: all that the scene has
    std::vector<std::string> outputs;     ///< channels; empty: a dozen
    std::vector<std::string> parameters;  ///< keys; empty: a dozen
};

/// @param arrays whether variables may be arrays (FMI 3), else each element is a variable. @throws UsageError for unknown names
[[nodiscard]] std::vector<FmuVariable> fmu_variables(Simulation& simulation, const FmuChoice& choice, bool arrays);

/// Resource from which an FMU reads its variables (api/fmi/fmi.hpp).
[[nodiscard]] std::string variables_text(const std::vector<FmuVariable>& variables);

struct FmuFacts {
    std::string name;                       ///< name of the scene
    std::string identifier;                 ///< name of the library inside, valid in C
    std::string token;                      ///< unique to this FMU
    std::string description;                ///< one line
    std::string author;                     ///< empty: not stated
    std::string date;                       ///< date of generation, UTC, ISO 8601; empty: unknown
    double until = 0.0;                     ///< end of the default experiment [s]
    bool vehicle = false;                   ///< the scene has a vehicle
    std::vector<std::string> sources = {};  ///< files to compile, relative to sources/; empty: the FMU has no sources
};

[[nodiscard]] std::string model_description_2(const FmuFacts& facts, const std::vector<FmuVariable>& variables);
[[nodiscard]] std::string model_description_3(const FmuFacts& facts, const std::vector<FmuVariable>& variables);

/// Options that compile the sources to the bits of the libraries; one line.
inline constexpr std::string_view compiler_options =
    "-std=c++20 -O3 -DNDEBUG -fPIC -fvisibility=hidden -ffp-contract=off -fno-math-errno -fno-trapping-math";
/// sources/buildDescription.xml of FMI 3; 2.0 has the files in its description.
[[nodiscard]] std::string build_description(const FmuFacts& facts);

/// terminalsAndIcons/terminalsAndIcons.xml: the icon, and a bus for each shaft, with its inputs and with the outputs whose names begin with
/// it.
[[nodiscard]] std::string terminals_text(const std::vector<FmuVariable>& variables);

/// SOURCE_DATE_EPOCH [s since 1970], else the date of the commit that this program was built from: UTC, ISO 8601. Empty if neither is
/// known.
/// @throws UsageError for a SOURCE_DATE_EPOCH that is no number of seconds
[[nodiscard]] std::string generation_date();

}  // namespace cvtflow::tools
