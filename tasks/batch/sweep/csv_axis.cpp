#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <sstream>

#include "engine/base/input_file.hpp"
#include "engine/base/text.hpp"
#include "tasks/batch/sweep/axis_reader.hpp"
#include "tasks/scene/csv.hpp"

namespace cvtflow::tasks {

namespace {

class CsvReader {
public:
    CsvReader(std::string name, const std::vector<CsvColumn>& columns, Position position, std::vector<Problem>& problems)
        : name_(std::move(name)), chosen_(columns), position_(position), problems_(problems) {}

    void line(const std::string& text) {
        ++line_;
        if (is_blank(text)) return;
        if (units_.empty()) {
            separator_ = csv_separator(text);
            return heading(cells_of(text, separator_));
        }
        const auto cells = cells_of(text, separator_);
        if (cells.size() != units_.size()) return problem(1, fmt::format("{} cells, not {}", cells.size(), units_.size()));
        for (std::size_t k = 0; k < taken_.size(); ++k) cell(*axis_.keys[k], taken_[k], cells[taken_[k]]);
    }
    [[nodiscard]] bool good() const noexcept { return good_; }
    [[nodiscard]] const Axis& axis() const noexcept { return axis_; }
    void problem(std::size_t column, const std::string& message) {
        good_ = false;
        problems_.push_back({position_, fmt::format("axes.csv: {}:{}:{}: {}", name_, line_, column, message)});
    }

private:
    void heading(const std::vector<std::string>& cells) {
        std::vector<std::string> names;
        for (std::size_t i = 0; i < cells.size(); ++i) {
            auto [name, unit] = heading_of(cells[i]);
            units_.push_back(unit);
            if (chosen_.empty()) take(i, name, find_parameter(name));
            names.push_back(std::move(name));
        }
        for (const CsvColumn& column : chosen_) {
            const auto found = std::find(names.begin(), names.end(), column.name);
            if (found == names.end())
                problem(1, fmt::format("unknown column {}{}", toml_text(column.name),
                                       engine::did_you_mean(engine::closest(column.name, names))));
            else
                take(static_cast<std::size_t>(found - names.begin()), column.name, column.key);
        }
    }

    void take(std::size_t column, const std::string& key, const Parameter* parameter) {
        if (parameter == nullptr)
            return problem(column + 1, fmt::format("unknown key {}{}", toml_text(key), engine::did_you_mean(nearest_keys(key))));
        taken_.push_back(column);
        axis_.keys.push_back(parameter);
    }

    void cell(const Parameter& parameter, std::size_t i, const std::string& text) {
        const auto parsed = parse_toml("value = " + text);
        Node node{text + (units_[i].empty() ? "" : " " + units_[i]), {}};
        if (const auto* document = std::get_if<Node>(&parsed); document != nullptr && units_[i].empty())
            node = std::get<Node::Table>(document->value).front().node;
        std::vector<Problem> own;
        for (AxisValue& value : axis_value(parameter, node, own)) axis_.values.push_back(std::move(value));
        for (const Problem& each : own) problem(i + 1, each.message);
    }

    std::string name_;
    const std::vector<CsvColumn>& chosen_;
    Position position_;
    std::vector<Problem>& problems_;
    Axis axis_{"csv", {}, {}};
    char separator_ = ',';
    std::vector<std::string> units_;  ///< of all columns
    std::vector<std::size_t> taken_;  ///< column of each key of the axis
    int line_ = 0;
    bool good_ = true;
};

}  // namespace

Axis read_csv_axis(const std::filesystem::path& file, const std::vector<CsvColumn>& columns, Position position,
                   std::vector<Problem>& problems) {
    CsvReader reader(file.filename().string(), columns, position, problems);
    std::error_code unknown;
    if (!std::filesystem::exists(file, unknown)) {
        problems.push_back({position, fmt::format("axes.csv: no file {}", toml_text(file.string()))});
        return {};
    }
    try {
        const std::string content = engine::read_text_input(file.string(), longest_csv);
        if (const auto doubtful = doubtful_number(content)) {
            problems.push_back({position, fmt::format("axes.csv: {}:{}: {}", file.filename().string(), doubtful->line, doubtful->problem)});
            return {};
        }
        std::istringstream text(content);
        for (std::string line; std::getline(text, line);) reader.line(line);
    } catch (const engine::InputError& error) {
        problems.push_back({position, fmt::format("axes.csv: {} cannot be read: {}", toml_text(file.string()), error.what())});
        return {};
    }
    if (reader.good() && reader.axis().rows() == 0) reader.problem(1, "no rows");
    return reader.good() ? reader.axis() : Axis{};
}

}  // namespace cvtflow::tasks
