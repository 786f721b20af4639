#pragma once
/// CSV as text: cells of lines, names and units of headings; and points of a time table from a CSV file: `{csv = "file.csv", time = "t",
/// value = "torque"}`. The first line of the file has the names of its columns, with a unit in brackets if the cells have none (`t [ms]`);
/// without time and value, the first two columns are taken.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/toml_tree.hpp"

namespace cvtflow::tasks {

inline constexpr std::uint64_t longest_csv = std::uint64_t{64} << 20U;  ///< a million rows of six numbers [byte]

/// Text without white space around it.
[[nodiscard]] std::string trimmed(std::string_view text);

/// Separator of the cells of a heading line: a semicolon if it has one, else a comma, else a tab if there is one.
[[nodiscard]] char csv_separator(std::string_view heading);

/// Lines of cells, blank ones and white space too; a cell in double quotes may hold separators and line breaks, and "" for a quote.
/// Carriage returns are left out. Where a comma does not separate, "12,5" is 12.5.
[[nodiscard]] std::vector<std::vector<std::string>> csv_lines(std::string_view text, char separator = ',');

/// The first number of a file where commas do not separate that can be read in two ways: "12,000" is 12 or 12000. One to three digits, a
/// comma (or point) and three digits, unless other numbers of the file show which of the two is its decimal mark. With its line.
[[nodiscard]] std::optional<Problem> doubtful_number(std::string_view text);

/// The one function that writes cells: quoted where separators of any country require it (or always), control characters spelt out. A text
/// that a spreadsheet would take for a formula, since it begins with = + - or @, gets an apostrophe in front; numbers stay as they are.
[[nodiscard]] std::string csv_cell(std::string_view text, bool is_text, bool quoted = false);

/// Cells of one line, trimmed.
[[nodiscard]] std::vector<std::string> cells_of(const std::string& line, char separator = ',');

/// Whether a line holds nothing but a comment (#) or white space.
[[nodiscard]] bool is_blank(const std::string& line);

/// A heading such as `load.torque [N*m]`.
struct Heading {
    std::string name, unit;  ///< unit is empty where there is none in brackets
};
[[nodiscard]] Heading heading_of(const std::string& cell);

/// Whether a value of a table over time or speed names a file: a table with the key csv, or the name of a file that ends in .csv.
[[nodiscard]] bool names_csv(const Node& node) noexcept;

/// Sets a time table of the scene to the points of the file. Errors are appended to `problems` with the position of `node` and the place in
/// the file, and leave the table unchanged.
/// @param node for which names_csv() is true
/// @param folder base of a relative path
void read_csv_points(const Parameter& parameter, const Node& node, const std::filesystem::path& folder, Scene& scene,
                     std::vector<Problem>& problems);

}  // namespace cvtflow::tasks
