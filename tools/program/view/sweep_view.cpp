#include "tools/program/view/sweep_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "engine/base/input_file.hpp"
#include "engine/base/text.hpp"
#include "tasks/batch/results/results.hpp"
#include "tasks/scene/csv.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tools/program/guard.hpp"

namespace cvtflow::tools {

namespace {

constexpr std::uint64_t longest_table = std::uint64_t{256} << 20U;  // of a CSV [byte]

/// As in tables: '_' for '.'.
std::string in_table(std::string key) {
    std::replace(key.begin(), key.end(), '.', '_');
    return key;
}

const tasks::Parameter* key_of(const std::string& column) {
    for (const tasks::Parameter& parameter : tasks::parameter_table()) {
        if (in_table(std::string(parameter.key)) == column) return &parameter;
    }
    return nullptr;
}

double as_number(const std::string& cell) { return engine::number_of(cell).value_or(NAN); }

SweepView from_csv(const std::string& path) {
    std::string text;
    try {
        text = engine::read_text_input(path, longest_table);
    } catch (const engine::InputError& error) {
        throw engine::RecordError(path + ": " + error.what());
    }
    if (const auto doubtful = tasks::doubtful_number(text))
        throw engine::RecordError(fmt::format("{}:{}: {}", path, doubtful->line, doubtful->problem));
    auto lines = tasks::csv_lines(text, tasks::csv_separator(text.substr(0, text.find('\n'))));
    std::erase_if(lines, [](const auto& cells) { return cells.size() == 1 && cells[0].empty(); });
    if (lines.size() < 2 || std::find(lines[0].begin(), lines[0].end(), "status") == lines[0].end())
        throw engine::RecordError(path + ": not a sweep's table as cvtflow table --csv prints it");
    SweepView view{path, std::filesystem::path(path).stem().string(), {}, {}, {}};
    for (const std::string& name : lines[0]) view.columns.push_back({name, "", "", false, false});
    for (std::size_t line = 1; line < lines.size(); ++line) {
        if (lines[line].size() != view.columns.size())
            throw engine::RecordError(fmt::format("{}:{}: {} cells, not {}", path, line + 1, lines[line].size(), view.columns.size()));
        view.cells.push_back(std::move(lines[line]));
    }
    return view;
}

SweepView from_table(const std::string& path) {
    engine::CaseTable table = tasks::read_results(path);
    tasks::sort_rows(table);
    SweepView view{path, table.attribute("sweep"), table.attributes, {}, {}};
    const auto& columns = table.layout.columns();
    for (const engine::CaseColumn& column : columns) view.columns.push_back({column.name, column.unit, column.description, false, false});
    for (std::size_t row = 0; row < table.size(); ++row) {
        auto& cells = view.cells.emplace_back();
        for (std::size_t c = 0; c < columns.size(); ++c) cells.push_back(table.layout.cell(table.row(row), c));
    }
    return view;
}

}  // namespace

std::size_t SweepView::column(const std::string& word) const {
    std::vector<std::string> names;
    for (std::size_t c = 0; c < columns.size(); ++c) {
        if (columns[c].name == in_table(word)) return c;
        names.push_back(columns[c].name);
    }
    throw UsageError(
        fmt::format("{}: the table {} has no such column{}", word, path, engine::did_you_mean(engine::closest(in_table(word), names))));
}

double SweepView::number(std::size_t row, std::size_t column) const { return as_number(cells[row][column]); }

void SweepView::keep(const std::string& condition) {
    const auto equals = condition.find('=');
    if (equals == std::string::npos) throw UsageError(fmt::format("--where {}: expected COLUMN=VALUE", condition));
    const std::size_t c = column(condition.substr(0, equals));
    const std::string value_text = condition.substr(equals + 1);
    const double value = as_number(value_text);
    std::erase_if(cells, [&](const auto& row) { return row[c] != value_text && as_number(row[c]) != value; });
    if (cells.empty()) throw UsageError(fmt::format("--where {}: no case of {} is left", condition, path));
}

void SweepView::keep_good() {
    const auto status = std::find_if(columns.begin(), columns.end(), [](const SweepColumn& column) { return column.name == "status"; });
    if (status == columns.end()) return;
    const auto c = static_cast<std::size_t>(status - columns.begin());
    std::erase_if(cells, [&](const auto& row) { return row[c] != "ok"; });
}

bool is_sweep(const std::string& path) {
    const std::filesystem::path file(path);
    if (std::filesystem::is_directory(file) || file.extension() == ".csv") return true;
    if (file.filename() == "cases.h5") return true;
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
        column.number = false;
        for (std::size_t row = 0; row < view.cells.size() && !column.number; ++row) column.number = std::isfinite(view.number(row, c));
    }
    return view;
}

}  // namespace cvtflow::tools
