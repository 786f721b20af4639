/// What each dial of detail costs and what it changes: the same operating point at many levels of detail, compared with full detail.
///
/// Every variant starts from the scene's settled state at full detail, brought over to its own coordinates, goes on for a short settling time
/// of its own and is then averaged. What a variant would still drift by after that is printed with it: differences below are not the detail's.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <span>

#include "engine/record/state_file.hpp"
#include "model/observation.hpp"
#include "tasks/simulation.hpp"
#include "tools/command.hpp"
#include "tools/detail_state.hpp"
#include "tools/interrupt.hpp"
#include "tools/scene_arguments.hpp"
#include "tools/text.hpp"

namespace cvtflow::tools {

namespace {

struct DetailArguments {
    std::vector<std::string> scenes{"baseline", "low", "overdrive"};
    std::vector<std::string> settings;
    std::string method = "dumka3-p5", step = "2 us", settle = "3 ms", average = "3 ms";
    bool all = false;
};

/// Means over the outputs of one part of a run.
struct Means final : tasks::RunObserver {
    explicit Means(const model::Variator& variator) : observer(variator) {}
    void output(double time, const tasks::Workspace& w, const tasks::Counters&) override {
        const model::Observation& now = observer.observe(time, w.states[0], w.phases.data());
        double tip = 0.0;
        for (const double axial : now.tip_axial) tip = std::max(tip, std::abs(axial));
        const double in = now.chain_torque[0] * now.speed[0], out = now.chain_torque[1] * now.speed[1];
        const std::array values{now.tight, now.slack, tip, now.slip, std::abs(in), std::abs(out)};
        for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += values[k];
        if (count == 0) first_ratio = now.ratio;
        last_ratio = now.ratio;
        if (count == 0) first_time = time;
        last_time = time;
        ++count;
    }
    void transition(const tasks::TransitionRecord&) override {}
    [[nodiscard]] double mean(std::size_t k) const { return sum[k] / static_cast<double>(count); }

    model::Observer observer;
    std::array<double, 6> sum{};   ///< tight, slack, tip, slip, power in, power out
    double first_ratio = 0.0, last_ratio = 0.0, first_time = 0.0, last_time = 0.0;
    long count = 0;
};

/// One row of the table.
struct Outcome {
    std::string variant;
    int coordinates = 0;
    double cost = 0.0;                  ///< of one right-hand side [s]
    double tight = 0.0, slack = 0.0;    ///< [N]
    double tip = 0.0;                   ///< largest axial force of a tip, mean over time [N]
    double slip = 0.0, efficiency = 0.0;
    double shift = 0.0;                 ///< relative rate of the ratio [1/s]: which way the thrust ratio is off
    double drift = 0.0;                 ///< difference of the tight strand's tension between both halves of the averaging
    std::string fault;
};

/// A combination of the four dials.
struct Variant {
    int order;
    model::PlateDetail plates;
    int joint_points;
    model::PulleyDetail pulleys;
    [[nodiscard]] std::string name() const {
        return fmt::format("p={} {:6} {} pt {}", order, plates == model::PlateDetail::each ? "each" : "lumped", joint_points,
                           pulleys == model::PulleyDetail::elastic ? "elastic" : "rigid");
    }
};

constexpr Variant full{3, model::PlateDetail::each, 8, model::PulleyDetail::elastic};

/// One dial at a time, then all down; or every combination.
std::vector<Variant> variants(bool all) {
    using enum model::PlateDetail;
    using enum model::PulleyDetail;
    if (!all) {
        return {full, {2, each, 8, elastic}, {1, each, 8, elastic}, {0, each, 8, elastic}, {3, lumped, 8, elastic}, {3, each, 3, elastic}, {3, each, 1, elastic},
                {3, each, 8, rigid}, {1, lumped, 3, elastic}, {1, lumped, 1, rigid}, {0, lumped, 1, rigid}};
    }
    std::vector<Variant> list{full};
    for (int order = 3; order >= 0; --order) {
        for (const auto plates : {each, lumped}) {
            for (const int points : {8, 3, 1}) {
                for (const auto pulleys : {elastic, rigid}) {
                    if (list.size() > 1 || order != 3 || plates != each || points != 8 || pulleys != elastic) list.push_back({order, plates, points, pulleys});
                }
            }
        }
    }
    return list;
}

/// Best of several: the machine may be busy.
double cost_of(const tasks::Simulation& simulation) {
    model::EvaluationScratch scratch(simulation.variator().layout());
    std::vector<double> slope(static_cast<std::size_t>(simulation.variator().layout().size()));
    double best = 1.0;
    for (int repetition = 0; repetition < 200; ++repetition) {
        const auto begin = std::chrono::steady_clock::now();
        for (int k = 0; k < 5; ++k) model::right_hand_side(simulation.variator(), 0.0, simulation.state(), simulation.phases().data(), slope.data(), scratch);
        best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() / 5.0);
    }
    return best;
}

tasks::Scene scene_of(const DetailArguments& arguments, const std::string& name, const Variant& v, const std::string& until) {
    SceneArguments scene;
    scene.scene = name;
    scene.settings = {fmt::format("detail.order={}", v.order), v.plates == model::PlateDetail::each ? "detail.plates=each" : "detail.plates=lumped",
                      fmt::format("detail.joint_points={}", v.joint_points), v.pulleys == model::PulleyDetail::elastic ? "detail.pulleys=elastic" : "detail.pulleys=rigid",
                      "run.method=" + arguments.method, "run.step=" + arguments.step, "run.until=" + until, "run.threads=1", "run.schedule=serial"};
    scene.settings.insert(scene.settings.end(), arguments.settings.begin(), arguments.settings.end());
    return load_scene(scene).scene;
}

/// Averages over both halves of the time after settling.
void average(tasks::Simulation& simulation, double settle, double until, Outcome& outcome) {
    tasks::SilentObserver silent;
    const double middle = 0.5 * (settle + until);
    tasks::Fault fault = simulation.run(settle, silent, catch_interrupts());
    Means first(simulation.variator()), second(simulation.variator());
    if (!fault) fault = simulation.run(middle, first, catch_interrupts());
    if (!fault) fault = simulation.run(until, second, catch_interrupts());
    if (fault) {
        outcome.fault = fault.message();
        return;
    }
    const auto both = [&](std::size_t k) { return 0.5 * (first.mean(k) + second.mean(k)); };
    outcome.tight = both(0), outcome.slack = both(1), outcome.tip = both(2), outcome.slip = both(3);
    outcome.efficiency = both(5) / both(4);
    outcome.shift = (second.last_ratio / first.first_ratio - 1.0) / (second.last_time - first.first_time);
    outcome.drift = second.mean(0) / first.mean(0) - 1.0;
    outcome.cost = cost_of(simulation);
}

Outcome measure(const DetailArguments& arguments, const std::string& name, const Variant& variant, const engine::SavedState& settled) {
    Outcome outcome;
    outcome.variant = variant.name();
    tasks::Scene scene = scene_of(arguments, name, variant, arguments.settle);
    const double settle = scene.run.until, until = settle + scene_of(arguments, name, variant, arguments.average).run.until;
    const StateFile start(brought_over(settled, scene_of(arguments, name, full, arguments.settle).parameters, scene.parameters));
    scene.state_file = start.path();
    tasks::Simulation simulation(scene);
    outcome.coordinates = simulation.variator().layout().coordinates();
    average(simulation, settle, until, outcome);
    return outcome;
}

Table empty_table() {
    return Table({{"detail", Align::left}, {"coordinates", Align::right}, {"cost us", Align::right}, {"tight %", Align::right}, {"slack %", Align::right},
                  {"tip force %", Align::right}, {"slip %", Align::right}, {"efficiency %-pt", Align::right}, {"ratio %/s", Align::right}, {"drift %", Align::right}});
}

void add_row(Table& table, const Outcome& o, const Outcome& reference) {
    if (!o.fault.empty()) {
        table.add({o.variant, std::to_string(o.coordinates), "-", o.fault});
        return;
    }
    const auto relative = [](double value, double exact) { return fmt::format("{:+.2f}", 100.0 * (value / exact - 1.0)); };
    table.add({o.variant, std::to_string(o.coordinates), fmt::format("{:.2f}", 1e6 * o.cost), relative(o.tight, reference.tight), relative(o.slack, reference.slack),
               relative(o.tip, reference.tip), relative(o.slip, reference.slip), fmt::format("{:+.3f}", 100.0 * (o.efficiency - reference.efficiency)),
               fmt::format("{:+.2f}", 100.0 * (o.shift - reference.shift)), fmt::format("{:+.2f}", 100.0 * o.drift)});
}

void compare(const DetailArguments& arguments, const std::string& name) {
    const tasks::Scene reference = scene_of(arguments, name, full, arguments.settle);
    if (reference.state_file.empty()) throw tasks::SceneError(fmt::format("{}: has no settled state of full detail to start from (start.state)", name));
    const engine::SavedState settled = engine::read_state(reference.state_file);
    Table table = empty_table();
    Outcome exact;
    for (const Variant& variant : variants(arguments.all)) {
        const Outcome outcome = measure(arguments, name, variant, settled);
        if (exact.coordinates == 0) {
            exact = outcome;
            fmt::print("{}: full detail has tight {:.1f} N, slack {:.1f} N, largest tip force {:.1f} N, slip {:.4f} %, efficiency {:.3f} %, ratio {:+.2f} %/s\n", name,
                       exact.tight, exact.slack, exact.tip, 100.0 * exact.slip, 100.0 * exact.efficiency, 100.0 * exact.shift);
        }
        add_row(table, outcome, exact);
    }
    fmt::print("{}\n", table.text(2));
}

ExitStatus detail(const DetailArguments& arguments) {
    for (const std::string& scene : arguments.scenes) compare(arguments, scene);
    fmt::print("Columns: difference from full detail; cost: one right-hand side, best of 200; ratio: how much faster the speed ratio shifts at the same clamping;\n"
               "drift: change of the tight strand's tension between both halves of the averaging, which is what settling {} left over.\n", arguments.settle);
    return ExitStatus::finished;
}

}  // namespace

Action declare_detail(CLI::App& app) {
    const auto arguments = std::make_shared<DetailArguments>();
    app.add_option("SCENE", arguments->scenes, "Scenes with settled states of full detail (default: baseline low overdrive)");
    app.add_option("--set", arguments->settings, "Change a key of the scenes")->type_name("KEY=VALUE");
    app.add_option("--method", arguments->method, "Method of integration")->type_name("NAME")->capture_default_str();
    app.add_option("--step", arguments->step, "Its step")->type_name("TIME")->capture_default_str();
    app.add_option("--settle", arguments->settle, "How long each variant settles")->type_name("TIME")->capture_default_str();
    app.add_option("--average", arguments->average, "How long it is averaged")->type_name("TIME")->capture_default_str();
    app.add_flag("--all", arguments->all, "Every combination of the dials (48) instead of one dial at a time");
    app.footer("Each variant starts from the scene's settled state at full detail, brought over to its own coordinates.");
    return [arguments] { return detail(*arguments); };
}

}  // namespace cvtflow::tools
