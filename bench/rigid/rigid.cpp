/// Rigid pins beside the program's levels of detail: operating points, their cost, the step's error, the longest stable step.
///
///     bench_rigid SCENE [KEY=VALUE ...] [OPTION=VALUE ...]
///
/// SCENE and KEY=VALUE are those of `cvtflow run SCENE --set KEY=VALUE`. The machine starts geometrically and settles, as the states of
/// scenes are those of other levels; it runs to `until` and is averaged over the last `mean`. CSV on the standard output, one row per run.
///
///     detail=rigid      a level of detail of `cvtflow list detail`, or several separated by commas, in turns
///     step=auto         or microseconds; several separated by commas make several rows
///     until=100         [ms]
///     mean=20           [ms]
///     mode=points       points: a row of means.  parts: microseconds per step by part.  stable: the longest stable step
///
///     us_per_step       processor time; s_per_s: of a simulated second, with unused outputs every 20 us
///     s_per_s_observed  the same with an observation at each output, of the time that is averaged
///     tight, slack      mean tensions of the strands [N]; slip, efficiency [%]
///     thrust_ratio      S_1/S_2, which under ratio control is what holds the ratio
///     residual          energy balance: change - work + loss, over the losses
///     loss_*            mean powers [W] by kind

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <map>
#include <memory>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "model/observe/observation.hpp"
#include "model/start/start_state.hpp"
#include "tasks/channel/channels.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/scene/ready_scenes.hpp"

namespace {

using namespace cvtflow;

constexpr double output_interval = 20e-6;  // s

struct Options {
    std::map<std::string, std::string> text{{"detail", "rigid"}, {"step", "auto"}, {"until", "100"}, {"mean", "20"}, {"mode", "points"}};
    std::string scene;
    std::vector<std::string> settings;

    [[nodiscard]] double milliseconds(const std::string& name) const { return 1e-3 * std::stod(text.at(name)); }
    [[nodiscard]] std::vector<std::string> listed(const std::string& name) const {
        std::vector<std::string> all;
        std::stringstream list(text.at(name));
        for (std::string one; std::getline(list, one, ',');) all.push_back(one);
        return all;
    }
};

[[nodiscard]] Options read_options(int count, char** words) {
    Options options;
    if (count < 2) throw std::invalid_argument("bench_rigid SCENE [KEY=VALUE ...]: see the head of bench/rigid/rigid.cpp");
    options.scene = words[1];
    for (int k = 2; k < count; ++k) {
        const std::string word = words[k], name = word.substr(0, word.find('='));
        if (options.text.contains(name)) {
            options.text[name] = word.substr(word.find('=') + 1);
        } else {
            options.settings.push_back(word);
        }
    }
    return options;
}

[[nodiscard]] double processor_time() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Means of outputs, and losses and work meanwhile.
struct Means {
    double tight = 0.0, slack = 0.0, slip = 0.0, ratio = 0.0, thrust_ratio = 0.0, largest_normal = 0.0;
    std::array<double, 2> radius{};
    long outputs = 0;
    std::array<double, model::loss_kinds> lost{};
    std::array<double, model::work_kinds> worked{};
    double span = 0.0, residual = 0.0, processor = 0.0, observing = 0.0, simulated = 0.0, step = 0.0;
    long steps = 0;

    void add(double tight_now, double slack_now, double slip_now, double ratio_now, double thrust, std::array<double, 2> radii) {
        tight += tight_now;
        slack += slack_now;
        slip += slip_now;
        ratio += ratio_now;
        thrust_ratio += thrust;
        for (std::size_t k = 0; k < 2; ++k) radius[k] += radii[k];
        ++outputs;
    }
    [[nodiscard]] double losses() const { return std::accumulate(lost.begin(), lost.end(), 0.0); }
    [[nodiscard]] double efficiency() const {
        double input = 0.0;
        for (const double work : worked) input += std::max(work, 0.0);
        return 1.0 - losses() / input;
    }
};

void print_head() {
    fmt::print(
        "scene,detail,step_us,us_per_step,s_per_s,s_per_s_observed,tight,slack,slip_percent,ratio,thrust_ratio,radius_1_mm,radius_2_mm,"
        "efficiency_percent,loss_W,residual");
    for (int kind = 0; kind < model::loss_kinds; ++kind) fmt::print(",loss_{}", tasks::loss_name(kind));
    fmt::print("\n");
}

void print_row(const Options& options, const std::string& detail, const Means& m) {
    const auto n = static_cast<double>(m.outputs);
    std::string scene = options.scene;
    for (const std::string& setting : options.settings) scene += " " + setting;
    fmt::print("{},{},{:.3f},{:.3f},{:.3f},{:.3f},{:.1f},{:.1f},{:.4f},{:.5f},{:.4f},{:.4f},{:.4f},{:.3f},{:.1f},{:.2e}", scene, detail,
               1e6 * m.step, 1e6 * m.processor / static_cast<double>(m.steps), m.processor / m.simulated, m.observing / m.span, m.tight / n,
               m.slack / n, 100.0 * m.slip / n, m.ratio / n, m.thrust_ratio / n, 1e3 * m.radius[0] / n, 1e3 * m.radius[1] / n,
               100.0 * m.efficiency(), m.losses() / m.span, m.residual / m.losses());
    for (const double loss : m.lost) fmt::print(",{:.2f}", loss / m.span);
    fmt::print("\n");
    std::fflush(stdout);
}

/// The program's engine at a level of detail.
[[nodiscard]] Means means_of_level(const Options& options, tasks::Scene scene, const std::string& step) {
    tasks::set_values(scene, std::vector<std::string>{"run.step=" + (step == "auto" ? step : step + " us"), "run.schedule=serial",
                                                      "run.output_interval=20 us"});
    tasks::Simulation simulation(scene, tasks::Schedule{});
    tasks::SilentObserver silent;
    const engine::Cancellation never;
    const auto advance = [&](double until) {
        if (const tasks::Fault fault = simulation.advance({.until = until}, silent, never)) throw tasks::SimulationError(fault.message());
    };
    if (simulation.needs_settling()) advance(0.0);
    model::Observer observer(simulation.workspace().variator);
    const double until = options.milliseconds("until"), from = until - options.milliseconds("mean");
    const double clock = processor_time(), begin = simulation.time();
    advance(from);
    Means m;
    m.processor = processor_time() - clock;
    const double observing = processor_time();
    const tasks::EnergySums before = simulation.workspace().energy.sums(simulation.time());
    while (simulation.time() < until) {
        advance(simulation.time() + output_interval);
        const model::Observation& o = simulation.workspace().observed_by(observer, simulation.time());
        m.add(o.tight, o.slack, o.slip, o.ratio, o.clamping[0] / o.clamping[1], o.radius);
    }
    m.observing = processor_time() - observing;
    const tasks::EnergySums after = simulation.workspace().energy.sums(simulation.time());
    m.step = simulation.step();
    m.simulated = from - begin;
    m.steps = std::lround(m.simulated / m.step);
    m.span = after.time - before.time;
    m.residual = simulation.workspace().energy.balance().residual();
    for (std::size_t k = 0; k < m.lost.size(); ++k) m.lost[k] = after.loss[k] - before.loss[k];
    for (std::size_t k = 0; k < m.worked.size(); ++k) m.worked[k] = after.work[k] - before.work[k];
    return m;
}

/// Prints a part's microseconds of processor time per call, median of rounds.
template <class Act>
void time_part(const char* name, const Act& act) {
    constexpr int calls = 2000, rounds = 9;
    std::vector<double> all;
    for (int round = 0; round < rounds; ++round) {
        const double clock = processor_time();
        for (int call = 0; call < calls; ++call) act();
        all.push_back(1e6 * (processor_time() - clock) / calls);
    }
    std::nth_element(all.begin(), all.begin() + rounds / 2, all.end());
    fmt::print("{},{:.3f}\n", name, all[rounds / 2]);
}

/// A machine with rigid pins, by steps of one length.
class Machine {
public:
    Machine(tasks::Scene scene, double step) : step_(step), simulation_(at_step(std::move(scene), step), tasks::Schedule{}) {}

    /// False if the run has failed. @param until [s]
    [[nodiscard]] bool run(double until) { return !simulation_.advance({.until = until}, silent_, never_) && std::isfinite(lost()); }
    void take_step() { static_cast<void>(run(simulation_.time() + step_)); }
    [[nodiscard]] double time() const { return simulation_.time(); }
    [[nodiscard]] double lost() const { return simulation_.workspace().energy.sums(simulation_.time()).lost(); }
    [[nodiscard]] const tasks::Workspace& workspace() const { return simulation_.workspace(); }

private:
    [[nodiscard]] static tasks::Scene at_step(tasks::Scene scene, double step) {
        tasks::set_values(scene, std::vector<std::string>{fmt::format("run.step={:.4g} us", 1e6 * step), "run.output_interval=20 us"});
        return scene;
    }

    double step_;  ///< [s]
    tasks::Simulation simulation_;
    tasks::SilentObserver silent_;
    const engine::Cancellation never_;
};

/// Each kernel by itself, on the columns of a running machine.
void print_parts(const tasks::Scene& scene) {
    constexpr double step = 5e-6;
    Machine machine(scene, step);
    (void)machine.run(0.0);
    const model::RigidState& pins = *machine.workspace().rigid_pins();
    const model::RigidModel& model = pins.model;
    const model::PulleyModel& pulleys = machine.workspace().variator.pulleys();
    model::RigidColumns columns = pins.columns;
    const model::RigidKernels& k = model.kernels();
    const model::RigidCoefficients& c = model.coefficients();
    const model::RigidKick kick{step};
    const double* tail = pins.tail.data();
    model::SheaveMotion sheaves[4];
    pulleys.motions(tail, sheaves);
    model::RigidForces forces = pins.forces;
    model::Inputs inputs;
    std::vector<double> slope(static_cast<std::size_t>(2 * model.layout().pulley_size));
    fmt::print("part,us\n");
    time_part("pitch_lines", [&] { k.pitch_lines(columns); });
    time_part("rolling_frames", [&] { k.rolling_frames(c, columns); });
    time_part("link_forces", [&] { k.link_forces(c, kick, columns, forces.account); });
    time_part("joint_forces", [&] { k.joint_forces(c, kick, columns, forces.account); });
    time_part("sum_link_forces", [&] { k.sum_link_forces(columns); });
    time_part("plate_friction", [&] { k.plate_friction(c, kick, columns, forces.account); });
    time_part("tips", [&] { k.tips(c, sheaves, kick, columns, forces.reaction, forces.account); });
    time_part("moments", [&] { k.moments(columns); });
    time_part("accelerate", [&] { k.accelerate(c, columns); });
    time_part("inputs", [&] { inputs = pulleys.inputs().at(0.0, tail); });
    time_part("pulleys", [&] { pulleys.slope(tail, inputs, forces.reaction.sheaves, slope.data(), &forces.account); });
    time_part("wrap", [&] { columns.wrap({columns.position.middle.x, columns.plate.tension}); });
    time_part("run of one step", [&] { machine.take_step(); });
}

/// Whether 20 ms behind the start's ramp end sound, with losses as at half the step.
[[nodiscard]] bool stable(const tasks::Scene& scene, double step) {
    double losses[2] = {};
    for (int k = 0; k < 2; ++k) {
        Machine machine(scene, k == 0 ? 0.5 * step : step);
        if (!machine.run(0.0) || !machine.run(20e-3)) return false;
        const double before = machine.lost();
        if (!machine.run(30e-3)) return false;
        losses[k] = machine.lost() - before;
    }
    return std::abs(losses[1] / losses[0] - 1.0) < 0.1;
}

void print_stable(const tasks::Scene& scene) {
    double low = 1e-6, high = 20e-6;
    while (high - low > 0.05e-6) {
        const double middle = 0.5 * (low + high);
        (stable(scene, middle) ? low : high) = middle;
    }
    fmt::print("longest stable step,{:.2f} us\n", 1e6 * low);
}

void run(const Options& options) {
    tasks::Scene scene = tasks::read_scene(tasks::find_scene(options.scene), tasks::StartState::ignored);
    tasks::set_values(scene, options.settings);
    const std::string& mode = options.text.at("mode");
    if (mode != "points") {
        tasks::apply_detail(scene, "rigid");
        return mode == "parts" ? print_parts(scene) : print_stable(scene);
    }
    print_head();
    for (const std::string& step : options.listed("step")) {
        for (const std::string& detail : options.listed("detail")) {
            tasks::Scene at_level = scene;
            tasks::apply_detail(at_level, detail);
            print_row(options, detail, means_of_level(options, std::move(at_level), step));
        }
    }
}

}  // namespace

int main(int count, char** words) {
    try {
        run(read_options(count, words));
    } catch (const std::exception& error) {
        fmt::print(stderr, "bench_rigid: {}\n", error.what());
        return 1;
    }
}
