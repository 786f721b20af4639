#include "bench/study/extremes/lottery.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>

#include "engine/executor/tbb/job_pool.hpp"
#include "engine/record/run/state_file.hpp"
#include "model/machine/belt.hpp"
#include "tasks/run/run_means.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/ready_scenes.hpp"

namespace cvtflow::bench {

using namespace tasks;

namespace {

/// Numbers in [0, 1), the same everywhere.
class Urn {
public:
    Urn(std::uint64_t seed, long number) : random_(seed * 1000003u + static_cast<std::uint64_t>(number)) { random_.discard(8); }
    double draw() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
    double draw(double from, double to) { return from + (to - from) * draw(); }
    template <class List>
    const auto& one_of(const List& list) {
        return list[static_cast<std::size_t>(draw() * static_cast<double>(std::size(list)))];
    }

private:
    std::mt19937_64 random_;
};

/// Lengths and angles of a chain and its sheaves fit together: half of one of them alone is no machine.
[[nodiscard]] bool drawn(const Parameter& parameter) {
    constexpr std::string_view sections[] = {"chain", "half", "plate", "joint", "tip", "pulley"};
    const bool physical = std::find(std::begin(sections), std::end(sections), parameter.section()) != std::end(sections);
    constexpr std::string_view laws[] = {"tip.limiting_traction", "tip.pressure_sensitivity", "tip.reference_pressure"};  // draw_extras
    const bool of_a_law = std::find(std::begin(laws), std::end(laws), parameter.key) != std::end(laws);
    return physical && !of_a_law && parameter.kind() == Kind::number && parameter.unit != "m" && parameter.unit != "rad";
}

struct OperatingPoint {
    double ratio, thrust_ratio;  ///< S_1/S_2 that holds it at three quarters of the load
};
constexpr OperatingPoint points[] = {{2.4, 1.18}, {1.0, 1.355}, {0.417, 1.55}};

/// Torque at which friction lets the driven side slip: 2 mu S_2 r_2/cos(beta) [N m].
[[nodiscard]] double carried_torque(const model::Parameters& p, double ratio, double clamping) {
    const auto radii = model::belt_radii(model::chain_length(p.chain), ratio, p.pulley.centre_distance);
    return radii ? 2.0 * p.tip.largest_friction() * clamping * radii->driven / std::cos(p.tip.angle) : 0.0;
}

/// Draws a physical parameter within a factor of 2 of its value.
void draw_parameter(const Parameter& parameter, Urn& urn, Scene& scene, std::vector<std::string>& settings) {
    const Slot slot = parameter.member(scene);
    double& value = **std::get_if<double*>(&slot);
    value = std::clamp(value * std::exp2(urn.draw(-1.0, 1.0)), parameter.min, parameter.max);
    settings.push_back(fmt::format("{}={:.6g}", parameter.key, value));
}

/// Rigid pins take none of the methods and laws drawn beside it. "fine" also has the tickets of levels that are gone: others keep theirs.
constexpr std::string_view levels_drawn[] = {"fine", "fine", "fine", "full"};

/// Any detail, all physical parameters, any operating point.
LotteryMachine machine_of_defaults(Urn& urn, Scene& scene) {
    LotteryMachine machine;
    std::vector<std::string>& settings = machine.settings;
    apply_detail(scene, urn.one_of(levels_drawn));
    for (const std::string_view key : dial_keys()) settings.push_back(fmt::format("{}={}", key, value_text(*find_parameter(key), scene)));
    settings.push_back(urn.draw() < 0.5 ? "detail.friction=piecewise" : "detail.friction=smoothed");
    settings.push_back(urn.draw() < 0.5 ? "joint.law=linear" : "joint.law=palmgren");
    for (const Parameter& parameter : parameter_table()) {
        if (drawn(parameter)) draw_parameter(parameter, urn, scene, settings);
    }
    const OperatingPoint& point = urn.one_of(points);
    const double driven = 5e3 * std::pow(80.0 / 5.0, urn.draw());
    settings.push_back(fmt::format("start.ratio={}", point.ratio));
    settings.push_back(fmt::format("clamping.driven={:.6g}", driven));
    settings.push_back(fmt::format("clamping.driving={:.6g}", std::min(80e3, point.thrust_ratio * driven)));
    settings.push_back(fmt::format("drive.speed={:.6g} rpm", urn.draw(500.0, 6000.0)));
    const double load = urn.draw(0.0, 0.9) * carried_torque(scene.parameters, point.ratio, driven);
    settings.push_back(fmt::format("load.torque={:.6g}", load));
    scene.parameters.load.torque = model::TimeTable(load);
    return machine;
}

constexpr std::string_view ready_scenes_drawn[] = {"baseline", "low", "overdrive"};

/// A ready scene with its state, and a variation of it.
LotteryMachine machine_of_ready_scene(Urn& urn, Scene& scene) {
    LotteryMachine machine{std::string(urn.one_of(ready_scenes_drawn)), {}};
    scene = read_scene(find_scene(machine.scene));
    for (const Parameter& parameter : parameter_table()) {
        if (drawn(parameter) && urn.draw() < 0.04) draw_parameter(parameter, urn, scene, machine.settings);
    }
    const double load = urn.draw(0.3, 1.1) * scene.parameters.load.torque.at(0.0);
    machine.settings.push_back(fmt::format("load.torque={:.6g}", load));
    scene.parameters.load.torque = model::TimeTable(load);
    return machine;
}

/// Draws another chain: a state that was settled before does not fit it.
void draw_chain(Urn& urn, const Scene& scene, std::vector<std::string>& settings) {
    const model::Parameters& p = scene.parameters;
    const double pitch = p.chain.pitch.front();
    const double mixed = urn.draw(), mean = pitch * urn.draw(0.99, 1.02), spread = urn.draw(0.0, 0.08);
    if (mixed < 0.25)
        settings.push_back(fmt::format("chain.pitch=[{:.6g},{:.6g},{:.6g}]", mean, mean * (1.0 + spread), mean * (1.0 - spread)));
    else if (mixed < 0.35)
        settings.push_back(fmt::format("chain.pitch={:.6g}", mean));
    const double width = urn.draw(0.8, 1.2), radius = urn.draw(0.6, 1.6), plates = urn.draw(6.0, 20.0);
    if (urn.draw() < 0.15) settings.push_back(fmt::format("half.width={:.6g}", p.half.width * width));
    if (urn.draw() < 0.15) settings.push_back(fmt::format("joint.radius={:.6g}", p.joint.radius * radius));
    if (urn.draw() < 0.15) settings.push_back(fmt::format("plate.count={}", std::floor(plates)));
}

/// Draws no load, a load that drives, or one that jumps within a microsecond in the middle of the run.
void draw_load(Urn& urn, const Scene& scene, double duration, std::vector<std::string>& settings) {
    const double load = scene.parameters.load.torque.at(0.0), kind = urn.draw(), when = urn.draw(0.2, 0.8) * duration;
    const double other = urn.draw(-1.0, 1.0) * load;
    if (kind < 0.1)
        settings.emplace_back("load.torque=0");
    else if (kind < 0.2)
        settings.push_back(fmt::format("load.torque={:.6g}", -load));
    else if (kind < 0.4)
        settings.push_back(fmt::format("load.torque=[[0,{0:.6g}],[{1:.9g},{0:.6g}],[{2:.9g},{3:.6g}]]", load, when, when + 1e-6, other));
}

/// Cylinders and a pump for every other machine, drawn last: machines are those of before but for that.
void draw_hydraulics(Urn& urn, std::vector<std::string>& settings) {
    if (urn.draw() < 0.5) return;
    settings.emplace_back("hydraulics.mode=force");
    Scene scene;
    for (const Parameter& parameter : parameter_table()) {
        const bool drawn = parameter.section() == "hydraulics" && parameter.kind() == Kind::number && parameter.unit != "m" &&
                           !parameter.name().starts_with("pump_");
        if (drawn) draw_parameter(parameter, urn, scene, settings);
    }
    settings.push_back(fmt::format("hydraulics.pump_displacement={:.6g}", urn.draw(6e-6, 25e-6)));
    settings.push_back(fmt::format("hydraulics.driven_spring={:.6g}", urn.draw(0.0, 2e3)));
}

/// Laws of tips, temperatures and imperfections, from a separate urn, so that other machines do not change.
void draw_extras(Urn urn, const Scene& scene, LotteryMachine& machine) {
    std::vector<std::string>& settings = machine.settings;
    const double law = urn.draw(), coefficient = scene.parameters.tip.friction.coefficient, fall = urn.draw(0.5, 1.0);
    const double sensitivity = urn.draw(-0.3, 0.3), warm = urn.draw(), off = urn.draw(), runout = urn.draw(0.0, 20.0);
    if (law < 0.15) {
        settings.emplace_back("tip.friction_law=table");
        settings.push_back(fmt::format("tip.friction_coefficient={:.6g}", coefficient));
        settings.push_back(fmt::format("tip.friction_table=[[0.02,{:.6g}],[0.5,{:.6g}],[2,{:.6g}]]", coefficient, coefficient * fall,
                                       coefficient * std::sqrt(fall)));
    } else if (law < 0.3) {
        settings.emplace_back("tip.friction_law=lubricated");
        settings.push_back(fmt::format("tip.limiting_traction={:.6g}", coefficient * fall));
        settings.push_back(fmt::format("oil.temperature={:.6g}", urn.draw(300.0, 400.0)));
        if (warm < 0.5) settings.emplace_back("heat.enabled=true");
    }
    if (law < 0.3) settings.push_back(fmt::format("tip.pressure_sensitivity={:.6g}", sensitivity));
    if (off >= 0.2 || law >= 0.6) return;
    settings.push_back(fmt::format("imperfection.misalignment={:.6g} mm", urn.draw(-0.3, 0.3)));
    settings.push_back(fmt::format("imperfection.runout={:.6g} um", runout));
}

/// Ratio control and strand guides, from a separate urn. A machine without control drifts for seconds.
std::vector<std::string> drawn_holders(Urn urn, const Scene& scene) {
    std::vector<std::string> settings;
    const double held = urn.draw(), guided = urn.draw(), stiffness = urn.draw(5.0, 6.3), clearance = urn.draw(0.05, 0.5);
    const double offset = urn.draw(0.1, 0.3), friction = urn.draw(0.05, 0.3);
    if (held < 0.9) {
        settings.insert(settings.end(),
                        {"control.enabled=true", "control.quantity=ratio", "control.gains=found", "control.authority=40 kN"});
        settings.push_back(fmt::format("control.ratio={:.6g}", 1.002 * scene.parameters.start.ratio));
    }
    if (guided >= 1.0 / 3.0) return settings;
    settings.push_back(fmt::format("guide.stiffness={:.6g}", std::pow(10.0, stiffness)));
    settings.push_back(fmt::format("guide.clearance={:.6g} mm", clearance));
    settings.push_back(fmt::format("guide.offset={:.6g} mm", offset));
    settings.push_back(fmt::format("guide.friction_coefficient={:.6g}", friction));
    return settings;
}

}  // namespace

LotteryMachine lottery_machine(std::uint64_t seed, long number) {
    constexpr double typical_duration = 10e-3;  // [s]
    Urn urn(seed, number);
    Scene scene;
    LotteryMachine machine = number % 3 == 2 ? machine_of_ready_scene(urn, scene) : machine_of_defaults(urn, scene);
    if (machine.scene.empty() || urn.draw() < 0.4) draw_chain(urn, scene, machine.settings);
    draw_load(urn, scene, typical_duration, machine.settings);
    draw_hydraulics(urn, machine.settings);
    draw_extras(Urn(seed + 31, number), scene, machine);
    return machine;
}

Scene lottery_scene(std::uint64_t seed, long number, const LotteryRules& rules) {
    LotteryMachine machine = lottery_machine(seed, number);
    Scene scene = machine.scene.empty() ? Scene() : read_scene(find_scene(machine.scene));
    scene.name = fmt::format("machine {}", number);
    scene.run = RunSettings();
    std::vector<std::string>& settings = machine.settings;
    settings.push_back(fmt::format("start.settling_time={}", rules.settling_time));
    settings.push_back(fmt::format("start.ramp_time={}", 0.25 * rules.settling_time));
    settings.push_back(fmt::format("run.until={}", rules.duration * std::max(1.0, rules.longer)));
    settings.emplace_back("run.output_interval=20 us");
    settings.emplace_back("run.schedule=serial");
    if (!rules.detail.empty()) settings.insert(settings.end(), {"start.state=", "joint.law=linear"});  // of any level
    set_values(scene, settings);
    if (!rules.detail.empty()) apply_detail(scene, rules.detail);
    if (rules.longer > 0.0) set_values(scene, drawn_holders(Urn(seed + 62, number), scene));
    return scene;
}

double LotteryTicket::slip_error(const LotteryRules& rules) const noexcept {
    return std::abs(slip - exact_slip) / std::max(std::abs(exact_slip), rules.min_slip);
}

double LotteryTicket::loss_error() const noexcept { return std::abs(loss - exact_loss) / exact_loss; }

bool LotteryTicket::right(const LotteryRules& rules) const noexcept {
    const bool idle = notes.find("no_load") != std::string::npos;  // such a run is noted: its slip is that of idling
    return (idle || slip_error(rules) <= rules.tolerance) && loss_error() <= rules.tolerance;
}

namespace {

/// Means of a run.
class Means final : public RunObserver {
public:
    explicit Means(const model::Variator& variator) : observer_(variator) {}
    void output(double time, const Workspace& w, const Counters& counters) override { sample(time, w, counters); }
    [[nodiscard]] bool samples(double time) const noexcept override { return means.curve().due(time); }
    void sample(double time, const Workspace& w, const Counters&) override {
        means.add(w.observed_by(observer_, time), w.energy.sums(time), w.pin_period());
    }
    void transition(const TransitionRecord&) override {}
    RunMeans means;

private:
    model::Observer observer_;
};

[[nodiscard]] std::string_view pin_words(model::PinDetail pins) noexcept { return pins == model::PinDetail::rigid ? "rigid " : ""; }

void run_exactly(const Simulation& coarse, Scene scene, const engine::SavedState& start, LotteryTicket& ticket, const LotteryRules& rules) {
    scene.run.step = coarse.step() / rules.refinement;
    Simulation simulation(scene, Schedule{});
    simulation.reset(scene, &start);
    Means means(simulation.workspace().variator);
    const engine::Cancellation never;
    if (const Fault fault = simulation.advance({.until = rules.duration}, means, never)) {
        ticket.message = "shorter steps: " + fault.message();
        return;
    }
    ticket.exact_slip = means.means.all().slip;
    ticket.exact_loss = simulation.workspace().energy.sums(simulation.time()).lost();
    ticket.exact_residual = simulation.workspace().energy.balance().relative();
}

void settle_and_run(const Scene& scene, LotteryTicket& ticket, const LotteryRules& rules) {
    const auto began = std::chrono::steady_clock::now();
    Simulation simulation(scene, Schedule{});
    SilentObserver silent;
    const engine::Cancellation never;
    ticket.ready = !simulation.needs_settling();
    Fault fault = ticket.ready ? Fault{} : simulation.advance({.until = 0.0}, silent, never);
    const engine::SavedState start = simulation.saved_state();
    Means means(simulation.workspace().variator);
    if (!fault) fault = simulation.advance({.until = rules.duration}, means, never);
    ticket.wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    ticket.step = simulation.step();
    ticket.balance_error_ratio = simulation.balance_error_ratio();
    ticket.status = fault ? fault.name() : ticket.balance_error_ratio <= 1.0 ? "finished" : "unreliable";
    ticket.message = fault ? fault.message() : "";
    if (fault) return;
    ticket.slip = means.means.all().slip;
    ticket.loss = simulation.workspace().energy.sums(simulation.time()).lost();
    ticket.residual = simulation.workspace().energy.balance().relative();
    name_notes(means.means, simulation.workspace().energy.balance(), ticket.notes);
    run_exactly(simulation, scene, start, ticket, rules);
}

}  // namespace

LotteryTicket play(std::uint64_t seed, long number, const LotteryRules& rules) {
    LotteryTicket ticket;
    ticket.number = number;
    try {
        const Scene scene = lottery_scene(seed, number, rules);
        ticket.detail = fmt::format("{}{}{}", pin_words(scene.parameters.detail.pins),
                                    scene.parameters.detail.plates == model::PlateDetail::each ? "each" : "lumped",
                                    scene.parameters.detail.pulleys == model::PulleyDetail::elastic ? " elastic" : " rigid");
        settle_and_run(scene, ticket, rules);
    } catch (const std::exception& error) {
        ticket.status = "refused";
        ticket.message = error.what();
    }
    return ticket;
}

std::vector<LotteryTicket> play_all(std::uint64_t seed, long first, long count, int threads, const LotteryRules& rules) {
    std::vector<LotteryTicket> tickets(static_cast<std::size_t>(count));
    for (const std::string_view scene : ready_scenes_drawn) (void)find_scene(std::string(scene));  // not installed: not a refused machine
    long next = 0;
    engine::run_jobs(
        threads, false, [&](int) { return next < count ? std::optional(next++) : std::nullopt; },
        [&](int, long k) { tickets[static_cast<std::size_t>(k)] = play(seed, first + k, rules); });
    return tickets;
}

namespace {

/// Means up to a time, and from a later one on.
class BothMeans final : public RunObserver {
public:
    BothMeans(const model::Variator& variator, double until, double from) : observer_(variator), until_(until), from_(from) {}
    void output(double time, const Workspace& w, const Counters& counters) override { sample(time, w, counters); }
    [[nodiscard]] bool samples(double time) const noexcept override { return (time <= until_ ? brief : late).curve().due(time); }
    void sample(double time, const Workspace& w, const Counters&) override {
        const model::Observation& now = w.observed_by(observer_, time);
        if (time <= until_ * (1.0 + 1e-9)) brief.add(now, w.energy.sums(time), w.pin_period());
        if (time >= from_) late.add(now, w.energy.sums(time), w.pin_period());
    }
    void transition(const TransitionRecord&) override {}
    RunMeans brief, late;

private:
    model::Observer observer_;
    double until_, from_;  ///< [s]
};

void compare_means(const SpanMeans& brief, const SpanMeans& late, LongerTicket& ticket) {
    constexpr double min_slip = 3e-3, min_share_of_tight = 0.1;
    const auto thrust = [](const SpanMeans& m) { return m.clamping[1] != 0.0 ? m.clamping[0] / m.clamping[1] : 0.0; };
    const auto put = [&](std::string_view quantity, double is, double was, double least) {
        const double off = std::abs(is - was) / std::max(std::abs(was), least);
        if (off > ticket.off) ticket.off = off, ticket.quantity = quantity;
    };
    put("ratio", brief.ratio, late.ratio, 0.0);
    put("thrust ratio", thrust(brief), thrust(late), 0.0);
    put("tight tension", brief.tight, late.tight, 0.0);
    put("slack tension", brief.slack, late.slack, min_share_of_tight * late.tight);
    put("slip", brief.slip, late.slip, min_slip);
    put("slip by friction", brief.friction_slip, late.friction_slip, min_slip);
    put("losses", brief.lost, late.lost, 0.0);
}

void settle_and_run(const Scene& scene, const LotteryRules& rules, LongerTicket& ticket) {
    Simulation simulation(scene, Schedule{});
    BothMeans means(simulation.workspace().variator, rules.duration, 0.5 * rules.longer * rules.duration);
    const engine::Cancellation never;
    Fault fault = simulation.advance({.until = 0.0}, means, never);
    means.brief.clear();
    if (!fault) fault = simulation.advance({.until = rules.duration}, means, never);
    ticket.status = fault ? fault.name() : "finished";
    if (fault) return;
    name_notes(means.brief, simulation.workspace().energy.balance(), ticket.notes);
    fault = simulation.advance({.until = rules.longer * rules.duration}, means, never);
    ticket.later = fault ? fault.name() : "";
    if (!fault) compare_means(means.brief.all(), means.late.all(), ticket);
}

[[nodiscard]] LongerTicket play_machine(std::uint64_t seed, long number, const LotteryRules& rules) {
    const auto began = std::chrono::steady_clock::now();
    LongerTicket ticket;
    ticket.number = number;
    try {
        settle_and_run(lottery_scene(seed, number, rules), rules, ticket);
    } catch (const std::exception& error) {
        ticket.status = std::string("refused: ") + error.what();
    }
    ticket.wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    return ticket;
}

}  // namespace

std::vector<LongerTicket> play_longer(std::uint64_t seed, long first, long count, int threads, const LotteryRules& rules) {
    std::vector<LongerTicket> tickets(static_cast<std::size_t>(count));
    long next = 0;
    engine::run_jobs(
        threads, false, [&](int) { return next < count ? std::optional(next++) : std::nullopt; },
        [&](int, long k) { tickets[static_cast<std::size_t>(k)] = play_machine(seed, first + k, rules); });
    return tickets;
}

}  // namespace cvtflow::bench
