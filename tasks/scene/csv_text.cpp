#include "tasks/scene/csv_text.hpp"

namespace cvtflow::tasks {

std::string trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(" \t\r");
    return first == std::string_view::npos ? "" : std::string(text.substr(first, text.find_last_not_of(" \t\r") - first + 1));
}

std::vector<std::string> cells_of(const std::string& line) {
    std::vector<std::string> cells(1);
    bool quoted = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (line[i] == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"')
            cells.back() += line[i++];
        else if (line[i] == '"')
            quoted = !quoted;
        else if (line[i] == ',' && !quoted)
            cells.emplace_back();
        else
            cells.back() += line[i];
    }
    for (std::string& cell : cells) cell = trimmed(cell);
    return cells;
}

bool is_blank(const std::string& line) { return trimmed(line).empty() || trimmed(line).front() == '#'; }

Heading heading_of(const std::string& cell) {
    const auto bracket = cell.find('['), end = cell.find(']');
    const bool bare = bracket == std::string::npos || end == std::string::npos;
    return {trimmed(std::string_view(cell).substr(0, bracket)),
            bare ? "" : trimmed(std::string_view(cell).substr(bracket + 1, end - bracket - 1))};
}

}  // namespace cvtflow::tasks
