/// cvtflow-lab detail: cost and errors of each key of detail, or of each level.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "bench/lab/command/command.hpp"
#include "bench/lab/measure/detail_measure.hpp"
#include "bench/lab/text/text.hpp"
#include "bench/study/profile/statistics.hpp"
#include "tasks/method/method.hpp"
#include "tasks/scene/csv.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/plot/plot.hpp"
#include "tools/program/text/report_columns.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

Table empty_table() {
    const auto right = [](const char* heading) { return Table::Column{heading, Align::right}; };
    return Table({{"detail"},
                  right("coordinates"),
                  right("cost us"),
                  right("tight %"),
                  right("slack %"),
                  right("pin end %"),
                  right("slip %"),
                  right("efficiency %-pt"),
                  right("thrust ratio %"),
                  right("shift %/s"),
                  right("drift %"),
                  right("residual"),
                  {"status"}});
}

std::string relative(double value, double exact) { return exact == 0.0 ? "-" : fmt::format("{:+.2f}", 100.0 * (value / exact - 1.0)); }

void add_row(Table& table, const DetailOutcome& o, const DetailOutcome& reference) {
    if (!o.fault.empty()) {
        table.add({o.variant.name(), std::to_string(o.coordinates), "-", "-", "-", "-", "-", "-", "-", "-", "-", "-", o.status});
        return;
    }
    table.add({o.variant.name(), std::to_string(o.coordinates), fmt::format("{:.2f}", 1e6 * o.cost), relative(o.tight, reference.tight),
               relative(o.slack, reference.slack), relative(o.tip, reference.tip), relative(o.slip, reference.slip),
               fmt::format("{:+.3f}", 100.0 * (o.efficiency - reference.efficiency)), relative(o.thrust, reference.thrust),
               fmt::format("{:+.2f}", 100.0 * (o.shift - reference.shift)), fmt::format("{:+.2f}", 100.0 * o.drift),
               residual_cell({}, o.watch), o.status});
}

std::string_view pins_of(const DetailOutcome& o) { return name_of(o.variant.pins); }

/// Cells of the variant's dials.
std::string dials_csv(const DetailOutcome& o) {
    return fmt::format("{},{},{},{},{:g}", pins_of(o), o.variant.plates == model::PlateDetail::each ? "each" : "lumped",
                       o.variant.joint_points, o.variant.pulleys == model::PulleyDetail::elastic ? "elastic" : "rigid",
                       o.variant.mass_scaling);
}

std::string csv_of(const std::vector<DetailOutcome>& outcomes) {
    std::string text =
        "pins,plates,joint_points,pulleys,mass_scaling,coordinates,cost_s,tight_N,slack_N,pin_axial_N,slip,ratio,shift_per_s,thrust_"
        "ratio,drift,";
    text += watch_heading + std::string("\n");
    for (const DetailOutcome& o : outcomes) {
        if (!o.fault.empty()) {
            text += fmt::format("{},{},,,,,,,,,,{},,,,,,\n", dials_csv(o), o.coordinates, tasks::csv_cell(o.status, true));
            continue;
        }
        text += fmt::format("{},{},{:.4g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.4g},{},{:.3g},{}\n", dials_csv(o), o.coordinates, o.cost,
                            o.tight, o.slack, o.tip, o.slip, o.ratio, o.shift, o.thrust == 0.0 ? "" : fmt::format("{:.6g}", o.thrust),
                            o.drift, watch_csv({}, o.watch));
    }
    return text;
}

nlohmann::ordered_json row_json(const DetailOutcome& o) {
    nlohmann::ordered_json row{{"pins", pins_of(o)},
                               {"plates", o.variant.plates == model::PlateDetail::each ? "each" : "lumped"},
                               {"joint_points", o.variant.joint_points},
                               {"pulleys", o.variant.pulleys == model::PulleyDetail::elastic ? "elastic" : "rigid"},
                               {"mass_scaling", o.variant.mass_scaling},
                               {"coordinates", o.coordinates}};
    if (!o.fault.empty()) {
        row["status"] = o.status;
        row["fault"] = o.fault;
        return row;
    }
    const nlohmann::ordered_json figures{
        {"cost", o.cost},     {"tight", o.tight}, {"slack", o.slack},
        {"pin_axial", o.tip}, {"slip", o.slip},   {"efficiency", o.efficiency},
        {"ratio", o.ratio},   {"shift", o.shift}, {"thrust_ratio", o.thrust == 0.0 ? std::nan("") : o.thrust},
        {"drift", o.drift}};
    row.update(figures);
    row.update(watch_json({}, o.watch));
    return row;
}

std::string json_of(const std::vector<DetailOutcome>& outcomes, const DetailArguments& arguments, const std::string& scene) {
    auto rows = nlohmann::ordered_json::array();
    for (const DetailOutcome& outcome : outcomes) rows.push_back(row_json(outcome));
    return json_text({{"scene", scene},
                      {"provenance", provenance_json()},
                      {"method", arguments.method},
                      {"step", arguments.step},
                      {"settle", arguments.settle},
                      {"average", arguments.average},
                      {"variants", rows}});
}

/// Cost against the largest relative difference of forces from full detail.
std::string picture(const std::vector<DetailOutcome>& outcomes, const std::string& scene) {
    Plot plot;
    plot.title = "Cost and difference of levels of detail: " + scene;
    plot.x = {"one right-hand side [us]", Scale::linear, 1.0, 0.0, {}};
    plot.y = {"largest difference of tensions and force of a pin end from full detail [%]", Scale::linear, 1.0, 0.0, {}};
    const DetailOutcome& exact = outcomes.front();
    for (const DetailOutcome& o : outcomes) {
        if (!o.fault.empty()) continue;
        double most = 0.0;
        for (const auto& [value, reference] : {std::pair{o.tight, exact.tight}, {o.slack, exact.slack}, {o.tip, exact.tip}})
            most = std::max(most, std::abs(value / reference - 1.0));
        plot.series.push_back({.name = o.variant.name(), .points = {{1e6 * o.cost, 100.0 * most}}, .line = Line::none, .colour = {}});
    }
    return svg(plot);
}

std::vector<DetailOutcome> measure_all(const DetailArguments& arguments, const std::string& scene) {
    const DetailMeasure measure(arguments, scene);
    std::vector<DetailOutcome> outcomes;
    for (const DetailVariant& variant : detail_variants(arguments.all)) {
        model::Parameters pins;
        pins.detail.pins = variant.pins;
        if (const std::string objection = tasks::objection_to(arguments.method, pins); !objection.empty()) {
            print_error(fmt::format("{}: {}: left out: {}", scene, variant.name(), objection));
            continue;
        }
        outcomes.push_back(measure.measure(variant, outcomes.empty() ? 0.0 : outcomes.front().ratio));
        if (!outcomes.front().fault.empty())
            throw tasks::SimulationError(fmt::format("{}: the reference, full detail, {} {}", scene,
                                                     outcomes.front().status == "unreliable" ? "is" : "ended:", outcomes.front().fault));
        if (catch_interrupts().requested()) break;
    }
    return outcomes;
}

void print(const std::string& scene, const std::vector<DetailOutcome>& outcomes) {
    const DetailOutcome& exact = outcomes.front();
    fmt::print(
        "{}: full detail has tight {:.1f} N, slack {:.1f} N, largest force of an end of a pin {:.1f} N, slip {:.4f} %, efficiency {:.3f} "
        "%, ratio "
        "{:.4f}{}\n",
        scene, exact.tight, exact.slack, exact.tip, 100.0 * exact.slip, 100.0 * exact.efficiency, exact.ratio,
        exact.thrust == 0.0 ? "" : fmt::format(", thrust ratio {:.4f}", exact.thrust));
    Table table = empty_table();
    for (const DetailOutcome& outcome : outcomes) add_row(table, outcome, exact);
    fmt::print("{}", table.text(2));
    const std::string brief = too_short(exact.watch);
    fmt::print("{}\n", brief.empty() ? "" : field("too short", brief));
}

/// Prints a table for every scene, differences from full detail; detail_SCENE.csv, .json, .svg on request. A failed variant is named on
/// stderr and makes the result incomplete.
ExitStatus report_details(const DetailArguments& arguments, const OutputArguments& output) {
    OutputFolder folder(output);
    bool complete = true;
    for (const std::string& scene : arguments.scenes) {
        const std::vector<DetailOutcome> outcomes = measure_all(arguments, scene);
        if (catch_interrupts().requested()) return ExitStatus::cancelled;
        print(scene, outcomes);
        for (const DetailOutcome& outcome : outcomes) {
            if (outcome.fault.empty()) continue;
            print_error(fmt::format("{}: {}: {}", scene, outcome.variant.name(), outcome.fault));
            complete = false;
        }
        const std::string name = "detail_" + scene.substr(scene.find_last_of('/') + 1);
        folder.write(name + ".csv", csv_of(outcomes));
        folder.write(name + ".json", json_of(outcomes, arguments, scene));
        folder.write(name + ".svg", picture(outcomes, scene));
    }
    fmt::print(
        "Columns: difference from full detail; cost: one right-hand side, minimum of 200; thrust ratio: S_1/S_2 at which ratio control "
        "holds the ratio of full detail;\nshift: relative rate of change of the speed ratio at the scene's clamping; drift: change of the "
        "tight strand's tension between both halves of the averaging,\nafter settling for {}; efficiency: over whole pin periods; "
        "residual: "
        "residual of the energy balance over the losses.\n{}",
        arguments.settle, folder.written());
    return complete ? ExitStatus::finished : ExitStatus::incomplete;
}

Table::Column right(const char* heading) { return {heading, Align::right}; }

/// Error of a figure; NaN if it was not determined.
struct Column {
    const char* heading;
    double (*error)(const DetailOutcome& is, const DetailOutcome& should);
    const char* format;
};
double off(double is, double should) { return should == 0.0 || is == 0.0 ? std::nan("") : 100.0 * (is / should - 1.0); }
using D = DetailOutcome;
constexpr Column errors[] = {
    {"tight %", [](const D& is, const D& should) { return off(is.tight, should.tight); }, "{:+.2f}"},
    {"slack %", [](const D& is, const D& should) { return off(is.slack, should.slack); }, "{:+.2f}"},
    {"slip %", [](const D& is, const D& should) { return off(is.slip, should.slip); }, "{:+.2f}"},
    {"pin end %", [](const D& is, const D& should) { return off(is.tip, should.tip); }, "{:+.2f}"},
    {"efficiency %-pt", [](const D& is, const D& should) { return 100.0 * (is.efficiency - should.efficiency); }, "{:+.3f}"},
    {"thrust ratio %", [](const D& is, const D& should) { return off(is.thrust, should.thrust); }, "{:+.2f}"},
    {"shift %/s", [](const D& is, const D& should) { return 100.0 * (is.shift - should.shift); }, "{:+.2f}"},
};

std::string cell(const Column& column, double value) { return std::isnan(value) ? "-" : fmt::format(fmt::runtime(column.format), value); }

/// Costs are relative to the level "fine".
double seconds_of_fine(const Ladder& ladder) {
    for (const DetailLevelResult& level : ladder.levels) {
        if (level.outcome.variant.preset == "fine") return level.seconds;
    }
    return std::nan("");
}

void print(const Ladder& ladder) {
    const DetailOutcome& exact = ladder.reference;
    fmt::print(
        "{}: {} has tight {:.1f} N, slack {:.1f} N, slip {:.4f} %, largest force of an end of a pin {:.1f} N, efficiency {:.3f} %, shift "
        "{:+.2f} %/s{}\n",
        ladder.point.name, exact.variant.name(), exact.tight, exact.slack, 100.0 * exact.slip, exact.tip, 100.0 * exact.efficiency,
        100.0 * exact.shift, exact.thrust == 0.0 ? "" : fmt::format(", thrust ratio {:.4f}", exact.thrust));
    std::vector<Table::Column> columns{{"detail"}, right("step us"), right("s/s"), right("of fine")};
    for (const Column& column : errors) columns.push_back(right(column.heading));
    columns.push_back({"status"});
    Table table(columns);
    for (const DetailLevelResult& level : ladder.levels) {
        std::vector<std::string> cells{level.outcome.variant.name(), fmt::format("{:.2f}", 1e6 * level.outcome.step),
                                       fmt::format("{:.2f}", level.seconds),
                                       fmt::format("{:.2f}", level.seconds / seconds_of_fine(ladder))};
        for (const Column& column : errors)
            cells.push_back(level.outcome.fault.empty() ? cell(column, column.error(level.outcome, exact)) : "-");
        cells.push_back(level.outcome.status);
        table.add(cells);
    }
    fmt::print("{}\n", table.text(2));
}

/// Medians and maxima of the errors over the points.
void print_summary(const std::vector<Ladder>& ladders) {
    if (ladders.size() < 2) return;
    std::vector<Table::Column> columns{{"detail"}, right("of fine")};
    for (const Column& column : errors) columns.push_back(right(column.heading));
    Table table(columns);
    for (std::size_t level = 0; level < ladders.front().levels.size(); ++level) {
        std::vector<double> shares;
        for (const Ladder& ladder : ladders) shares.push_back(ladder.levels[level].seconds / seconds_of_fine(ladder));
        std::vector<std::string> cells{ladders.front().levels[level].outcome.variant.name(), fmt::format("{:.2f}", median(shares))};
        for (const Column& column : errors) {
            std::vector<double> sizes;
            for (const Ladder& ladder : ladders) {
                const double error = std::abs(column.error(ladder.levels[level].outcome, ladder.reference));
                if (ladder.levels[level].outcome.fault.empty() && !std::isnan(error)) sizes.push_back(error);
            }
            cells.push_back(sizes.empty() ? "-"
                                          : fmt::format("{:.2f} ({:.2f})", median(sizes), *std::max_element(sizes.begin(), sizes.end())));
        }
        table.add(cells);
    }
    fmt::print("{} operating points: median of the magnitudes, maximum in brackets\n{}\n", ladders.size(), table.text(2));
}

std::string csv_row(const Ladder& ladder, const DetailOutcome& o, double seconds, double spread) {
    std::string row = fmt::format("{},{},{:g},{},{:.4g},{:.4g},{:.2g},", tasks::csv_cell(ladder.point.name, true), o.variant.preset,
                                  o.variant.share, o.coordinates, o.step, seconds, spread);
    if (!o.fault.empty()) return row + fmt::format(",,,,,,,,,{},,,,,,\n", tasks::csv_cell(o.status, true));
    return row + fmt::format("{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.4g},{},{:.3g},{}\n", o.tight, o.slack, o.tip, o.slip,
                             o.efficiency, o.ratio, o.shift, o.thrust == 0.0 ? "" : fmt::format("{:.6g}", o.thrust), o.drift,
                             watch_csv({}, o.watch));
}

std::string csv_of(const std::vector<Ladder>& ladders) {
    std::string text =
        "point,detail,share,coordinates,step_s,seconds,spread,tight_N,slack_N,pin_axial_N,slip,efficiency,ratio,shift_per_s,thrust_ratio,"
        "drift,";
    text += watch_heading + std::string("\n");
    for (const Ladder& ladder : ladders) {
        text += csv_row(ladder, ladder.reference, 0.0, 0.0);
        for (const DetailLevelResult& level : ladder.levels) text += csv_row(ladder, level.outcome, level.seconds, level.spread);
    }
    return text;
}

nlohmann::ordered_json row_json(const DetailOutcome& o, double seconds) {
    nlohmann::ordered_json row{{"detail", std::string(o.variant.preset)},
                               {"share", o.variant.share},
                               {"coordinates", o.coordinates},
                               {"step", o.step},
                               {"seconds", seconds}};
    if (!o.fault.empty()) {
        row.update({{"status", o.status}, {"fault", o.fault}});
        return row;
    }
    const nlohmann::ordered_json figures{{"tight", o.tight},
                                         {"slack", o.slack},
                                         {"pin_axial", o.tip},
                                         {"slip", o.slip},
                                         {"efficiency", o.efficiency},
                                         {"ratio", o.ratio},
                                         {"shift", o.shift},
                                         {"thrust_ratio", o.thrust == 0.0 ? std::nan("") : o.thrust},
                                         {"drift", o.drift}};
    row.update(figures);
    row.update(watch_json({}, o.watch));
    return row;
}

std::string json_of(const std::vector<Ladder>& ladders, const DetailArguments& arguments) {
    auto points = nlohmann::ordered_json::array();
    for (const Ladder& ladder : ladders) {
        auto rows = nlohmann::ordered_json::array();
        for (const DetailLevelResult& level : ladder.levels) rows.push_back(row_json(level.outcome, level.seconds));
        points.push_back({{"point", ladder.point.name},
                          {"scene", ladder.point.scene},
                          {"settings", ladder.point.settings},
                          {"reference", row_json(ladder.reference, 0.0)},
                          {"levels", rows}});
    }
    return json_text({{"provenance", provenance_json()},
                      {"method", arguments.method},
                      {"step", arguments.step},
                      {"settle", arguments.settle},
                      {"average", arguments.average},
                      {"points", points}});
}

/// Error of slip against cost, one series per level.
std::string picture(const std::vector<Ladder>& ladders) {
    Plot plot;
    plot.title = "Cost of levels of detail and error of slip";
    plot.x = {"processor time per simulated second [s/s]", Scale::logarithmic, 1.0, {}, {}};
    plot.y = {"error of slip [%]", Scale::logarithmic, 1.0, {}, {}};
    for (std::size_t level = 0; level < ladders.front().levels.size(); ++level) {
        Series series{.name = ladders.front().levels[level].outcome.variant.name(), .points = {}, .line = Line::none, .colour = {}};
        for (const Ladder& ladder : ladders) {
            const DetailLevelResult& here = ladder.levels[level];
            if (here.outcome.fault.empty())
                series.points.push_back({here.seconds, std::abs(off(here.outcome.slip, ladder.reference.slip))});
        }
        plot.series.push_back(series);
    }
    return svg(plot);
}

/// Prints a table for every operating point and one of all of them; ladder.csv, .json, .svg on request. A failed level is named on stderr
/// and makes the result incomplete.
ExitStatus report_ladder(const DetailArguments& arguments, const OutputArguments& output) {
    std::vector<Ladder> ladders;
    bool complete = true;
    for (const LadderPoint& point : ladder_points(arguments)) {
        ladders.push_back(measure_ladder(arguments, point));
        if (catch_interrupts().requested()) return ExitStatus::cancelled;
        print(ladders.back());
        std::fflush(stdout);
        for (const DetailLevelResult& level : ladders.back().levels) {
            if (level.outcome.fault.empty()) continue;
            print_error(fmt::format("{}: {}: {}", point.name, level.outcome.variant.name(), level.outcome.fault));
            complete = false;
        }
    }
    print_summary(ladders);
    OutputFolder folder(output);
    folder.write("ladder.csv", csv_of(ladders));
    folder.write("ladder.json", json_of(ladders, arguments));
    folder.write("ladder.svg", picture(ladders));
    fmt::print(
        "s/s: processor time per simulated second, levels alternating; of fine: relative to \"fine\"; thrust ratio: S_1/S_2 at which ratio "
        "control holds\nthe ratio of the reference; shift: relative rate of change of the speed ratio.\n{}",
        folder.written());
    return complete ? ExitStatus::finished : ExitStatus::incomplete;
}

}  // namespace

Action declare_detail(CLI::App& app) {
    struct Arguments : DetailArguments {
        OutputArguments output;
    };
    const auto arguments = std::make_shared<Arguments>();
    app.add_option("SCENE", arguments->scenes, "Scenes with settled states of full detail (default: baseline low overdrive)");
    app.add_option("--set", arguments->settings, "Change a key of the scenes")->type_name("KEY=VALUE");
    app.add_option("--method", arguments->method, "Method of integration")->type_name("NAME")->capture_default_str();
    app.add_option("--step", arguments->step, "Step, or \"auto\"")->type_name("TIME")->capture_default_str();
    app.add_option("--settle", arguments->settle, "Settling time of each variant, in which strands and shafts adapt to its detail")
        ->type_name("TIME")
        ->capture_default_str();
    app.add_option("--average", arguments->average, "Time that averages cover; slip and efficiency require 16 pin periods")
        ->type_name("TIME")
        ->capture_default_str();
    app.add_option("--control", arguments->control, "Time that ratio control has to find the thrust ratio (\"0 s\": no search)")
        ->type_name("TIME")
        ->capture_default_str();
    CLI::Option* all =
        app.add_flag("--all", arguments->all, "Every combination of detail with pin halves (48) instead of one change at a time");
    app.add_flag("--levels", arguments->levels,
                 "The levels of cvtflow list detail, each at its automatic step; reference: the finest level at a quarter of its step.\n"
                 "Without SCENE at seven operating points: three ratios, three loads, a shift, a ramp of the load")
        ->excludes(all);
    declare_output(app, arguments->output);
    app.footer(
        "Each variant starts from the scene's settled state at full detail, converted to its coordinates.\n"
        "Unreliable variants (energy balance) have a status and no figures.\n"
        "Exit status 1: full detail fails or is unreliable; 5: other variants do (stderr states the reason).");
    return [arguments] {
        if (arguments->levels) return report_ladder(*arguments, arguments->output);
        if (arguments->scenes.empty()) arguments->scenes = {"baseline", "low", "overdrive"};
        return report_details(*arguments, arguments->output);
    };
}

}  // namespace cvtflow::bench
