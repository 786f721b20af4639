#pragma once
/// A scene as readable text: its detail, its machine in figures of the design, and what files made from it contain about it.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/record/run/schema.hpp"
#include "tasks/scene/scene.hpp"

namespace cvtflow::tools {

/// `fine (every plate, 3 joint points, elastic pulleys), piecewise friction`; without a name if no preset matches.
[[nodiscard]] std::string detail_text(const tasks::Scene& scene);

/// Texts unchanged, reals with 6 digits.
[[nodiscard]] std::string value_text(const engine::Attribute& attribute);
/// An attribute's text, or a placeholder.
[[nodiscard]] std::string text_of(const std::vector<engine::Attribute>& attributes, std::string_view name,
                                  const std::string& otherwise = "unknown");
/// Step of a record or state: "2 us", "auto (2 us)", "2.1 us (2 us taken)"; of files without the step that was taken "auto".
/// @param taken 0: not known [s]   @param setting run.step; 0: automatic [s]
[[nodiscard]] std::string step_text(double taken, double setting);
/// Step of a record, which contains run.step.
[[nodiscard]] std::string step_text(const std::vector<engine::Attribute>& attributes);
/// The scene of a text in a file, its start state not read; none if there is no text, or this program cannot read it.
[[nodiscard]] std::optional<tasks::Scene> scene_in(const std::string* text);

/// Lines of `check`: running radii, arcs, frequency of passing pins, found gains. Empty without pulleys.
[[nodiscard]] std::string machine_lines(const tasks::Scene& scene);

}  // namespace cvtflow::tools
