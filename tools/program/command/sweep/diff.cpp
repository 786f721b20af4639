#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tasks/batch/results/results.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/program.hpp"
#include "tools/program/text/report_columns.hpp"
#include "tools/program/view/sweep_view.hpp"

namespace cvtflow::tools {

namespace {

/// A case that is in both tables.
struct Pair {
    std::string name;  ///< the values of its keys
    std::size_t a = 0, b = 0;
};

/// Differences in a column.
struct ColumnDifference {
    std::string name, unit;
    double factor = 1.0;  ///< factor from SI to `unit`
    long cases = 0;
    double largest = 0.0, relative = 0.0;  ///< largest |a - b| [SI] and |a - b| / max(|a|, |b|); NaN if texts differ
    std::string example, shown;            ///< the case of the largest relative difference, and both cells: in SI, in `unit`
};

/// @param tolerance with one, hashes of cases do not count: they differ where any bit does
bool is_compared(const SweepColumn& column, double tolerance) {
    return !column.axis && column.name != "case" && tasks::is_hashed(column.name) && !(tolerance > 0.0 && column.name == "hash");
}

/// Cases by the values of the keys that both tables have. @throws UsageError if these do not tell the cases of a table apart
std::map<std::string, std::size_t> rows_by_keys(const SweepView& sweep, const std::vector<std::string>& keys) {
    std::map<std::string, std::size_t> rows;
    std::vector<std::size_t> columns;
    for (const std::string& key : keys) columns.push_back(sweep.column(key));
    for (std::size_t row = 0; row < sweep.cells.size(); ++row) {
        std::string name;
        for (std::size_t k = 0; k < keys.size(); ++k)
            name += fmt::format("{}{} = {}", name.empty() ? "" : ", ", keys[k], sweep.cells[row][columns[k]]);
        if (!rows.emplace(name, row).second)
            throw UsageError(fmt::format("{}: several cases have {}; both tables need the keys in which they differ", sweep.path,
                                         name.empty() ? "no key" : name));
    }
    return rows;
}

bool has_column(const SweepView& sweep, const std::string& name, bool axis) {
    return std::ranges::any_of(sweep.columns, [&](const SweepColumn& column) { return (column.axis || !axis) && column.name == name; });
}

std::vector<std::string> common_keys(const SweepView& a, const SweepView& b) {
    std::vector<std::string> keys;
    for (const SweepColumn& column : a.columns)
        if (column.axis && tasks::is_hashed(column.name) && has_column(b, column.name, true)) keys.push_back(column.name);
    return keys;
}

/// @param factor from SI to the unit in which a column is shown
std::string cell_text(const SweepView& sweep, std::size_t row, std::size_t column, double factor) {
    const double value = factor * sweep.number(row, column);
    return std::isfinite(value) ? fmt::format("{:.8g}", value) : sweep.cells[row][column].empty() ? "nothing" : sweep.cells[row][column];
}

/// Text of two cells in one unit, SI for files.
std::string change_text(const SweepView& a, const SweepView& b, const std::string& column, const Pair& pair, double factor) {
    return fmt::format("{}: {} -> {}", pair.name, cell_text(a, pair.a, a.column(column), factor),
                       cell_text(b, pair.b, b.column(column), factor));
}

/// Counts the cases whose cells differ by more than `tolerance`.
ColumnDifference column_difference(const SweepView& a, const SweepView& b, const std::string& name, const std::vector<Pair>& pairs,
                                   double tolerance) {
    const std::size_t ca = a.column(name), cb = b.column(name);
    const Shown how = shown(name, a.columns[ca].unit);
    ColumnDifference found{name, how.unit, how.factor, 0, 0.0, 0.0, "", ""};
    for (const Pair& pair : pairs) {
        const std::string &left = a.cells[pair.a][ca], &right = b.cells[pair.b][cb];
        if (left == right) continue;
        const double x = a.number(pair.a, ca), y = b.number(pair.b, cb), size = std::max(std::abs(x), std::abs(y));
        const double relative = std::abs(x - y) / (size > 0.0 ? size : 1.0);  // NaN: one is a text, or undefined
        if (relative <= tolerance) continue;
        if (++found.cases == 1 || !(relative <= found.relative)) {
            found.relative = relative;
            found.example = change_text(a, b, name, pair, 1.0);
            found.shown = change_text(a, b, name, pair, how.factor);
        }
        found.largest = std::isnan(x - y) || std::abs(x - y) > found.largest ? std::abs(x - y) : found.largest;
    }
    return found;
}

std::vector<ReportColumn<ColumnDifference>> difference_columns() {
    using Row = ColumnDifference;
    const auto number = [](double value) { return std::isnan(value) ? "-" : fmt::format("{:.3g}", value); };
    return {
        {"column", "column", [](const Row& row) { return row.name; },
         [](const Row& row) { return row.unit.empty() ? row.name : fmt::format("{} [{}]", row.name, row.unit); }, Align::left},
        {"cases", "cases", [](const Row& row) { return row.cases; }, [](const Row& row) { return std::to_string(row.cases); }},
        {"largest", "largest difference", [](const Row& row) { return row.largest; },
         [number](const Row& row) { return number(row.factor * row.largest); }},
        {"relative", "relative", [](const Row& row) { return row.relative; }, [number](const Row& row) { return number(row.relative); }},
        {"example", "where", [](const Row& row) { return row.example; }, [](const Row& row) { return row.shown; }, Align::left}};
}

struct DiffArguments {
    std::string a, b;
    double tolerance = 0.0;
    std::vector<std::string> columns;
    bool json = false;
};

ExitStatus diff(const DiffArguments& arguments) {
    const SweepView a = read_sweep(arguments.a), b = read_sweep(arguments.b);
    const std::vector<std::string> keys = common_keys(a, b);
    const std::map<std::string, std::size_t> in_a = rows_by_keys(a, keys), in_b = rows_by_keys(b, keys);
    std::vector<Pair> pairs;
    for (const auto& [name, row] : in_a)
        if (const auto other = in_b.find(name); other != in_b.end()) pairs.push_back({name, row, other->second});
    if (pairs.empty()) throw UsageError(fmt::format("{} and {}: no case has the same {}", a.path, b.path, fmt::join(keys, ", ")));
    std::vector<std::string> names = arguments.columns, lacking;
    for (const SweepColumn& column : a.columns) {
        if (!arguments.columns.empty() || !is_compared(column, arguments.tolerance)) continue;
        (has_column(b, column.name, false) ? names : lacking).push_back(column.name);
    }
    std::vector<ColumnDifference> different;
    for (const std::string& name : names)
        if (ColumnDifference found = column_difference(a, b, name, pairs, arguments.tolerance); found.cases > 0)
            different.push_back(std::move(found));
    const bool same_cases = pairs.size() == in_a.size() && pairs.size() == in_b.size();
    const bool equal = different.empty() && lacking.empty() && same_cases;
    if (arguments.json) {
        fmt::print("{}", json_text({{"a", a.path},
                                    {"b", b.path},
                                    {"cases", {in_a.size(), in_b.size()}},
                                    {"in_both", pairs.size()},
                                    {"tolerance", arguments.tolerance},
                                    {"equal", equal},
                                    {"columns", report_json(difference_columns(), different)}}));
        return equal ? ExitStatus::finished : ExitStatus::error;
    }
    fmt::print("{} cases in {}, {} in {}, {} in both; {} columns compared, {} differ{}\n", in_a.size(), a.path, in_b.size(), b.path,
               pairs.size(), names.size(), different.size(),
               arguments.tolerance > 0.0 ? fmt::format(" by more than {:g} of the value", arguments.tolerance) : "");
    if (!lacking.empty()) fmt::print("only in {}: {}\n", a.path, fmt::join(lacking, ", "));
    if (!different.empty()) fmt::print("{}", report_table(difference_columns(), different));
    return equal ? ExitStatus::finished : ExitStatus::error;
}

}  // namespace

Action declare_diff(CLI::App& app) {
    const auto arguments = std::make_shared<DiffArguments>();
    with_default_place(app.add_option("A", arguments->a, "Folder of a sweep, its cases.h5, or a CSV of it"))->required()->type_name("");
    with_default_place(app.add_option("B", arguments->b, "The same of another sweep"))->required()->type_name("");
    app.add_option("--tolerance", arguments->tolerance, "Relative difference up to which numbers count as equal, e.g. 1e-3")
        ->check(CLI::Range(0.0, 1.0))
        ->type_name("NUMBER")
        ->capture_default_str();
    declare_repeated(app, "--column", arguments->columns, "Compare this column only; may be repeated", "NAME");
    app.add_flag("--json", arguments->json, "Differences as JSON, with provenance");
    app.footer(
        "Cases are the same if their keys have the same values. Wall times, threads, versions and starts are not compared.\n\n"
        "Exit status: 0 equal, 1 different, or an error (message on stderr).");
    return [arguments] { return diff(*arguments); };
}

}  // namespace cvtflow::tools
