#pragma once
/// Inputs as a request to the Python package describes them: facts that this program alone knows. Numbers of records Python reads itself.

#include <nlohmann/json_fwd.hpp>

#include "tools/program/view/recorded_run.hpp"
#include "tools/program/view/sweep_view.hpp"

namespace cvtflow::tools {

/// Name and unit by name of channel, in which quantities are shown; which channels there are; sums of quotients.
[[nodiscard]] nlohmann::json known_json();
/// "file", "path", "name", "scene" (values by key in SI, null if it cannot be read), "texts" (the same, readable).
[[nodiscard]] nlohmann::json described(const RecordedRun& run);
/// "path", "name", "level", "columns" with "values" in SI, "limits": the load of safety factor 1 by case [N*m], null where there is none.
[[nodiscard]] nlohmann::json described(const SweepView& sweep);
/// "path", "name", "columns" with "values" in SI.
[[nodiscard]] nlohmann::json described(const Measured& measured);

/// Name of the first of a request's "records" or "sweeps", by which a picture or page is known.
[[nodiscard]] std::string subject_of(const nlohmann::json& request);

}  // namespace cvtflow::tools
