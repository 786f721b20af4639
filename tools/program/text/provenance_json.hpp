#pragma once
/// Provenance (program and machine) as JSON.

#include <nlohmann/json.hpp>
#include <string>

namespace cvtflow::tools {

[[nodiscard]] nlohmann::ordered_json provenance_json();
/// As a file: indented; numbers that are not finite are null.
[[nodiscard]] std::string json_text(const nlohmann::ordered_json& json);

}  // namespace cvtflow::tools
