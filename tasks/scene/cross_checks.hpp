#pragma once
/// What the values of a scene must satisfy together.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tasks/scene/scene.hpp"

namespace cvtflow::tasks {

struct CrossCheck {
    std::vector<std::string_view> keys;   ///< keys whose values are compared; a problem is reported at the first that the scene gives
    /// What is wrong (a full sentence with its key), or nothing. Expects every key to be in its own range.
    std::optional<std::string> (*violation)(const Scene&);
};

[[nodiscard]] std::span<const CrossCheck> cross_checks();

/// Running radii r1 (driving) and r2 = ratio r1 [m] on which a belt of length `length` [m] runs around shafts `centre_distance` [m] apart:
/// L = 2 a cos f + π (r1 + r2) + 2 f (r2 - r1), sin f = (r2 - r1)/a. Empty if there are none with r1 + r2 < a.
struct BeltRadii {
    double driving;
    double driven;
};
[[nodiscard]] std::optional<BeltRadii> belt_radii(double length, double centre_distance, double ratio) noexcept;

}  // namespace cvtflow::tasks
