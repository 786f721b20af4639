#pragma once
/// What a TOML document must not be before its library sees it: that calls itself once for every part of a key and level of a value.

#include <optional>

#include "tasks/scene/toml/toml_tree.hpp"

namespace cvtflow::tasks {

/// The first excess, in one pass without memory of its own. Knows no more of the grammar than what is text and what is not.
[[nodiscard]] std::optional<Problem> beyond_limits(const std::string& text);

}  // namespace cvtflow::tasks
