#include "tasks/scene/csv/csv_text.hpp"

#include <charconv>
#include <utility>

#include "engine/base/error_text.hpp"

namespace cvtflow::tasks {

std::string trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(" \t\r");
    return first == std::string_view::npos ? "" : std::string(text.substr(first, text.find_last_not_of(" \t\r") - first + 1));
}

std::vector<std::vector<std::string>> csv_lines(std::string_view text) {
    std::vector<std::vector<std::string>> lines(1, {""});
    bool quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (c == '"' && quoted && i + 1 < text.size() && text[i + 1] == '"')
            lines.back().back() += text[i++];
        else if (c == '"')
            quoted = !quoted;
        else if (c == ',' && !quoted)
            lines.back().emplace_back();
        else if (c == '\n' && !quoted)
            lines.push_back({""});
        else if (c != '\r')
            lines.back().back() += c;
    }
    return lines;
}

std::string csv_cell(std::string_view text, bool is_text, bool quoted) {
    double number = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    const bool is_number = error == std::errc() && end == text.data() + text.size();
    std::string cell =
        is_text && !is_number && !text.empty() && std::string_view("=+-@\t").find(text.front()) != std::string_view::npos ? "'" : "";
    cell += engine::visible(text);
    if (!quoted && cell.find_first_of(",\"\n") == std::string::npos) return cell;
    for (std::size_t at = 0; (at = cell.find('"', at)) != std::string::npos; at += 2) cell.insert(at, "\"");
    return '"' + cell + '"';
}

std::vector<std::string> cells_of(const std::string& line) {
    std::vector<std::string> cells = std::move(csv_lines(line).front());
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
