#include "bench/study/error_measure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "bench/method/implicit/trapezoidal.hpp"
#include "model/observe/observation.hpp"

namespace cvtflow::bench {

using namespace tasks;

void RelativeError::add(std::span<const double> is, std::span<const double> expected) noexcept {
    for (std::size_t i = 0; i < expected.size(); ++i) {
        difference_ += (is[i] - expected[i]) * (is[i] - expected[i]);
        reference_ += expected[i] * expected[i];
    }
}

void RelativeError::add(const RelativeError& other) noexcept {
    difference_ += other.difference_;
    reference_ += other.reference_;
}

double RelativeError::value() const noexcept {
    if (difference_ == 0.0 && std::isfinite(reference_)) return 0.0;
    const double value = std::sqrt(difference_ / reference_);
    return std::isfinite(value) ? value : std::numeric_limits<double>::infinity();
}

double relative_error(std::span<const double> is, std::span<const double> expected) noexcept {
    RelativeError error;
    error.add(is, expected);
    return error.value();
}

namespace {

using Clock = std::chrono::steady_clock;

constexpr double infinite = std::numeric_limits<double>::infinity();

double seconds(Clock::duration duration) { return std::chrono::duration<double>(duration).count(); }

/// Records the data whose errors are measured, and the time that this takes.
class TrajectoryObserver final : public RunObserver {
public:
    TrajectoryObserver(const model::Variator& variator, double begin, Trajectory& into) : observer_(variator), begin_(begin), into_(into) {}

    void output(double time, const Workspace& workspace, const Counters&) override {
        const auto started = Clock::now();
        const model::Observation& seen = workspace.observed_by(observer_, time);
        watch.add(seen, workspace);
        if (time > begin_)
            add(time, seen);
        else
            note_sides(workspace);
        observing_ += seconds(Clock::now() - started);
    }
    void transition(const TransitionRecord& record) override { into_.transitions.push_back(record); }

    [[nodiscard]] double observing() const noexcept { return observing_; }

    RunWatch watch;

private:
    void add(double time, const model::Observation& seen) {
        into_.times.push_back(time);
        into_.axial_force.push_back(seen.tip_axial);
        into_.tension.push_back(seen.tension);
        into_.slip.push_back(seen.slip);
        into_.losses.push_back(std::accumulate(seen.account.loss.begin(), seen.account.loss.end(), 0.0));
    }

    void note_sides(const Workspace& workspace) {
        const model::ChainLayout& at = workspace.layout();
        for (int link = 0; link < at.links; ++link)
            into_.side.push_back(workspace.state()[at.link_begin(link) + at.x(model::End::rear, 0)]);
    }

    model::Observer observer_;
    double begin_;
    Trajectory& into_;
    double observing_ = 0.0;
};

Trajectory observed(const Scene& scene, const MeasureSettings& settings, double duration, const engine::Cancellation& cancel) {
    Trajectory trajectory;
    Simulation simulation(scene);
    if (settings.start) simulation.reset(scene, &*settings.start);
    const double begin = simulation.time();
    if (simulation.needs_settling())
        throw SimulationError(fmt::format("{}: the start is not settled, nothing can be measured from there (cvtflow settle)", scene.name));
    TrajectoryObserver observer(simulation.workspace().variator, begin, trajectory);
    const auto started = Clock::now();
    trajectory.fault = simulation.advance({.until = begin + duration}, observer, cancel);
    trajectory.wall = seconds(Clock::now() - started) - observer.observing();
    trajectory.counters = simulation.counters();
    trajectory.step = simulation.step();
    trajectory.simulated = simulation.time() - begin;
    trajectory.hash = simulation.hash();
    trajectory.watch = observer.watch.result(simulation.workspace().energy, simulation.balance_error_ratio());
    trajectory.schedule = simulation.integrator().runner().schedule().text();
    if (const auto* trapezoidal = dynamic_cast<const TrapezoidalMethod*>(&simulation.integrator().method()))
        trajectory.newton = trapezoidal->statistics();
    return trajectory;
}

std::span<const double> numbers(const double& value) noexcept { return {&value, 1}; }
std::span<const double> numbers(const std::vector<double>& values) noexcept { return values; }

/// Errors of one quantity: of all outputs, and of the worst.
template <class Row>
std::pair<double, double> quantity_errors(const std::vector<Row>& values, const std::vector<Row>& reference) {
    RelativeError all;
    double worst = 0.0;
    for (std::size_t output = 0; output < reference.size(); ++output) {
        RelativeError here;
        here.add(numbers(values[output]), numbers(reference[output]));
        worst = std::max(worst, here.value());
        all.add(here);
    }
    return {all.value(), worst};
}

}  // namespace

double TrajectoryErrors::largest() const noexcept { return std::max({axial_force, tension, slip, losses}); }

ErrorReport compare(const Trajectory& run, const Trajectory& reference) {
    if (reference.fault) throw std::invalid_argument("the reference ended early: " + reference.fault.message());
    constexpr TrajectoryErrors lost{infinite, infinite, infinite, infinite};
    if (run.fault) return {lost, lost};
    if (run.times != reference.times) throw std::invalid_argument("the run and its reference have different output times");
    ErrorReport report;
    std::tie(report.overall.axial_force, report.worst.axial_force) = quantity_errors(run.axial_force, reference.axial_force);
    std::tie(report.overall.tension, report.worst.tension) = quantity_errors(run.tension, reference.tension);
    std::tie(report.overall.slip, report.worst.slip) = quantity_errors(run.slip, reference.slip);
    std::tie(report.overall.losses, report.worst.losses) = quantity_errors(run.losses, reference.losses);
    return report;
}

Scene with_outputs(const Scene& scene, double interval, std::span<const std::string> settings) {
    std::vector<std::string> all{fmt::format("run.output_interval={:.17g}", interval), fmt::format("run.state_interval={:.17g}", interval)};
    all.insert(all.end(), settings.begin(), settings.end());
    Scene changed = scene;
    set_values(changed, all);
    return changed;
}

ErrorMeasure::ErrorMeasure(Scene scene, MeasureSettings settings, const engine::Cancellation& cancel)
    : scene_(std::move(scene)), settings_(std::move(settings)), cancel_(cancel), reference_(run(settings_.reference)) {
    if (reference_.fault)
        throw SimulationError(fmt::format("{}: the reference did not get through: {}", scene_.name, reference_.fault.message()));
}

Trajectory ErrorMeasure::run(std::span<const std::string> settings) const {
    const Scene scene = with_outputs(scene_, settings_.interval, settings);
    Trajectory run = observed(scene, settings_, settings_.duration, cancel_);
    if (scene.run.step.automatic() && !run.fault && settings_.steady > settings_.duration)
        run.steady_wall = observed(scene, settings_, settings_.steady, cancel_).wall_per_second();
    return run;
}

std::vector<double> Trajectory::pin_axial(int pin, int sheave_side) const {
    const std::size_t links = side.size(), own = static_cast<std::size_t>(pin), before = (own + links - 1) % links;
    const auto number = static_cast<std::size_t>(sheave_side);
    std::vector<double> forces;
    for (const std::vector<double>& tips : axial_force)
        forces.push_back(tips[model::tips_per_link * own + number] + tips[model::tips_per_link * before + 2 + number]);
    return forces;
}

std::optional<PinEntry> first_entry(const Trajectory& run, const model::Parameters& parameters) {
    for (const TransitionRecord& record : run.transitions) {
        const bool enters = record.from == model::Phase::free && record.to != model::Phase::free;
        const double side = run.side[static_cast<std::size_t>(record.pin) % run.side.size()];  // the driving shaft is at x = 0
        if (enters && side < 0.5 * parameters.pulley.centre_distance) return PinEntry{record.pin % parameters.chain.pins, record.time};
    }
    return std::nullopt;
}

double pin_error(const Trajectory& run, const Trajectory& reference, int pin) {
    if (run.fault || run.times != reference.times) return infinite;
    RelativeError error;
    for (const int side : {0, 1}) error.add(run.pin_axial(pin, side), reference.pin_axial(pin, side));
    return error.value();
}

}  // namespace cvtflow::bench
