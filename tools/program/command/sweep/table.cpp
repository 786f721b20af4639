#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/base/rainflow.hpp"
#include "engine/base/text.hpp"
#include "tasks/batch/results/results.hpp"
#include "tasks/batch/sweep/scalar.hpp"
#include "tasks/scene/units.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/command/sweep/batch.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/program.hpp"
#include "tools/program/text/report_columns.hpp"
#include "tools/program/view/recorded_run.hpp"
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
    bool csv = false, json = false, units = false;
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

/// A load over time: one element of a channel.
struct Load {
    std::string name, unit;
    std::vector<double> time, history;
    std::vector<engine::RainflowCycle> cycles;
};

/// Duration of a round of the chain; 0 if the record does not contain it [s].
double round_time(const RecordedRun& run) {
    const auto pins = run.pin_frequency();
    return pins ? run.scene()->parameters.chain.pins / *pins : 0.0;
}

/// Length of the load in rounds of the chain; 0 if their duration is unknown [1].
double rounds_of(const Load& load, double round) {
    return round > 0.0 && !load.time.empty() ? (load.time.back() - load.time.front()) / round : 0.0;
}

/// Damage-equivalent range: one cycle of it per round of the chain does the same damage by Miner's rule (one cycle per record, if shorter
/// than a round): (sum n_i range_i^m / rounds)^(1/m).
double equivalent_range(const Load& load, double exponent, double rounds) {
    double largest = 0.0, sum = 0.0;
    for (const engine::RainflowCycle& cycle : load.cycles) largest = std::max(largest, cycle.range);
    for (const engine::RainflowCycle& cycle : load.cycles) sum += cycle.count * std::pow(cycle.range / largest, exponent);
    return load.cycles.empty() ? 0.0 : largest * std::pow(sum / std::max(1.0, rounds), 1.0 / exponent);
}

/// The elements that a request names. @throws UsageError
std::vector<int> elements_of(const engine::ChannelInfo& channel, const std::string& request) {
    const auto bracket = request.find('[');
    if (bracket == std::string::npos) {
        if (channel.width == 1) return {0};
        throw UsageError(fmt::format("--rainflow {0}: it has {1} numbers; write {0}[0] ... {0}[{2}], or {0}[*]", channel.name,
                                     channel.width, channel.width - 1));
    }
    const std::string_view index = std::string_view(request).substr(bracket);
    if (index == "[*]") {
        std::vector<int> all(static_cast<std::size_t>(channel.width));
        for (std::size_t k = 0; k < all.size(); ++k) all[k] = static_cast<int>(k);
        return all;
    }
    int element = -1;
    const auto [stop, error] = std::from_chars(index.data() + 1, index.data() + index.size(), element);
    const bool good = error == std::errc() && std::string_view(stop, index.data() + index.size()) == "]";
    if (!good || element < 0 || element >= channel.width)
        throw UsageError(fmt::format("--rainflow {}: elements are numbered 0 to {}", request, channel.width - 1));
    return {element};
}

const engine::ChannelInfo& channel_of(const RecordedRun& run, const std::string& request) {
    const std::string name = request.substr(0, request.find('['));
    if (const engine::ChannelInfo* channel = run.channel(name)) return *channel;
    if (const std::string how = how_to_record(name); !how.empty())
        throw UsageError(fmt::format("--rainflow {}: the run was recorded without this channel ({})", name, how));
    std::vector<std::string> names;
    for (const engine::ChannelInfo& channel : run.reader().channels()) names.push_back(channel.name);
    throw UsageError(fmt::format("--rainflow {}: the record has no such channel{} (cvtflow info shows them)", name,
                                 engine::did_you_mean(engine::closest(name, names))));
}

std::vector<Load> loads_of(const RecordedRun& run, const TableArguments& arguments) {
    const double from = arguments.from.empty() ? 0.0 : instant_of("--from", arguments.from);
    const double until = arguments.until.empty() ? INFINITY : instant_of("--until", arguments.until);
    const std::vector<double>& times = run.times();
    std::vector<Load> loads;
    for (const std::string& requested : arguments.rainflow) {
        const engine::ChannelInfo& channel = channel_of(run, requested);
        const std::vector<double> values = run.values(channel.name);
        const std::size_t width = static_cast<std::size_t>(channel.width);
        for (const int element : elements_of(channel, requested)) {
            Load load{width == 1 ? channel.name : fmt::format("{}[{}]", channel.name, element), channel.unit, {}, {}, {}};
            for (std::size_t row = 0; row < times.size(); ++row) {
                const double value = values[row * width + static_cast<std::size_t>(element)];
                if (times[row] < from || times[row] > until || !std::isfinite(value)) continue;
                load.time.push_back(times[row]);
                load.history.push_back(value);
            }
            load.cycles = engine::rainflow(load.history);
            loads.push_back(std::move(load));
        }
    }
    return loads;
}

std::string span_text(const Load& load) {
    if (load.time.empty()) return "no outputs";
    return fmt::format("{} outputs from {} to {}", load.time.size(), time_text(load.time.front()), time_text(load.time.back()));
}

/// The equivalent load, and a note for a short record.
std::string damage_text(const Load& load, double exponent, double round) {
    const double rounds = rounds_of(load, round);
    const std::string each =
        rounds >= 1.0 ? fmt::format("one cycle per round of the chain ({:.3g} rounds)", rounds) : "one cycle in the record";
    const Shown how = shown(load.name, load.unit);
    std::string text = fmt::format("  damage-equivalent range {:.6g} {} (exponent {:g}, {})\n",
                                   how.factor * equivalent_range(load, exponent, rounds), how.unit, exponent, each);
    if (rounds > 0.0 && rounds < 1.0)
        text += fmt::format("  note: the record covers {:.2g} of a round of the chain ({}); no link has seen all of its loads\n", rounds,
                            time_text(round));
    return text;
}

/// Classes of ranges: the table of the text, and a part of the JSON.
std::vector<ReportColumn<engine::RainflowClass>> class_columns(const Load& load) {
    using Class = engine::RainflowClass;
    const auto column = [](const char* key, const std::string& heading, double Class::*number, double factor) -> ReportColumn<Class> {
        return {key, heading, [number](const Class& each) { return each.*number; },
                [number, factor](const Class& each) { return fmt::format("{:.6g}", factor * each.*number); }};
    };
    const Shown how = shown(load.name, load.unit);
    const std::string unit = fmt::format(" [{}]", how.unit);
    return {column("from", "range from" + unit, &Class::from, how.factor), column("to", "to" + unit, &Class::to, how.factor),
            column("count", "cycles", &Class::count, 1.0), column("mean", "mean" + unit, &Class::mean, how.factor),
            column("largest", "largest range" + unit, &Class::largest, how.factor)};
}

/// A cycle, and the load that it was counted in.
struct CycleOfLoad {
    const Load& load;
    const engine::RainflowCycle& cycle;
};

/// @param count name of the column of counts
std::vector<ReportColumn<CycleOfLoad>> cycle_columns(const char* count) {
    const auto column = [](const char* key, double (*number)(const CycleOfLoad&)) -> ReportColumn<CycleOfLoad> {
        return {key, "", number, {}, Align::right, all_digits};
    };
    return {column("range", [](const CycleOfLoad& of) { return of.cycle.range; }),
            column("mean", [](const CycleOfLoad& of) { return of.cycle.mean; }),
            column(count, [](const CycleOfLoad& of) { return of.cycle.count; }),
            column("from_time", [](const CycleOfLoad& of) { return of.load.time[of.cycle.first]; }),
            column("to_time", [](const CycleOfLoad& of) { return of.load.time[of.cycle.second]; })};
}

std::vector<CycleOfLoad> cycles_of(std::span<const Load> loads) {
    std::vector<CycleOfLoad> cycles;
    for (const Load& load : loads)
        for (const engine::RainflowCycle& cycle : load.cycles) cycles.push_back({load, cycle});
    return cycles;
}

std::string rainflow_text(const Load& load, int classes) {
    std::vector<engine::RainflowClass> counted = engine::rainflow_classes(load.cycles, classes);
    std::erase_if(counted, [](const engine::RainflowClass& each) { return !(each.count > 0.0); });
    return fmt::format("{}: rainflow counts (ASTM E1049) of {}\n", load.name, span_text(load)) +
           (load.cycles.empty() ? "  no cycles\n" : report_table(class_columns(load), counted));
}

std::string rainflow_csv(const std::vector<Load>& loads) {
    std::vector<ReportColumn<CycleOfLoad>> columns = cycle_columns("cycles");
    columns.insert(columns.begin(), {{"load", "", [](const CycleOfLoad& of) { return of.load.name; }},
                                     {"unit", "", [](const CycleOfLoad& of) { return of.load.unit; }}});
    return report_csv(columns, cycles_of(loads));
}

nlohmann::ordered_json rainflow_json(const Load& load, const TableArguments& arguments, double round) {
    const double rounds = rounds_of(load, round);
    const nlohmann::ordered_json damage{{"exponent", arguments.exponent},
                                        {"range", equivalent_range(load, arguments.exponent, rounds)},
                                        {"reference_cycles", std::max(1.0, rounds)},
                                        {"rounds", rounds}};
    return {{"load", load.name},
            {"unit", load.unit},
            {"outputs", load.time.size()},
            {"damage_equivalent", damage},
            {"classes", report_json(class_columns(load), engine::rainflow_classes(load.cycles, arguments.classes))},
            {"cycles", report_json(cycle_columns("count"), cycles_of({&load, 1}))}};
}

/// Text: cycles by classes of range. CSV: every cycle. JSON: both, with provenance.
std::string rainflow_report(const TableArguments& arguments) {
    const RecordedRun run(arguments.folder);
    const std::vector<Load> loads = loads_of(run, arguments);
    const double round = round_time(run);
    if (arguments.csv) return rainflow_csv(loads);
    std::string text;
    auto all = nlohmann::ordered_json::array();
    for (const Load& load : loads) {
        if (arguments.json)
            all.push_back(rainflow_json(load, arguments, round));
        else
            text += (text.empty() ? "" : "\n") + rainflow_text(load, arguments.classes) + damage_text(load, arguments.exponent, round);
    }
    if (!arguments.json) return text;
    return json_text({{"record", arguments.folder}, {"method", "ASTM E1049 rainflow"}, {"loads", all}, {"provenance", provenance_json()}});
}

ExitStatus show_rainflow(const TableArguments& arguments) {
    if (!arguments.columns.empty() || !arguments.status.empty())
        throw UsageError("--column and --status apply to sweeps, --rainflow to a record");
    if (arguments.csv && arguments.json) throw UsageError("--csv or --json, not both");
    fmt::print("{}", rainflow_report(arguments));
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
    app.add_option("DIR", arguments->folder,
                   "Folder of a sweep, also of a running one, or its cases.h5. With --rainflow: the record of a run")
        ->required()
        ->type_name("");
    app.add_flag("--csv", arguments->csv, "Print all columns as CSV, in SI units, numbers with all digits");
    app.add_flag("--units", arguments->units, "CSV: headings with units, \"load_torque [N*m]\"");
    app.add_flag_callback("--si", show_si, si_meaning);
    declare_repeated(app, "--column", arguments->columns,
                     "Show this column, also by its key or scalar (load.torque, \"slip mean\"); may be repeated", "NAME");
    declare_rainflow(app, *arguments);
    app.add_option("--status", arguments->status, "Show only cases with this status")->type_name("STATUS");
    app.footer("In Python: h5py.File(\"DIR/cases.h5\")[\"cases\"][:] is a NumPy table; pandas.DataFrame takes it.");
    return [arguments] { return arguments->rainflow.empty() ? show(*arguments) : show_rainflow(*arguments); };
}

}  // namespace cvtflow::tools
