#include "tools/detail_report.hpp"

#include <fmt/format.h>

#include "tools/interrupt.hpp"
#include "tools/text.hpp"

namespace cvtflow::tools {

namespace {

Table empty_table() {
    const auto right = [](const char* heading) { return Table::Column{heading, Align::right}; };
    return Table({{"detail"}, right("coordinates"), right("cost us"), right("tight %"), right("slack %"), right("tip force %"), right("slip %"), right("efficiency %-pt"),
                  right("thrust ratio %"), right("shift %/s"), right("drift %")});
}

std::string relative(double value, double exact) { return exact == 0.0 ? "-" : fmt::format("{:+.2f}", 100.0 * (value / exact - 1.0)); }

void add_row(Table& table, const DetailOutcome& o, const DetailOutcome& reference) {
    if (!o.fault.empty()) {
        table.add({o.variant.name(), std::to_string(o.coordinates), "-", o.fault});
        return;
    }
    table.add({o.variant.name(), std::to_string(o.coordinates), fmt::format("{:.2f}", 1e6 * o.cost), relative(o.tight, reference.tight), relative(o.slack, reference.slack),
               relative(o.tip, reference.tip), relative(o.slip, reference.slip), fmt::format("{:+.3f}", 100.0 * (o.efficiency - reference.efficiency)),
               relative(o.thrust, reference.thrust), fmt::format("{:+.2f}", 100.0 * (o.shift - reference.shift)), fmt::format("{:+.2f}", 100.0 * o.drift)});
}

std::string csv_of(const std::vector<DetailOutcome>& outcomes) {
    std::string text = "order,plates,joint_points,pulleys,coordinates,cost_s,tight_N,slack_N,tip_axial_N,slip,efficiency,ratio,shift_per_s,thrust_ratio,drift\n";
    for (const DetailOutcome& o : outcomes) {
        if (!o.fault.empty()) continue;
        text += fmt::format("{},{},{},{},{},{:.4g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.4g},{:.6g},{:.3g}\n", o.variant.order,
                            o.variant.plates == model::PlateDetail::each ? "each" : "lumped", o.variant.joint_points,
                            o.variant.pulleys == model::PulleyDetail::elastic ? "elastic" : "rigid", o.coordinates, o.cost, o.tight, o.slack, o.tip, o.slip, o.efficiency,
                            o.ratio, o.shift, o.thrust, o.drift);
    }
    return text;
}

std::vector<DetailOutcome> measure_all(const DetailArguments& arguments, const std::string& scene) {
    const DetailMeasure measure(arguments, scene);
    std::vector<DetailOutcome> outcomes;
    for (const DetailVariant& variant : detail_variants(arguments.all)) {
        outcomes.push_back(measure.measure(variant, outcomes.empty() ? 0.0 : outcomes.front().ratio));
        if (catch_interrupts().requested()) break;
    }
    return outcomes;
}

void print(const std::string& scene, const std::vector<DetailOutcome>& outcomes) {
    const DetailOutcome& exact = outcomes.front();
    fmt::print("{}: full detail has tight {:.1f} N, slack {:.1f} N, largest tip force {:.1f} N, slip {:.4f} %, efficiency {:.3f} %, ratio {:.4f}, thrust ratio {:.4f}\n", scene,
               exact.tight, exact.slack, exact.tip, 100.0 * exact.slip, 100.0 * exact.efficiency, exact.ratio, exact.thrust);
    Table table = empty_table();
    for (const DetailOutcome& outcome : outcomes) add_row(table, outcome, exact);
    fmt::print("{}\n", table.text(2));
}

}  // namespace

ExitStatus report_details(const DetailArguments& arguments, const OutputArguments& output) {
    OutputFolder folder(output);
    for (const std::string& scene : arguments.scenes) {
        const std::vector<DetailOutcome> outcomes = measure_all(arguments, scene);
        if (catch_interrupts().requested()) return ExitStatus::cancelled;
        print(scene, outcomes);
        folder.write("detail_" + scene.substr(scene.find_last_of('/') + 1) + ".csv", csv_of(outcomes));
    }
    fmt::print("Columns: difference from full detail; cost: one right-hand side, best of 200; thrust ratio: S_1/S_2 with which ratio control holds the ratio of full detail;\n"
               "shift: how much faster the speed ratio changes at the scene's clamping; drift: change of the tight strand's tension between both halves of the averaging,\n"
               "which is what settling {} left over.\n{}", arguments.settle, folder.written());
    return ExitStatus::finished;
}

}  // namespace cvtflow::tools
