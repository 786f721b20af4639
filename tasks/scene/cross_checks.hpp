#pragma once
/// Conditions that the values of a scene must satisfy together.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tasks/scene/scene.hpp"

namespace cvtflow::tasks {

struct CrossCheck {
    std::vector<std::string_view> keys;  ///< keys whose values are compared; a problem is reported at the first that the scene gives
    /// The violation (a full sentence with its key), or nothing. Expects every key to be in its own range.
    std::optional<std::string> (*violation)(const Scene&);
};

[[nodiscard]] std::span<const CrossCheck> cross_checks();

}  // namespace cvtflow::tasks
