#include "tasks/scene/csv/csv_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "engine/base/input_file.hpp"
#include "engine/base/text.hpp"
#include "tasks/scene/csv/csv_text.hpp"
#include "tasks/scene/toml/value_reader.hpp"

namespace cvtflow::tasks {
namespace {

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

    /// Which keys the table has. @return whether they make sense
    bool keys(const Node::Table& table) {
        const std::size_t before = problems_.size();
        for (const Entry& entry : table) {
            const auto* text = std::get_if<std::string>(&entry.node.value);
            std::string* requested = entry.key == "csv"     ? &file_
                                     : entry.key == "time"  ? &names_[0]
                                     : entry.key == "value" ? &names_[1]
                                                            : nullptr;
            if (requested == nullptr)
                problem(fmt::format("{}: unknown key{}", entry.key,
                                    engine::did_you_mean(engine::closest(entry.key, {"csv", "time", "value"}))));
            else if (text == nullptr)
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
        if (!std::filesystem::exists(path, unknown)) return problem(fmt::format("no file {}", toml_text(file_))), Node{points, {}};
        try {
            const std::string content = engine::read_text_input(path.string(), longest_csv);
            if (const auto doubtful = doubtful_number(content)) problem(fmt::format("{}:{}: {}", file_, doubtful->line, doubtful->problem));
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

    /// A problem of a value, with its position in the file.
    void tell(const Problem& inside) {
        problems_.push_back({position_, fmt::format("{} ({}:{}:{})", inside.message, file_, inside.position.line, inside.position.column)});
    }
    [[nodiscard]] bool good() const noexcept { return good_; }
    [[nodiscard]] std::filesystem::path file(const std::filesystem::path& folder) const { return folder / file_; }

private:
    void problem(const std::string& message) {
        good_ = false;
        problems_.push_back({position_, fmt::format("{}: {}", parameter_.key, message)});
    }

    void heading(const std::vector<std::string>& cells) {
        columns_ = cells.size();
        std::vector<std::string> names;
        for (const std::string& cell : cells) names.push_back(heading_of(cell).name);
        if (columns_ < 2) return problem(fmt::format("{}:{}: one column, not time and value", file_, line_));
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

void read_csv_points(const Parameter& parameter, const Node& node, const std::filesystem::path& folder, Scene& scene,
                     std::vector<Problem>& problems) {
    PointReader reader(parameter, node.position, problems);
    if (!reader.keys(std::get<Node::Table>(node.value))) return;
    const Node points = reader.points(folder);
    if (!reader.good()) return;
    scene.named_files.push_back(reader.file(folder));
    std::vector<Problem> inside;
    read_value(parameter, points, scene, inside);
    for (const Problem& problem : inside) reader.tell(problem);
}

}  // namespace cvtflow::tasks
