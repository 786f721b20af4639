#pragma once
/// Attributes of files as text, and the scene among them.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/record/run/schema.hpp"
#include "tasks/scene/scene.hpp"

namespace cvtflow::tools {

/// Texts unchanged, reals with 6 digits.
[[nodiscard]] std::string value_text(const engine::Attribute& attribute);
/// An attribute's text, or a placeholder.
[[nodiscard]] std::string text_of(const std::vector<engine::Attribute>& attributes, std::string_view name,
                                  const std::string& otherwise = "unknown");
/// The scene that a file was made from, its start state not read; none if this program cannot read it.
[[nodiscard]] std::optional<tasks::Scene> scene_in(const std::vector<engine::Attribute>& attributes, std::string_view name);

}  // namespace cvtflow::tools
