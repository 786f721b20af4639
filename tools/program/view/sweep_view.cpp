#include "tools/program/view/sweep_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include "engine/base/input_file.hpp"
#include "engine/base/text.hpp"
#include "tasks/batch/results/results.hpp"
#include "tasks/batch/sweep/scalar.hpp"
#include "tasks/scene/csv.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/toml_tree.hpp"
#include "tasks/scene/units.hpp"
#include "tasks/sizing/sizing.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/text/scene_text.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

namespace {

constexpr std::uint64_t longest_table = std::uint64_t{256} << 20U;  // of a CSV [byte]

const tasks::Parameter* key_of(const std::string& column) {
    for (const tasks::Parameter& parameter : tasks::parameter_table()) {
        if (tasks::column_name(parameter.key) == column) return &parameter;
    }
    return nullptr;
}

double as_number(const std::string& cell) { return engine::number_of(cell).value_or(NAN); }

/// Cells by line, the headings first.
std::vector<std::vector<std::string>> lines_of(const std::string& path) {
    std::string text;
    try {
        text = engine::read_text_input(path, longest_table);
    } catch (const engine::InputError& error) {
        throw engine::RecordError(path + ": " + error.what());
    }
    if (const auto doubtful = tasks::doubtful_number(text))
        throw engine::RecordError(fmt::format("{}:{}: {}", path, doubtful->position.line, doubtful->message));
    auto lines = tasks::csv_lines(text, tasks::csv_separator(text.substr(0, text.find('\n'))));
    std::erase_if(lines, [](const auto& cells) { return cells.size() == 1 && cells[0].empty(); });
    return lines;
}

/// @throws engine::RecordError for a line with more or fewer cells than there are headings
void require_full_lines(const std::vector<std::vector<std::string>>& lines, const std::string& path) {
    for (std::size_t line = 1; line < lines.size(); ++line) {
        if (lines[line].size() != lines[0].size())
            throw engine::RecordError(fmt::format("{}:{}: {} cells, not {}", path, line + 1, lines[line].size(), lines[0].size()));
    }
}

SweepView from_csv(const std::string& path) {
    auto lines = lines_of(path);
    if (lines.size() < 2 || std::find(lines[0].begin(), lines[0].end(), "status") == lines[0].end())
        throw engine::RecordError(path + ": not a sweep's table as cvtflow table --csv prints it");
    SweepView view{path, std::filesystem::path(path).stem().string(), {}, {}, {}, {}};
    for (const std::string& cell : lines[0]) {
        const tasks::Heading heading = tasks::heading_of(cell);  // "slip_mean", or "slip_mean [1]" as --units prints it
        view.columns.push_back({heading.name, heading.unit, "", false, false});
    }
    require_full_lines(lines, path);
    lines.erase(lines.begin());
    view.cells = std::move(lines);
    return view;
}

/// The scene of a sweep by its definition, whose other lines are of axes and outputs.
std::optional<tasks::Scene> scene_of(const engine::CaseTable& table) {
    std::istringstream lines(table.attribute("definition"));
    std::string keys;
    for (std::string line; std::getline(lines, line);)
        if (tasks::find_parameter(line.substr(0, line.find(" = "))) != nullptr) keys += line + "\n";
    return scene_in({{"definition", keys}}, "definition");
}

SweepView from_table(const std::string& path) {
    engine::CaseTable table = tasks::read_results(path);
    tasks::sort_rows(table);
    SweepView view{path, table.attribute("sweep"), table.attributes, scene_of(table), {}, {}};
    const auto& columns = table.layout.columns();
    for (const engine::TableColumn& column : columns) view.columns.push_back({column.name, column.unit, column.description, false, false});
    for (std::size_t row = 0; row < table.size(); ++row) {
        auto& cells = view.cells.emplace_back();
        for (std::size_t c = 0; c < columns.size(); ++c) cells.push_back(table.layout.cell(table.row(row), c));
    }
    return view;
}

/// Values of a column as they are entered, in the order of cases, the first few: "12 kN, 16 kN, 20 kN".
std::string values_text(const std::vector<std::vector<std::string>>& cells, const SweepColumn& column, std::size_t number) {
    constexpr std::size_t few = 6;
    const Shown how = column.number ? shown(column.name, column.unit) : Shown{};
    std::vector<std::string> values;
    for (const auto& row : cells) {
        const std::string text = column.number
                                     ? fmt::format("{:.6g}{}{}", how.factor * as_number(row[number]), how.unit.empty() ? "" : " ", how.unit)
                                     : row[number];
        if (std::find(values.begin(), values.end(), text) != values.end()) continue;
        values.push_back(values.size() < few ? text : "…");
        if (values.size() > few) break;
    }
    return fmt::format("{}", fmt::join(values, ", "));
}

}  // namespace

Measured read_measured(const std::string& path) {
    const auto lines = lines_of(path);
    if (lines.size() < 2) throw engine::RecordError(path + ": not a CSV with headings and numbers");
    Measured measured{path, std::filesystem::path(path).filename().string(), {}};
    for (const std::string& cell : lines[0]) {
        const tasks::Heading heading = tasks::heading_of(cell);
        const auto unit = tasks::parse_quantity("1 " + heading.unit);
        if (const auto* wrong = std::get_if<std::string>(&unit)) throw engine::RecordError(fmt::format("{}: {}: {}", path, cell, *wrong));
        measured.columns.push_back({heading.name, heading.unit, std::get<tasks::Quantity>(unit).value, {}});
    }
    require_full_lines(lines, path);
    for (std::size_t c = 0; c < measured.columns.size(); ++c) {
        MeasuredColumn& column = measured.columns[c];
        for (std::size_t line = 1; line < lines.size(); ++line) column.values.push_back(column.factor * as_number(lines[line][c]));
    }
    return measured;
}

std::size_t SweepView::column(const std::string& word) const {
    const std::string heading = tasks::column_name(word);
    std::vector<std::string> names;
    for (std::size_t c = 0; c < columns.size(); ++c) {
        if (columns[c].name == heading) return c;
        names.push_back(columns[c].name);
    }
    throw UsageError(
        fmt::format("{}: the table {} has no such column{}", word, path, engine::did_you_mean(engine::closest(heading, names))));
}

double SweepView::number(std::size_t row, std::size_t column) const { return as_number(cells[row][column]); }

std::optional<tasks::Scene> SweepView::scene_of_case(std::size_t row) const {
    std::optional<tasks::Scene> made = scene;
    for (std::size_t c = 0; c < columns.size() && made; ++c) {
        const tasks::Parameter* key = key_of(columns[c].name);
        if (key == nullptr || key->key == "start.state") continue;  // every table has a column start_state
        const auto parsed = tasks::parse_toml("value = " + cells[row][c]);
        const auto* document = std::get_if<tasks::Node>(&parsed);
        if (document == nullptr) return {};
        std::vector<tasks::Problem> problems;
        tasks::read_value(*key, std::get<tasks::Node::Table>(document->value).front().node, *made, problems);
        if (!problems.empty()) return {};
    }
    return made;
}

void SweepView::keep(const std::string& condition) {
    const auto equals = condition.find('=');
    if (equals == std::string::npos) throw UsageError(fmt::format("--where {}: expected COLUMN=VALUE", condition));
    const std::size_t c = column(condition.substr(0, equals));
    const std::string value_text = condition.substr(equals + 1);
    const auto parsed = tasks::parse_quantity(value_text);  // 20000, or 20 kN
    const auto* quantity = std::get_if<tasks::Quantity>(&parsed);
    const double value = quantity != nullptr ? quantity->value : NAN;
    const auto meets = [&](const auto& row) { return row[c] == value_text || as_number(row[c]) == value; };
    if (std::ranges::none_of(cells, meets))
        throw UsageError(fmt::format("--where {}: no case of {} is left; {} is {}", condition, path, columns[c].name,
                                     values_text(cells, columns[c], c)));
    std::erase_if(cells, [&](const auto& row) { return !meets(row); });
}

bool is_sweep(const std::string& path) {
    const std::filesystem::path file(path);
    if (std::filesystem::is_directory(file) || file.extension() == ".csv" || file.filename() == "cases.h5") return true;
    try {
        static_cast<void>(engine::CaseReader(path));
        return true;
    } catch (const engine::RecordError&) {
        return false;
    }
}

std::string table_path(const std::string& path) {
    constexpr std::size_t shown = 3;
    std::error_code unreadable;
    if (!std::filesystem::is_directory(path, unreadable)) return path;
    const std::string table = path + "/cases.h5";
    if (std::filesystem::exists(table, unreadable) || std::filesystem::is_symlink(table, unreadable)) return table;
    std::vector<std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(path, unreadable))
        if (entry.path().extension() == ".h5") files.push_back(entry.path().string());
    std::sort(files.begin(), files.end());
    const std::size_t count = files.size();
    files.resize(std::min(count, shown));
    throw engine::RecordError(fmt::format(
        "{}: a folder without the table of a sweep (cases.h5){}", path,
        count == 0 ? "" : fmt::format("; it contains {}{}: name one of these files", fmt::join(files, ", "), count > shown ? ", …" : "")));
}

SweepView read_sweep(const std::string& path) {
    const bool csv = std::filesystem::path(path).extension() == ".csv";
    SweepView view = csv ? from_csv(path) : from_table(table_path(path));
    for (std::size_t c = 0; c < view.columns.size(); ++c) {
        SweepColumn& column = view.columns[c];
        const tasks::Parameter* key = key_of(column.name);
        column.axis = key != nullptr;
        if (key != nullptr && column.unit.empty()) column.unit = key->unit;
        column.number = std::ranges::any_of(view.cells, [&](const auto& row) { return std::isfinite(as_number(row[c])); });
    }
    return view;
}

std::optional<double> load_limit(const SweepView& sweep, std::size_t row) {
    std::optional<tasks::Scene> scene = sweep.scene_of_case(row);
    if (!scene) return {};
    model::Parameters& p = scene->parameters;
    if (p.clamping.safety > 0.0) return {};  // the clamping force follows the load
    if (p.control.enabled) p.start.ratio = p.control.ratio.at(tasks::latest_end(*scene));
    const std::vector<tasks::SizedPoint> points = tasks::size_scene(*scene).points;
    if (points.empty() || !std::isfinite(points.front().factor()) || points.front().decided != "clamping.driven") return {};
    const tasks::SizedPoint& least = points.front();
    return p.load.torque.at(0.0) + std::copysign(least.limit, least.load) - least.load;
}

}  // namespace cvtflow::tools
