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
#include "model/start/belt.hpp"
#include "tasks/run/run_means.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/scene/parameter_table.hpp"

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
    return physical && parameter.kind() == Kind::number && parameter.unit != "m" && parameter.unit != "rad";
}

struct OperatingPoint {
    double ratio, thrust_ratio;  ///< S_1/S_2 that holds it at three quarters of the load
};
constexpr OperatingPoint points[] = {{2.4, 1.18}, {1.0, 1.355}, {0.417, 1.55}};

/// Torque at which friction lets the driven side slip: 2 mu S_2 r_2/cos(beta) [N m].
[[nodiscard]] double carried_torque(const model::Parameters& p, double ratio, double clamping) {
    const auto radii = model::belt_radii(model::chain_length(p.chain), ratio, p.pulley.centre_distance);
    return radii ? 2.0 * p.tip.friction.coefficient * clamping * radii->driven / std::cos(p.tip.angle) : 0.0;
}

}  // namespace

std::vector<std::string> lottery_machine(std::uint64_t seed, long number) {
    Urn urn(seed, number);
    std::vector<std::string> settings;
    const DetailPreset& preset = urn.one_of(detail_presets());
    Scene scene;
    apply_detail(scene, preset.name);
    for (const std::string_view key : dial_keys()) settings.push_back(fmt::format("{}={}", key, value_text(*find_parameter(key), scene)));
    settings.push_back(urn.draw() < 0.5 ? "detail.friction=piecewise" : "detail.friction=smoothed");
    settings.push_back(urn.draw() < 0.5 ? "joint.law=linear" : "joint.law=palmgren");
    for (const Parameter& parameter : parameter_table()) {
        if (!drawn(parameter)) continue;
        const Slot slot = parameter.member(scene);
        double& value = **std::get_if<double*>(&slot);
        value = std::clamp(value * std::exp2(urn.draw(-1.0, 1.0)), parameter.min, parameter.max);
        settings.push_back(fmt::format("{}={:.6g}", parameter.key, value));
    }
    const OperatingPoint& point = urn.one_of(points);
    const double driven = 5e3 * std::pow(80.0 / 5.0, urn.draw());
    settings.push_back(fmt::format("start.ratio={}", point.ratio));
    settings.push_back(fmt::format("clamping.driven={:.6g}", driven));
    settings.push_back(fmt::format("clamping.driving={:.6g}", std::min(80e3, point.thrust_ratio * driven)));
    settings.push_back(fmt::format("drive.speed={:.6g} rpm", urn.draw(500.0, 6000.0)));
    settings.push_back(fmt::format("load.torque={:.6g}", urn.draw(0.0, 0.9) * carried_torque(scene.parameters, point.ratio, driven)));
    return settings;
}

double LotteryTicket::slip_error(const LotteryRules& rules) const noexcept {
    return std::abs(slip - exact_slip) / std::max(std::abs(exact_slip), rules.least_slip);
}

double LotteryTicket::loss_error() const noexcept { return std::abs(loss - exact_loss) / exact_loss; }

bool LotteryTicket::honest(const LotteryRules& rules) const noexcept {
    return status != "finished" || (slip_error(rules) <= rules.tolerance && loss_error() <= rules.tolerance);
}

namespace {

/// Means of a run.
class Means final : public RunObserver {
public:
    explicit Means(const model::Variator& variator) : eye_(variator) {}
    void output(double time, const Workspace& w, const Counters&) override {
        means.add(eye_.observe(time, w.states[0], w.tips.phases.data()), w.energy.sums(time), w.pin_period());
    }
    void transition(const TransitionRecord&) override {}
    RunMeans means;

private:
    model::Observer eye_;
};

/// The machine as a scene: defaults but for its settings.
[[nodiscard]] Scene lottery_scene(std::uint64_t seed, long number, const LotteryRules& rules) {
    Scene scene;
    scene.name = fmt::format("machine {}", number);
    std::vector<std::string> settings = lottery_machine(seed, number);
    settings.push_back(fmt::format("start.settling_time={}", rules.settling_time));
    settings.push_back(fmt::format("start.ramp_time={}", 0.25 * rules.settling_time));
    settings.push_back(fmt::format("run.until={}", rules.duration));
    settings.emplace_back("run.output_interval=20 us");
    settings.emplace_back("run.schedule=serial");
    set_values(scene, settings);
    return scene;
}

void run_exactly(const Simulation& coarse, Scene scene, const engine::SavedState& start, LotteryTicket& ticket, const LotteryRules& rules) {
    scene.run.step = coarse.step() / rules.refinement;
    Simulation simulation(scene, Schedule{});
    simulation.reset(scene, &start);
    Means means(simulation.variator());
    const engine::Cancellation never;
    if (const Fault fault = simulation.advance({.until = rules.duration}, means, never)) {
        ticket.message = "shorter steps: " + fault.message();
        return;
    }
    ticket.exact_slip = means.means.all().slip;
    ticket.exact_loss = simulation.energy().sums(simulation.time()).lost();
    ticket.exact_residual = simulation.energy().balance().relative();
}

void settle_and_run(const Scene& scene, LotteryTicket& ticket, const LotteryRules& rules) {
    const auto began = std::chrono::steady_clock::now();
    Simulation simulation(scene, Schedule{});
    SilentObserver silent;
    const engine::Cancellation never;
    Fault fault = simulation.advance({.until = 0.0}, silent, never);
    const engine::SavedState start = simulation.saved_state();
    Means means(simulation.variator());
    if (!fault) fault = simulation.advance({.until = rules.duration}, means, never);
    ticket.wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    ticket.step = simulation.step();
    ticket.suspicion = simulation.suspicion();
    ticket.status = fault ? fault.name() : ticket.suspicion <= 1.0 ? "finished" : "unreliable";
    ticket.message = fault ? fault.message() : "";
    if (fault) return;
    ticket.slip = means.means.all().slip;
    ticket.loss = simulation.energy().sums(simulation.time()).lost();
    ticket.residual = simulation.energy().balance().relative();
    means.means.name_notes(ticket.notes);
    run_exactly(simulation, scene, start, ticket, rules);
}

}  // namespace

LotteryTicket play(std::uint64_t seed, long number, const LotteryRules& rules) {
    LotteryTicket ticket;
    ticket.number = number;
    try {
        const Scene scene = lottery_scene(seed, number, rules);
        ticket.detail =
            fmt::format("{}{}{}{}", scene.parameters.detail.pins == model::PinDetail::whole ? "whole " : "", scene.parameters.detail.order,
                        scene.parameters.detail.plates == model::PlateDetail::each ? " each" : " lumped",
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
    long next = 0;
    engine::JobPool pool({threads});
    pool.run([&](int) { return next < count ? std::optional(next++) : std::nullopt; },
             [&](int, long k) { tickets[static_cast<std::size_t>(k)] = play(seed, first + k, rules); });
    return tickets;
}

}  // namespace cvtflow::bench
