#include "tasks/scene/csv/csv_text.hpp"

#include <utility>

#include "engine/base/error_text.hpp"
#include "engine/base/number.hpp"

namespace cvtflow::tasks {

std::string trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(" \t\r");
    return first == std::string_view::npos ? "" : std::string(text.substr(first, text.find_last_not_of(" \t\r") - first + 1));
}

namespace {

/// "12,5" -> "12.5": a number with one comma and no point.
void put_decimal_point(std::string& cell) {
    const auto comma = cell.find(',');
    const std::string number = trimmed(cell);
    const bool decimal =
        comma != std::string::npos && cell.find(',', comma + 1) == std::string::npos && cell.find('.') == std::string::npos;
    if (decimal && number.find_first_not_of("+-0123456789,eE") == std::string::npos) cell[comma] = '.';
}

}  // namespace

char csv_separator(std::string_view heading) {
    for (const char separator : {';', ','})
        if (heading.find(separator) != std::string_view::npos) return separator;
    return heading.find('\t') != std::string_view::npos ? '\t' : ',';
}

std::vector<std::vector<std::string>> csv_lines(std::string_view text, char separator) {
    std::vector<std::vector<std::string>> lines(1, {""});
    bool quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (c == '"' && quoted && i + 1 < text.size() && text[i + 1] == '"')
            lines.back().back() += text[i++];
        else if (c == '"')
            quoted = !quoted;
        else if (c == separator && !quoted)
            lines.back().emplace_back();
        else if (c == '\n' && !quoted)
            lines.push_back({""});
        else if (c != '\r')
            lines.back().back() += c;
    }
    if (separator == ',') return lines;
    for (auto& line : lines)
        for (std::string& cell : line) put_decimal_point(cell);
    return lines;
}

std::string csv_cell(std::string_view text, bool is_text, bool quoted) {
    const bool is_number = engine::number_of(text).has_value();
    std::string cell =
        is_text && !is_number && !text.empty() && std::string_view("=+-@\t").find(text.front()) != std::string_view::npos ? "'" : "";
    cell += engine::visible(text);
    if (!quoted && cell.find_first_of(",\"\n") == std::string::npos) return cell;
    for (std::size_t at = 0; (at = cell.find('"', at)) != std::string::npos; at += 2) cell.insert(at, "\"");
    return '"' + cell + '"';
}

std::vector<std::string> cells_of(const std::string& line, char separator) {
    std::vector<std::string> cells = std::move(csv_lines(line, separator).front());
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
