#include "tasks/scene/csv.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <sstream>
#include <utility>

#include "engine/base/input_file.hpp"
#include "engine/base/text.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/toml_tree.hpp"
#include "tasks/scene/units.hpp"

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

namespace {

/// Splits as csv_lines() does; keeps numbers as written.
std::vector<std::vector<std::string>> split(std::string_view text, char separator) {
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
    return lines;
}

}  // namespace

std::vector<std::vector<std::string>> csv_lines(std::string_view text, char separator) {
    auto lines = split(text, separator);
    if (separator == ',') return lines;
    for (auto& line : lines)
        for (std::string& cell : line) put_decimal_point(cell);
    return lines;
}

namespace {

/// Evidence of a number for the decimal mark of its file.
struct MarkEvidence {
    bool comma = false, point = false;  ///< is decimal for certain
    char doubtful = 0;                  ///< the mark that separates decimals or thousands
};

MarkEvidence evidence_of(std::string_view number) {
    if (number.find_first_not_of("+-0123456789.,eE") != std::string_view::npos) return {};
    if (number.starts_with('+') || number.starts_with('-')) number.remove_prefix(1);
    const auto commas = std::count(number.begin(), number.end(), ','), points = std::count(number.begin(), number.end(), '.');
    const auto last = number.find_last_of(",.");
    if (commas + points == 0) return {};
    if (commas + points > 1) {  // groups, and perhaps a decimal mark of the other kind
        const bool groups_of_commas = commas > 1 || (commas == 1 && number[last] == '.');
        return {.comma = !groups_of_commas, .point = groups_of_commas};
    }
    const bool group = last >= 1 && last <= 3 && number.front() != '0' && number.size() == last + 4 &&
                       number.find_first_of("eE") == std::string_view::npos;
    if (group) return {.doubtful = number[last]};
    return {.comma = commas == 1, .point = points == 1};
}

}  // namespace

std::optional<Problem> doubtful_number(std::string_view text) {
    MarkEvidence file;
    std::vector<std::pair<int, std::string>> doubtful;
    char separator = 0;
    int number = 0;
    for (std::size_t at = 0; at < text.size(); ++number) {
        const std::string line(text.substr(at, text.find('\n', at) - at));
        at += line.size() + 1;
        if (is_blank(line)) continue;
        if (separator == 0) separator = csv_separator(line);
        if (separator == ',') return std::nullopt;
        const std::vector<std::string> cells = std::move(split(line, separator).front());
        for (const std::string& cell : cells) {
            const std::string word = trimmed(cell);
            const MarkEvidence mark = evidence_of(word);
            file.comma |= mark.comma;
            file.point |= mark.point;
            if (mark.doubtful != 0) doubtful.emplace_back(number + 1, word);
        }
    }
    for (const auto& [line, word] : doubtful) {
        const bool comma = word.find(',') != std::string::npos;
        if (comma ? file.comma && !file.point : !file.comma) continue;
        std::string whole = word, decimal = word;
        std::erase_if(whole, [](char c) { return c == ',' || c == '.' || c == '+'; });
        std::erase(decimal, '+');
        put_decimal_point(decimal);
        return Problem{{line, 1},
                       fmt::format("\"{}\" can be {} or {}: write it without the {}, or with a different number of decimals", word,
                                   number_text(engine::number_of(decimal).value_or(0.0)), whole, comma ? "comma" : "point")};
    }
    return std::nullopt;
}

std::string csv_cell(std::string_view text, bool is_text, bool quoted) {
    const bool is_number = engine::number_of(text).has_value();
    std::string cell =
        is_text && !is_number && !text.empty() && std::string_view("=+-@\t").find(text.front()) != std::string_view::npos ? "'" : "";
    cell += engine::visible(text);
    if (!quoted && cell.find_first_of(",;\"\n") == std::string::npos) return cell;
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

namespace {

std::string_view first_column(const Parameter& parameter) noexcept { return parameter.kind() == Kind::speed_table ? "speed" : "time"; }

/// The number of a cell as it would be written in a scene.
Node node_of(const std::string& cell, const std::string& unit, Position position) {
    if (!unit.empty()) return {cell + " " + unit, position};
    auto parsed = parse_toml("value = " + cell);
    const auto* document = std::get_if<Node>(&parsed);
    const bool plain = document != nullptr && std::get<Node::Table>(document->value).size() == 1;
    return {plain ? std::get<Node::Table>(document->value).front().node.value : Node{cell, {}}.value, position};
}

class PointReader {
public:
    PointReader(const Parameter& parameter, Position position, std::vector<Problem>& problems)
        : parameter_(parameter), position_(position), problems_(problems) {}

    /// Sets the table of the scene to the points of the file. @param folder  that its path counts from
    void read(const Node& node, const std::filesystem::path& folder, Scene& scene) {
        if (const auto* text = std::get_if<std::string>(&node.value))
            file_ = *text;
        else if (!keys(std::get<Node::Table>(node.value)))
            return;
        const Node all = points(folder);
        if (!good_) return;
        scene.named_files.push_back(folder / file_);
        std::vector<Problem> inside;  // with positions in the file
        read_value(parameter_, all, scene, inside);
        for (const auto& [at, message] : inside)
            problems_.push_back({position_, fmt::format("{} ({}:{}:{})", message, file_, at.line, at.column)});
    }

private:
    /// Reads the keys of the table. @return whether they are valid
    bool keys(const Node::Table& table) {
        const std::size_t before = problems_.size();
        const std::string first(first_column(parameter_));
        for (const Entry& entry : table) {
            const auto* text = std::get_if<std::string>(&entry.node.value);
            std::string* requested = entry.key == "csv"                          ? &file_
                                     : entry.key == first || entry.key == "time" ? &names_[0]
                                     : entry.key == "value"                      ? &names_[1]
                                                                                 : nullptr;
            if (requested == nullptr) {
                const std::string near = engine::did_you_mean(engine::closest(entry.key, {"csv", first, "value"}));
                problem(
                    fmt::format("{}: unknown key{}", entry.key, near.empty() ? fmt::format(" (there are csv, {}, value)", first) : near));
            } else if (text == nullptr)
                problem(fmt::format("{} is not a text", entry.key));
            else
                *requested = *text;
        }
        if (file_.empty() && problems_.size() == before) problem("csv = \"FILE\" is missing");
        return problems_.size() == before;
    }

    /// All points as a list of pairs; their positions are lines and columns of the file.
    Node points(const std::filesystem::path& folder) {
        Node::Array points;
        std::error_code unknown;
        const std::filesystem::path path = folder / file_;
        if (engine::embedded_files().empty() && !std::filesystem::exists(path, unknown))
            return problem(fmt::format("no file {}", toml_text(file_))), Node{points, {}};
        try {
            const std::string content = engine::read_text_input(path.string(), longest_csv);
            if (const auto doubtful = doubtful_number(content))
                problem(fmt::format("{}:{}: {}", file_, doubtful->position.line, doubtful->message));
            std::istringstream text(content);
            for (std::string line; std::getline(text, line) && good_;) {
                ++line_;
                if (is_blank(line)) continue;
                if (columns_ == 0) separator_ = csv_separator(line);
                const std::vector<std::string> cells = cells_of(line, separator_);
                if (columns_ == 0)
                    heading(cells);
                else
                    row(cells, points);
            }
        } catch (const engine::InputError& error) {
            problem(fmt::format("{} cannot be read: {}", toml_text(file_), error.what()));
        }
        if (good_ && points.empty()) problem(fmt::format("{} has no rows", toml_text(file_)));
        return {points, {line_, 1}};
    }

    void problem(const std::string& message) {
        good_ = false;
        problems_.push_back({position_, fmt::format("{}: {}", parameter_.key, message)});
    }

    void heading(const std::vector<std::string>& cells) {
        columns_ = cells.size();
        std::vector<std::string> names;
        for (const std::string& cell : cells) names.push_back(heading_of(cell).name);
        if (columns_ < 2) return problem(fmt::format("{}:{}: one column, not {} and value", file_, line_, first_column(parameter_)));
        for (std::size_t k = 0; k < 2; ++k) {
            const auto found = names_[k].empty() ? names.begin() + static_cast<long>(k) : std::find(names.begin(), names.end(), names_[k]);
            if (found == names.end())
                return problem(fmt::format("{} has no column {}{}", toml_text(file_), toml_text(names_[k]),
                                           engine::did_you_mean(engine::closest(names_[k], names))));
            column_[k] = static_cast<std::size_t>(found - names.begin());
            units_[k] = heading_of(cells[column_[k]]).unit;
        }
    }

    void row(const std::vector<std::string>& cells, Node::Array& points) {
        if (cells.size() != columns_) return problem(fmt::format("{}:{}: {} cells, not {}", file_, line_, cells.size(), columns_));
        if (points.size() >= max_points) return problem(fmt::format("{} has more than {} rows", toml_text(file_), max_points));
        const auto node = [&](std::size_t k) { return node_of(cells[column_[k]], units_[k], {line_, static_cast<int>(column_[k]) + 1}); };
        points.push_back({Node::Array{node(0), node(1)}, {line_, 1}});
    }

    const Parameter& parameter_;
    Position position_;
    std::vector<Problem>& problems_;
    std::string file_, names_[2], units_[2];
    std::size_t column_[2] = {0, 1}, columns_ = 0;
    char separator_ = ',';
    int line_ = 0;
    bool good_ = true;
};

}  // namespace

bool names_csv(const Node& node) noexcept {
    const auto* text = std::get_if<std::string>(&node.value);
    return text != nullptr ? text->ends_with(".csv") || text->ends_with(".CSV") : std::holds_alternative<Node::Table>(node.value);
}

void read_csv_points(const Parameter& parameter, const Node& node, const std::filesystem::path& folder, Scene& scene,
                     std::vector<Problem>& problems) {
    PointReader(parameter, node.position, problems).read(node, folder, scene);
}

}  // namespace cvtflow::tasks
