#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/base/text.hpp"
#include "tasks/batch/results/results.hpp"
#include "tasks/batch/sweep/scalar.hpp"
#include "tasks/scene/units.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/command/sweep/batch.hpp"
#include "tools/program/drawing.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/program.hpp"
#include "tools/program/text/report_columns.hpp"
#include "tools/program/view/described.hpp"
#include "tools/program/view/sweep_view.hpp"

namespace cvtflow::tools {

namespace {

struct TableArguments {
    std::string folder;
    std::vector<std::string> columns;
    std::string status;
    std::vector<std::string> rainflow;
    int classes = 16;
    double exponent = 5.0;
    std::string from, until;
    bool csv = false, json = false, units = false, si = false;
};

/// --csv prints SI units.
Shown how_to_show(const engine::TableColumn& column) {
    return column.type == engine::ColumnType::real ? shown(column.name, column.unit) : Shown{};
}

std::string heading(const engine::TableColumn& column) {
    const std::string unit = how_to_show(column).unit;
    return unit.empty() ? column.name : fmt::format("{} [{}]", column.name, unit);
}

std::string short_cell(const engine::CaseTable& table, std::size_t row, std::size_t column) {
    if (table.layout.columns()[column].type != engine::ColumnType::real) return table.layout.cell(table.row(row), column);
    const double value = how_to_show(table.layout.columns()[column]).factor * table.layout.real(table.row(row), column);
    return std::isnan(value) ? "-" : fmt::format("{:.6g}", value);
}

/// The requested columns; by default all except counters.
std::vector<std::size_t> chosen_columns(const engine::RowLayout& layout, const std::vector<std::string>& names) {
    constexpr std::string_view quiet[] = {"start",     "start_state",          "program", "steps", "evaluations", "transitions",
                                          "truncated", "settling_evaluations", "threads", "hash"};
    std::vector<std::size_t> chosen;
    std::vector<std::string> known;
    for (const engine::TableColumn& column : layout.columns()) known.push_back(column.name);
    for (const std::string& name : names) {
        const std::string column = tasks::column_name(name);
        if (!layout.has(column))
            throw UsageError(
                fmt::format("--column {}: the table has no such column{}", name, engine::did_you_mean(engine::closest(column, known))));
        chosen.push_back(layout.column(column));
    }
    for (std::size_t i = 0; names.empty() && i < layout.columns().size(); ++i) {
        if (std::find(std::begin(quiet), std::end(quiet), layout.columns()[i].name) == std::end(quiet)) chosen.push_back(i);
    }
    return chosen;
}

std::string table_text(const engine::CaseTable& table, const std::vector<std::size_t>& chosen) {
    std::vector<Table::Column> columns;
    for (const std::size_t c : chosen)
        columns.push_back(
            {heading(table.layout.columns()[c]), table.layout.columns()[c].type == engine::ColumnType::text ? Align::left : Align::right});
    Table text(columns);
    for (std::size_t row = 0; row < table.size(); ++row) {
        std::vector<std::string> cells;
        for (const std::size_t c : chosen) cells.push_back(short_cell(table, row, c));
        text.add(cells);
    }
    return text.text();
}

/// "load_torque [N*m],slip_mean [1],…": the first line of a CSV.
std::string headings_with_units(const engine::RowLayout& layout) {
    std::string text;
    for (const engine::TableColumn& column : layout.columns()) {
        const std::string unit = column.unit.empty() ? "" : fmt::format(" [{}]", column.unit);
        text += (text.empty() ? "" : ",") + csv_cell(column.name + unit);
    }
    return text;
}

bool has_notes(const engine::CaseTable& table) {
    bool any = false;
    for (std::size_t row = 0; table.layout.has("notes") && row < table.size(); ++row)
        any = any || !table.layout.text(table.row(row), table.layout.column("notes")).empty();
    return any;
}

void keep_status(engine::CaseTable& table, const std::string& status) {
    require_statuses("--status", {status});
    std::vector<std::byte> kept;
    for (std::size_t row = 0; row < table.size(); ++row) {
        if (table.layout.text(table.row(row), table.layout.column("status")) == status)
            kept.insert(kept.end(), table.row(row).begin(), table.row(row).end());
    }
    table.rows = std::move(kept);
}

ExitStatus show(const TableArguments& arguments) {
    if (arguments.json || !arguments.from.empty() || !arguments.until.empty())
        throw UsageError("--json, --from and --until require --rainflow");
    const std::string file = table_path(arguments.folder);
    engine::CaseTable table = tasks::read_results(file);
    tasks::sort_rows(table);
    const std::string hash = tasks::results_hash(table);
    if (!arguments.status.empty()) keep_status(table, arguments.status);
    if (arguments.units && !arguments.csv) throw UsageError("--units requires --csv");
    if (arguments.csv) {
        const std::string text = tasks::csv_text(table);
        fmt::print("{}", arguments.units ? headings_with_units(table.layout) + text.substr(text.find('\n')) : text);
        return ExitStatus::finished;
    }
    fmt::print("{}\n", table_text(table, chosen_columns(table.layout, arguments.columns)));
    const auto of = [&table](const char* name) { return engine::visible(table.attribute(name)); };
    if (has_notes(table)) fmt::print("notes: cvtflow list notes states their meanings\n");
    fmt::print("{}: {} of {} cases, {}, results hash {}\n", of("sweep"), table.size(), of("cases"), of("status"), hash);
    if (const std::string choice = of("accuracy_choice"); !choice.empty())
        fmt::print("accuracy {}: {} (largest error at the corners {})\n", of("accuracy_target"), choice, of("accuracy_at_corners"));
    if (const std::string error = of("continuation_error"); !error.empty()) fmt::print("continuation error per output: {}\n", error);
    if (const std::string check = of("steady_check"); !check.empty()) fmt::print("changes in three times as long: {}\n", check);
    return ExitStatus::finished;
}

/// A time in SI or with a unit. @throws UsageError
double instant_of(const std::string& option, const std::string& text) {
    const auto parsed = tasks::parse_quantity(text);
    const auto* time = std::get_if<tasks::Quantity>(&parsed);
    if (time == nullptr || (time->has_unit && !(time->dimension == tasks::dimension_of("s"))))
        throw UsageError(fmt::format("{} {}: not a time", option, text));
    return time->value;
}

/// Request to the Python package, which counts and writes.
nlohmann::json rainflow_request(const TableArguments& arguments) {
    const double from = arguments.from.empty() ? 0.0 : instant_of("--from", arguments.from);
    const double until = arguments.until.empty() ? INFINITY : instant_of("--until", arguments.until);
    return {{"command", "rainflow"},
            {"known", known_json()},
            {"records", nlohmann::json::array({described(RecordedRun(arguments.folder))})},
            {"format", arguments.json  ? "json"
                       : arguments.csv ? "csv"
                                       : "text"},
            {"provenance", provenance_json().dump()},
            {"options",
             {{"channels", arguments.rainflow},
              {"classes", arguments.classes},
              {"exponent", arguments.exponent},
              {"from", from},
              {"until", until},
              {"si", arguments.si}}}};
}

ExitStatus show_rainflow(const TableArguments& arguments) {
    if (!arguments.columns.empty() || !arguments.status.empty())
        throw UsageError("--column and --status apply to sweeps, --rainflow to a record");
    if (arguments.csv && arguments.json) throw UsageError("--csv or --json, not both");
    fmt::print("{}", drawn(rainflow_request(arguments)));
    return ExitStatus::finished;
}

void declare_rainflow(CLI::App& app, TableArguments& arguments) {
    declare_repeated(
        app, "--rainflow", arguments.rainflow,
        "Count the load cycles (ASTM E1049) of a channel, or of its elements NAME[3], NAME[*]; DIR is the record of a run; may "
        "be repeated",
        "CHANNEL");
    app.add_option("--classes", arguments.classes, "Number of classes of ranges")
        ->check(CLI::Range(1, 10000))
        ->type_name("COUNT")
        ->capture_default_str();
    app.add_option("--exponent", arguments.exponent, "Exponent of the Woehler line, for the damage-equivalent range")
        ->check(CLI::Range(1.0, 50.0))
        ->type_name("NUMBER")
        ->capture_default_str();
    app.add_option("--from", arguments.from, "Start of counting")->type_name("TIME");
    app.add_option("--until", arguments.until, "End of counting")->type_name("TIME");
    app.add_flag("--json", arguments.json, "Cycles and classes as JSON, with provenance");
}

}  // namespace

Action declare_table(CLI::App& app) {
    const auto arguments = std::make_shared<TableArguments>();
    with_default_place(app.add_option("DIR", arguments->folder,
                                      "Folder of a sweep, also of a running one, or its cases.h5. With --rainflow: the record of a run"))
        ->required()
        ->type_name("");
    app.add_flag("--csv", arguments->csv, "Print all columns as CSV, in SI units, numbers with all digits");
    app.add_flag("--units", arguments->units, "CSV: headings with units, \"load_torque [N*m]\"");
    app.add_flag_callback(
        "--si", [arguments] { show_si(), arguments->si = true; }, si_meaning);
    declare_repeated(app, "--column", arguments->columns,
                     "Show this column, also by its key or scalar (load.torque, \"slip mean\"); may be repeated", "NAME");
    declare_rainflow(app, *arguments);
    app.add_option("--status", arguments->status, "Show only cases with this status")->type_name("STATUS");
    app.footer("In Python: h5py.File(\"DIR/cases.h5\")[\"cases\"][:] is a NumPy table; pandas.DataFrame takes it.");
    return [arguments] { return arguments->rainflow.empty() ? show(*arguments) : show_rainflow(*arguments); };
}

}  // namespace cvtflow::tools
