#include "bench/lab/report/detail_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/lab/text/watch_text.hpp"
#include "tasks/method/method.hpp"
#include "tasks/scene/csv.hpp"
#include "tools/program/guard.hpp"
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
    return fmt::format("{},{},{},{},{},{:g}", pins_of(o), o.variant.order, o.variant.plates == model::PlateDetail::each ? "each" : "lumped",
                       o.variant.joint_points, o.variant.pulleys == model::PulleyDetail::elastic ? "elastic" : "rigid",
                       o.variant.mass_scaling);
}

std::string csv_of(const std::vector<DetailOutcome>& outcomes) {
    std::string text =
        "pins,order,plates,joint_points,pulleys,mass_scaling,coordinates,cost_s,tight_N,slack_N,pin_axial_N,slip,ratio,shift_per_s,thrust_"
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
                               {"order", o.variant.order},
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

}  // namespace

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

}  // namespace cvtflow::bench
