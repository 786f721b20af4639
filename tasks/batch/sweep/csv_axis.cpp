#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <sstream>

#include "engine/base/input_file.hpp"
#include "engine/base/spelling.hpp"
#include "tasks/batch/sweep/axis_reader.hpp"

namespace cvtflow::tasks {

namespace {

constexpr std::uint64_t longest_csv = std::uint64_t{64} << 20U;  // a million rows of six numbers [byte]

std::string trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(" \t\r");
    return first == std::string_view::npos ? "" : std::string(text.substr(first, text.find_last_not_of(" \t\r") - first + 1));
}

/// Cells of a line; a cell in double quotes may hold commas, and "" for a quote.
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

class CsvReader {
public:
    CsvReader(std::string name, Position position, std::vector<Problem>& problems)
        : name_(std::move(name)), position_(position), problems_(problems) {}

    void line(const std::string& text) {
        ++line_;
        if (trimmed(text).empty() || trimmed(text).front() == '#') return;
        if (units_.empty()) return heading(cells_of(text));
        const auto cells = cells_of(text);
        if (cells.size() != units_.size()) return problem(1, fmt::format("{} cells, not {}", cells.size(), units_.size()));
        for (std::size_t i = 0; i < cells.size(); ++i) cell(i, cells[i]);
    }
    [[nodiscard]] bool good() const noexcept { return good_; }
    [[nodiscard]] const Axis& axis() const noexcept { return axis_; }
    void problem(std::size_t column, const std::string& message) {
        good_ = false;
        problems_.push_back({position_, fmt::format("axes.csv: {}:{}:{}: {}", name_, line_, column, message)});
    }

private:
    void heading(const std::vector<std::string>& cells) {
        for (std::size_t i = 0; i < cells.size(); ++i) {
            const auto bracket = cells[i].find('[');
            const std::string key = trimmed(std::string_view(cells[i]).substr(0, bracket));
            const auto end = cells[i].find(']');
            units_.push_back(bracket == std::string::npos || end == std::string::npos
                                 ? ""
                                 : trimmed(std::string_view(cells[i]).substr(bracket + 1, end - bracket - 1)));
            const Parameter* parameter = find_parameter(key);
            if (parameter == nullptr)
                problem(i + 1, fmt::format("there is no key {}{}", toml_text(key), engine::did_you_mean(nearest_key(key))));
            axis_.keys.push_back(parameter);
        }
    }

    void cell(std::size_t i, const std::string& text) {
        const Parameter* parameter = axis_.keys[i];
        if (parameter == nullptr) return;
        const auto parsed = parse_toml("value = " + text);
        Node node{text + (units_[i].empty() ? "" : " " + units_[i]), {}};
        if (const auto* document = std::get_if<Node>(&parsed); document != nullptr && units_[i].empty())
            node = std::get<Node::Table>(document->value).front().node;
        std::vector<Problem> own;
        for (AxisValue& value : axis_value(*parameter, node, own)) axis_.values.push_back(std::move(value));
        for (const Problem& each : own) problem(i + 1, each.message);
    }

    std::string name_;
    Position position_;
    std::vector<Problem>& problems_;
    Axis axis_{"csv", {}, {}};
    std::vector<std::string> units_;
    int line_ = 0;
    bool good_ = true;
};

}  // namespace

Axis read_csv_axis(const std::filesystem::path& file, Position position, std::vector<Problem>& problems) {
    CsvReader reader(file.filename().string(), position, problems);
    std::error_code unknown;
    if (!std::filesystem::exists(file, unknown)) {
        problems.push_back({position, fmt::format("axes.csv: there is no file {}", toml_text(file.string()))});
        return {};
    }
    try {
        std::istringstream text(engine::read_text_input(file.string(), longest_csv));
        for (std::string line; std::getline(text, line);) reader.line(line);
    } catch (const engine::InputError& error) {
        problems.push_back({position, fmt::format("axes.csv: {} cannot be read: {}", toml_text(file.string()), error.what())});
        return {};
    }
    if (reader.good() && reader.axis().rows() == 0) reader.problem(1, "there are no rows");
    return reader.good() ? reader.axis() : Axis{};
}

}  // namespace cvtflow::tasks
