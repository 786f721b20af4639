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
#include "tools/program/guard.hpp"
#include "tools/program/plot/axis_scale.hpp"
#include "tools/program/plot/field.hpp"
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

std::size_t numbers_of(const SweepView& sweep, const std::string& word) {
    const std::size_t column = sweep.column(word);
    if (!sweep.columns[column].number) throw UsageError(fmt::format("{}: the cells of this column are not numbers", word));
    return column;
}

std::string heading_of(const SweepColumn& column) { return shown(column.name, column.unit).label; }

/// "load torque" of a column.
std::string title_of(const SweepColumn& column) {
    const std::string heading = heading_of(column);
    return heading.substr(0, heading.find(" ["));
}

/// "start ratio 2.4", "clamping driven 10000 N".
std::string setting_text(const SweepView& sweep, std::size_t row, std::size_t column) {
    const SweepColumn& key = sweep.columns[column];
    const double value = sweep.number(row, column);
    if (!std::isfinite(value)) return fmt::format("{} {}", title_of(key), sweep.cells[row][column]);
    const bool plain = key.unit.empty() || key.unit == "1";
    return fmt::format("{} {}", title_of(key), plain ? sweep.cells[row][column] : tasks::quantity_text(value, key.unit));
}

/// "153 of 160 cases".
std::string counts_text(const SweepView& sweep, std::size_t good) {
    return good == sweep.cells.size() ? fmt::format("{} cases", good)
                                      : fmt::format("{} of {} cases, those that ended well", good, sweep.cells.size());
}

/// Axes other than the given columns that the cases differ in.
std::vector<std::size_t> others(const SweepView& sweep, const std::set<std::size_t>& but) {
    std::vector<std::size_t> found;
    for (std::size_t c = 0; c < sweep.columns.size(); ++c) {
        if (sweep.columns[c].axis && !but.contains(c) && sweep.varies(c)) found.push_back(c);
    }
    return found;
}

/// Columns that distinguish the cases: a column that only follows the others is left out.
std::vector<std::size_t> distinguishing(const SweepView& sweep, const std::vector<std::size_t>& columns) {
    std::vector<std::size_t> kept;
    std::vector<std::string> names(sweep.cells.size());
    for (const std::size_t c : columns) {
        std::vector<std::string> finer = names;
        for (std::size_t row = 0; row < finer.size(); ++row) finer[row] += "\n" + sweep.cells[row][c];
        if (std::set(finer.begin(), finer.end()).size() == std::set(names.begin(), names.end()).size()) continue;
        names = std::move(finer);
        kept.push_back(c);
    }
    return kept;
}

struct Chosen {
    SweepView good;
    Plot plot;
};

/// "fine, "; empty where the cases differ in it or it is not known.
std::string level_of(const SweepView& sweep) {
    const bool varies =
        std::ranges::any_of(sweep.columns, [](const auto& column) { return column.axis && column.name.starts_with("detail_"); });
    return sweep.scene && !varies ? level_text(*sweep.scene) + ", " : "";
}

/// Cases that ended well, all if the table has no status, and a plot without series. @throws UsageError if there is none
Chosen begin_plot(const SweepView& sweep, const SweepColumn& x, const SweepColumn& y, const std::string& title) {
    Chosen made{sweep, {.title = title, .subtitle = {}, .x = {heading_of(x)}, .y = {heading_of(y)}}};
    auto& cells = made.good.cells;
    const auto status = std::ranges::find(sweep.columns, "status", &SweepColumn::name);
    if (status != sweep.columns.end())
        std::erase_if(cells, [c = status - sweep.columns.begin()](const auto& row) { return row[c] != "ok"; });
    if (cells.empty()) throw UsageError(sweep.path + ": no case ended well");
    made.plot.subtitle = fmt::format("sweep {}, {}{}", sweep.name, level_of(sweep), counts_text(sweep, cells.size()));
    return made;
}

/// Points whose colours tell a value, in eight steps.
void add_points(Plot& plot, const SweepView& sweep, std::size_t x, std::size_t y, std::size_t colour, const std::string& label) {
    Field values{label, {0.0, 1.0}, {0.0, 1.0}, {}};
    for (std::size_t row = 0; row < sweep.cells.size(); ++row) values.values.push_back(value_of(sweep, row, colour));
    std::vector<double> levels = contour_levels(values);
    if (levels.empty()) levels.push_back(values.values.empty() ? 0.0 : values.values.front());
    const double step = levels.size() > 1 ? levels[1] - levels[0] : 1.0;
    for (std::size_t k = 0; k < levels.size(); ++k) {
        const double share = levels.size() > 1 ? static_cast<double>(k) / static_cast<double>(levels.size() - 1) : 0.5;
        const std::string from = tick_label(levels[k] - 0.5 * step, 0.1 * step), to = tick_label(levels[k] + 0.5 * step, 0.1 * step);
        const bool first = k == 0, last = k + 1 == levels.size();  // what lies beyond the levels belongs to the nearest
        const std::string name = first && last ? "all" : first ? "below " + to : last ? "above " + from : from + " … " + to;
        Series series{name, {}, Mark::dot, Line::none, heat_colour(share)};
        for (std::size_t row = 0; row < sweep.cells.size(); ++row) {
            const double value = value_of(sweep, row, colour);
            const auto nearest =
                static_cast<std::size_t>(std::clamp(std::lround((value - levels[0]) / step), 0L, static_cast<long>(levels.size()) - 1));
            if (std::isfinite(value) && nearest == k) series.points.push_back({value_of(sweep, row, x), value_of(sweep, row, y)});
        }
        plot.series.push_back(std::move(series));
    }
}

std::vector<double> distinct(const SweepView& sweep, std::size_t column) {
    std::set<double> values;
    for (std::size_t row = 0; row < sweep.cells.size(); ++row) values.insert(value_of(sweep, row, column));
    return {values.begin(), values.end()};
}

/// The cases by their places. @throws UsageError for two at one place
std::map<std::pair<double, double>, double> by_place(const SweepView& sweep, std::size_t x, std::size_t y, std::size_t colour) {
    std::map<std::pair<double, double>, double> places;
    for (std::size_t row = 0; row < sweep.cells.size(); ++row) {
        const auto [at, added] = places.insert({{value_of(sweep, row, x), value_of(sweep, row, y)}, value_of(sweep, row, colour)});
        if (added) continue;
        std::string differ;
        for (const std::size_t c : others(sweep, {x, y, colour})) differ += (differ.empty() ? "" : ", ") + sweep.columns[c].name;
        throw UsageError(fmt::format("several cases at one point of {} and {}: choose with --where COLUMN=VALUE among {}",
                                     sweep.columns[x].name, sweep.columns[y].name, differ.empty() ? "the columns" : differ));
    }
    return places;
}

/// A speed ratio: 1/2 is as far from 1 as 2 is, because the pulleys change places. Every other axis is linear.
Scale map_scale(const SweepView& sweep, std::size_t column) {
    const std::string& name = sweep.columns[column].name;
    const bool ratio = name == "start_ratio" || name == "control_ratio" || name.starts_with("ratio_");
    const auto positive = [&](const auto& cells) { return as_number(cells[column]) > 0.0; };
    return ratio && std::ranges::all_of(sweep.cells, positive) ? Scale::logarithmic : Scale::linear;
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

double value_of(const SweepView& sweep, std::size_t row, std::size_t column) {
    return sweep.number(row, column) * shown(sweep.columns[column].name, sweep.columns[column].unit).factor;
}

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

std::string Measured::names() const {
    std::string names;
    for (const MeasuredColumn& column : columns) names += (names.empty() ? "" : ", ") + column.name;
    return names;
}

const MeasuredColumn* Measured::find(const std::string& heading, const std::string& unit) const {
    const auto found =
        std::ranges::find(columns, tasks::column_name(heading), [](const auto& column) { return tasks::column_name(column.name); });
    if (found == columns.end()) return nullptr;
    const std::string si = unit.empty() ? "1" : unit;
    if (!found->unit.empty() && tasks::dimension_of(found->unit) != tasks::dimension_of(si))
        throw UsageError(fmt::format("{}: {} [{}]: {} expected ({})", path, found->name, found->unit,
                                     tasks::dimension_name(tasks::dimension_of(si)), si));
    return &*found;
}

const MeasuredColumn& Measured::at(const std::string& heading, const std::string& unit) const {
    if (const MeasuredColumn* column = find(heading, unit)) return *column;
    throw UsageError(fmt::format("--with {}: no column '{}', only {}", path, heading, names()));
}

Series Measured::points(const Quantities& x, const Quantities& y, const std::string& series) const {
    const MeasuredColumn &across = at(x.name, x.unit), &up = at(y.name, y.unit);
    const double fx = shown(x.name, x.unit).factor, fy = shown(y.name, y.unit).factor;
    Series drawn{series, {}, Mark::ring, Line::none, "#222222"};
    for (std::size_t k = 0; k < up.values.size(); ++k) drawn.points.push_back({fx * across.values[k], fy * up.values[k]});
    return drawn;
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

bool SweepView::varies(std::size_t column) const {
    return std::ranges::any_of(cells, [&](const auto& row) { return row[column] != cells.front()[column]; });
}

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

Plot sweep_curves(const SweepView& sweep, const std::string& x, const std::string& y, const Measured* measured) {
    const std::size_t xc = numbers_of(sweep, x), yc = numbers_of(sweep, y);
    Chosen made = begin_plot(sweep, sweep.columns[xc], sweep.columns[yc],
                             fmt::format("{} over {}", title_of(sweep.columns[yc]), title_of(sweep.columns[xc])));
    const std::vector<std::size_t> rest = distinguishing(made.good, others(made.good, {xc, yc}));
    std::map<std::string, std::vector<Point>> curves;
    std::vector<std::string> order;
    for (std::size_t row = 0; row < made.good.cells.size(); ++row) {
        std::string name;
        for (const std::size_t c : rest) name += (name.empty() ? "" : ", ") + setting_text(made.good, row, c);
        if (!curves.contains(name)) order.push_back(name);
        curves[name].push_back({value_of(made.good, row, xc), value_of(made.good, row, yc)});
    }
    for (const std::string& name : order) {
        auto& points = curves[name];
        std::stable_sort(points.begin(), points.end(), [](const Point& a, const Point& b) { return a.x < b.x; });
        made.plot.series.push_back({name, points, Mark::dot, Line::solid, "", 1.4});
    }
    const SweepColumn &across = sweep.columns[xc], &up = sweep.columns[yc];
    if (measured != nullptr) made.plot.series.push_back(measured->points({across.name, across.unit}, {up.name, up.unit}, measured->name));
    return made.plot;
}

Plot sweep_map(const SweepView& sweep, const std::string& x, const std::string& y, const std::string& colour) {
    const std::size_t xc = numbers_of(sweep, x), yc = numbers_of(sweep, y), cc = numbers_of(sweep, colour);
    const std::string label = heading_of(sweep.columns[cc]);
    Chosen made =
        begin_plot(sweep, sweep.columns[xc], sweep.columns[yc],
                   fmt::format("{} over {} and {}", title_of(sweep.columns[cc]), title_of(sweep.columns[xc]), title_of(sweep.columns[yc])));
    made.plot.x.scale = map_scale(made.good, xc);
    made.plot.y.scale = map_scale(made.good, yc);
    const auto places = by_place(made.good, xc, yc, cc);
    const std::vector<Series> marks = map_marks(made.good, xc, yc);
    Field field{label, distinct(made.good, xc), distinct(made.good, yc), {}};
    const std::size_t grid = field.x.size() * field.y.size();
    if (field.x.size() < 2 || field.y.size() < 2 || 2 * places.size() < grid) {  // hardly a grid
        made.plot.series.push_back({label, {}, Mark::none, Line::none, "#000000"});
        add_points(made.plot, made.good, xc, yc, cc, label);
        made.plot.series.insert(made.plot.series.end(), marks.begin(), marks.end());
        return made.plot;
    }
    Series cases{"", {}, Mark::small_dot, Line::none, "#ffffff"};
    for (const double row : field.y) {
        for (const double column : field.x) {
            const auto found = places.find({column, row});
            field.values.push_back(found == places.end() ? NAN : found->second);
            if (found != places.end()) cases.points.push_back({column, row});
        }
    }
    made.plot.series.push_back(std::move(cases));
    const auto most =
        std::ranges::max_element(places, {}, [](const auto& place) { return std::isfinite(place.second) ? place.second : -INFINITY; });
    made.plot.series.push_back({"", {{most->first.first, most->first.second}}, Mark::ring, Line::none, "#e3342f"});
    made.plot.series.insert(made.plot.series.end(), marks.begin(), marks.end());
    made.plot.subtitle += fmt::format("; ring: largest, {:.4g}", most->second);
    made.plot.fields.push_back(std::move(field));
    return made.plot;
}

}  // namespace cvtflow::tools
