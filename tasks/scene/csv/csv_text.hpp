#pragma once
/// CSV as text: cells of lines, names and units of headings.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace cvtflow::tasks {

inline constexpr std::uint64_t longest_csv = std::uint64_t{64} << 20U;  ///< a million rows of six numbers [byte]

/// Without white space around it.
[[nodiscard]] std::string trimmed(std::string_view text);

/// Lines of cells, blank ones and white space too; a cell in double quotes may hold commas and line breaks, and "" for a quote. Carriage
/// returns are left out.
[[nodiscard]] std::vector<std::vector<std::string>> csv_lines(std::string_view text);

/// A cell as it is written: quoted where it must be (or always), control characters spelt out. A text that a spreadsheet would take for a
/// formula, since it begins with = + - or @, gets an apostrophe in front; numbers stay as they are.
[[nodiscard]] std::string csv_cell(std::string_view text, bool is_text, bool quoted = false);

/// Cells of one line, trimmed.
[[nodiscard]] std::vector<std::string> cells_of(const std::string& line);

/// Whether a line holds nothing but a comment (#) or white space.
[[nodiscard]] bool is_blank(const std::string& line);

/// A heading such as `load.torque [N*m]`.
struct Heading {
    std::string name, unit;  ///< unit is empty where there is none in brackets
};
[[nodiscard]] Heading heading_of(const std::string& cell);

}  // namespace cvtflow::tasks
