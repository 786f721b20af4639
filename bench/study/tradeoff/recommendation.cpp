#include "bench/study/tradeoff/recommendation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "bench/method/stability/predicted_step.hpp"
#include "bench/study/tradeoff/error_measure.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/tuning/output.hpp"

namespace cvtflow::bench {

using namespace tasks;

std::optional<std::size_t> recommended(const std::vector<tasks::TradeoffPoint>& points, double error, double safety) {
    std::optional<std::size_t> best;
    for (std::size_t k = 0; k < points.size(); ++k) {
        if (!(points[k].error * safety <= error)) continue;
        if (!best || points[k].seconds < points[*best].seconds) best = k;
    }
    return best;
}

namespace {

using LongClock = std::chrono::steady_clock;

class LongObserver final : public RunObserver {
public:
    explicit LongObserver(const model::Variator& variator) : observer_(variator) {}
    void output(double time, const Workspace& workspace, const Counters&) override {
        watch.add(workspace.observed_by(observer_, time), workspace);
    }
    void transition(const TransitionRecord&) override {}

    RunWatch watch;

private:
    model::Observer observer_;
};

std::string percent(double share) { return fmt::format("{:.2g} %", 100.0 * share); }

}  // namespace

Confirmation::Confirmation(Scene scene, ConfirmSettings settings, const engine::Cancellation& cancel)
    : scene_(std::move(scene)), settings_(std::move(settings)), cancel_(cancel) {
    if (settings_.reference.empty())
        refine_reference();
    else
        take_reference();
}

LongRun Confirmation::run(std::span<const std::string> settings) const { return run(settings, nullptr, nullptr); }

LongRun Confirmation::run(std::span<const std::string> settings, FrozenStart* begin, FrozenStart* end) const {
    Simulation simulation(with_outputs(scene_, settings_.interval, settings));
    if (simulation.needs_settling())
        throw SimulationError(
            fmt::format("{}: the start is not settled, nothing can be measured from there (cvtflow settle)", scene_.name));
    if (begin != nullptr) *begin = frozen_start(simulation);
    LongObserver observer(simulation.workspace().variator);
    LongRun run;
    const auto started = LongClock::now();
    run.fault = simulation.advance({.until = simulation.time() + settings_.duration}, observer, cancel_);
    run.wall = std::chrono::duration<double>(LongClock::now() - started).count() / settings_.duration;
    run.watch = observer.watch.result(simulation.workspace().energy, simulation.balance_error_ratio());
    run.step = simulation.step();
    if (end != nullptr && !run.fault) *end = frozen_start(simulation);
    return run;
}

Confirmed Confirmation::judged(const LongRun& run) const {
    Confirmed found;
    found.ran = true;
    found.run = run;
    const WatchResult &is = run.watch, &should = reference_.watch;
    found.slip_error = relative_difference(is.means.slip, should.means.slip, min_slip);
    found.loss_error = relative_difference(is.loss, should.loss, std::numeric_limits<double>::min());
    if (run.fault)
        found.objection = run.fault.name();
    else if (!is.reliable())
        found.objection = "unreliable";
    else if (!(found.slip_error <= settings_.tolerance))
        found.objection = "slip off by " + percent(found.slip_error);
    else if (!(found.loss_error <= settings_.tolerance))
        found.objection = "losses off by " + percent(found.loss_error);
    return found;
}

double Confirmation::stable_step(std::span<const std::string> settings) {
    const Scene scene = with_outputs(scene_, settings_.interval, settings);
    const std::string method = method_of(scene);
    const auto known = stable_.find(method);
    if (known != stable_.end()) return known->second;
    double step = std::numeric_limits<double>::infinity();
    for (const LinearChain& end : ends_) step = std::min(step, predicted_step_limit(end, method).step);
    return stable_[method] = step;
}

bool Confirmation::beyond_stability(std::span<const std::string> settings) {
    const RunSettings run = with_outputs(scene_, settings_.interval, settings).run;
    if (run.step.automatic() || run.step_control == StepControl::error) return false;
    const double taken = run.output_interval / std::ceil(run.output_interval / run.step * (1.0 - 1e-12));
    return taken > stable_step(settings);
}

Confirmed Confirmation::check(std::span<const std::string> settings) {
    if (!beyond_stability(settings)) return judged(run(settings));
    Confirmed found;
    found.objection = "beyond stability";
    return found;
}

void Confirmation::take_reference() {
    FrozenStart begin, end;
    reference_ = run(settings_.reference, &begin, &end);
    reference_text_ =
        fmt::format("{} at {:.3g} s", method_of(with_outputs(scene_, settings_.interval, settings_.reference)), reference_.step);
    if (reference_.fault)
        throw SimulationError(
            fmt::format("{}: the reference of the confirmation did not get through: {}", scene_.name, reference_.fault.message()));
    if (!reference_.watch.reliable())
        throw SimulationError(
            fmt::format("{}: the reference of the confirmation is unreliable: its energy balance does not close", scene_.name));
    const Scene scene = with_outputs(scene_, settings_.interval, settings_.reference);
    ends_.clear();
    variator_ = std::make_unique<model::Variator>(scene.parameters);
    for (const FrozenStart& at : {begin, end}) ends_.emplace_back(*variator_, scene.parameters, at);
}

/// Takes a quarter of the automatic step if half of the automatic step agrees with it by a quarter of the tolerance; else shorter steps.
void Confirmation::refine_reference() {
    const std::string method = RunSettings{}.method;
    const auto settings = [&](double step) {
        return std::vector<std::string>{"run.method=" + method, fmt::format("run.step={:.17g}", step), "run.step_control=fixed"};
    };
    const double automatic = automatic_step(Simulation(with_outputs(scene_, settings_.interval, settings(1e-6)), Schedule{}));
    settings_.reference = settings(0.5 * automatic);
    take_reference();
    Confirmed half;
    for (const double share : {0.25, 0.125, 0.0625}) {
        const LongRun longer = reference_;
        settings_.reference = settings(share * automatic);
        take_reference();
        half = judged(longer);
        if (!(std::max(half.slip_error, half.loss_error) <= 0.25 * settings_.tolerance)) continue;
        reference_text_ += fmt::format(" ({:g} of its automatic step; twice that is off by {} in slip, {} in losses)", share,
                                       percent(half.slip_error), percent(half.loss_error));
        return;
    }
    throw SimulationError(
        fmt::format("{}: {} at a sixteenth of its automatic step does not agree with itself over {:.3g} s (twice that is off by {} in "
                    "slip, {} in losses): confirm over "
                    "another time or against another method",
                    scene_.name, method, settings_.duration, percent(half.slip_error), percent(half.loss_error)));
}

}  // namespace cvtflow::bench
