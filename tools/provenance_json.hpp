#pragma once
/// Which program on which machine, as JSON.

#include <nlohmann/json.hpp>

namespace cvtflow::tools {

[[nodiscard]] nlohmann::ordered_json provenance_json();

}  // namespace cvtflow::tools
