#include "bench/study/stability/stable_step.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <stdexcept>
#include <vector>

#include "bench/method/analysis/stability.hpp"
#include "bench/method/laboratory_methods.hpp"
#include "bench/method/stability/growth.hpp"
#include "bench/method/stability/predicted_step.hpp"
#include "engine/method/catalogue.hpp"
#include "tasks/method/method.hpp"

namespace cvtflow::bench {

using namespace tasks;

namespace {

using Complex = std::complex<double>;

class Judge {
public:
    Judge(const engine::StagePlan& plan, std::span<const Complex> eigenvalues) : factor_(bench::stability_function(plan)) {
        for (const Complex& value : eigenvalues) {
            if (value.imag() >= 0.0 && value != 0.0) values_.push_back(value);
        }
        // The largest leave the region first, as a rule: an unstable step is found out at once.
        std::sort(values_.begin(), values_.end(), [](const Complex& a, const Complex& b) { return std::abs(a) > std::abs(b); });
        if (values_.empty()) throw std::invalid_argument(plan.name + ": without an eigenvalue besides 0 every step is stable");
    }

    [[nodiscard]] double largest() const { return std::abs(values_.front()); }

    /// The first eigenvalue whose mode grows.
    [[nodiscard]] std::optional<Complex> growing(double h) {
        for (const Complex& value : values_) {
            // A consistent method has R(z) = exp(z) + O(z²): a slow disturbance cannot grow by more than is tolerated.
            if (h * std::norm(value) < 0.5 * growth_rate_tolerance) continue;
            const double rate = std::log(std::abs(factor_(h * value))) / h;
            if (!(rate <= std::max(value.real(), 0.0) + growth_rate_tolerance)) return value;
        }
        return {};
    }

private:
    std::function<Complex(Complex)> factor_;
    std::vector<Complex> values_;
};

}  // namespace

StableStep largest_stable_step(const engine::StagePlan& plan, std::span<const std::complex<double>> eigenvalues) {
    Judge judge(plan, eigenvalues);
    const double stages = static_cast<double>(plan.stages.size());
    double stable = 0.0, unstable = 0.1 / judge.largest();
    const double longest =
        (2.0 * stages * stages + 10.0) / judge.largest();  // no consistent explicit method reaches further on the real axis
    std::optional<Complex> limiting;
    while (!(limiting = judge.growing(unstable)) && unstable < longest) stable = unstable, unstable *= 1.01;
    if (!limiting) return {unstable, {}};
    for (int halving = 0; halving < 40 && unstable - stable > 1e-7 * unstable; ++halving) {
        const double middle = 0.5 * (stable + unstable);
        const auto growing = judge.growing(middle);
        if (growing) limiting = growing;
        (growing ? unstable : stable) = middle;
    }
    return {stable, *limiting};
}

namespace {

constexpr double first_disturbance = 1e-9;  ///< [m/s]; rounding of positions makes 1e-11

/// Largest change of a velocity of the links.
double size_of(const model::ChainLayout& at, const std::vector<double>& state, const std::vector<double>& still) {
    double largest = 0.0;
    for (int link = 0; link < at.links; ++link) {
        for (int k = at.link_size(); k < at.link_block(); ++k) {
            const auto index = static_cast<std::size_t>(at.link_begin(link) + k);
            const double change = std::abs(state[index] - still[index]);
            largest = std::isfinite(change) ? std::max(largest, change) : INFINITY;
        }
    }
    return largest;
}

std::vector<double> disturbed(const model::ChainLayout& at, std::vector<double> state) {
    std::mt19937_64 random(7);
    for (int link = 0; link < at.links; ++link) {
        for (int k = at.link_size(); k < at.link_block(); ++k)
            state[static_cast<std::size_t>(at.link_begin(link) + k)] += (random() & 1) != 0 ? first_disturbance : -first_disturbance;
    }
    return state;
}

}  // namespace

bool disturbance_grows(const model::Variator& variator, const engine::StagePlan& plan, const FrozenStart& start, double h, int steps,
                       double natural_growth) {
    FrozenStepper stepper(variator, plan, start.phases);
    stepper.hold(start.time, start.state);
    std::vector<double> state = disturbed(variator.layout(), start.state);
    const auto large = [&](int count) {
        stepper.advance(start.time, h, count, state);
        return size_of(variator.layout(), state, start.state);
    };
    const double natural = std::exp(0.5 * natural_growth * steps * h);  // in half the time
    const double middle = large(steps / 2);
    if (middle > 1e3 * natural * first_disturbance) return true;
    const double end = large(steps - steps / 2);
    return end > 1e3 * natural * natural * first_disturbance || end > 2.0 * natural * middle;
}

MeasuredStep measured_stable_step(const model::Variator& variator, const engine::StagePlan& plan, const FrozenStart& start, double expected,
                                  double natural_growth) {
    const int stages = static_cast<int>(plan.stages.size());
    const int steps = std::clamp(30000 / stages, 100, 2000);
    MeasuredStep found{0.6 * expected, 1.6 * expected, 0};
    const auto grows = [&](double h) {
        found.evaluations += static_cast<long>(steps) * stages;
        return disturbance_grows(variator, plan, start, h, steps, natural_growth);
    };
    if (grows(found.stable)) return {0.0, found.stable, found.evaluations};
    if (!grows(found.unstable)) return {found.unstable, 0.0, found.evaluations};
    while (found.unstable - found.stable > 0.005 * found.stable) {
        const double middle = 0.5 * (found.stable + found.unstable);
        (grows(middle) ? found.unstable : found.stable) = middle;
    }
    return found;
}

namespace {

/// Largest velocities of disturbances, of each state one after the other [m/s]: small enough for the kinks of friction, large enough for
/// the rounding of forces as floats. Saturation speeds are 12 of the largest.
constexpr double disturbances[] = {3e-5, 1e-4, 4e-4};
constexpr double held_disturbances[] = {1e-7, 1e-6, 1e-5, 1e-8, 1e-9};  ///< [m/s]

[[nodiscard]] Scene with_method(Scene scene, std::string_view method) {
    scene.run.method = std::string(method);
    scene.run.step_control = StepControl::fixed;
    scene.run.step = scene.run.output_interval;  // any that is not automatic; hold() sets the step that is taken
    scene.run.schedule = "serial";
    return scene;
}

/// Makes `state` the start of a grid with that step; tips keep their phases.
void hold(IntegrationState& state, double h) {
    state.started = true;
    state.settling = false;
    state.begin = state.time;
    state.output_interval = state.step = h;
    state.grid_number = state.outputs = 0;
    state.grid_steps = 1;
    std::fill(state.changed.begin(), state.changed.end(), state.time);
}

/// Unit of a disturbance: a velocity of 1 m/s, and the distance that it covers in a step.
[[nodiscard]] std::vector<double> scale_of_state(const model::ChainLayout& at, double h) {
    std::vector<double> scale(static_cast<std::size_t>(at.size()), 1.0);
    for (int link = 0; link < at.links; ++link) std::fill_n(scale.begin() + at.link_begin(link), at.link_size(), h);
    std::fill_n(scale.begin() + at.pulley_begin(), at.pulley_size, h);
    return scale;
}

[[nodiscard]] std::vector<double> mixed_numbers(std::size_t size) {
    std::vector<double> numbers(size);
    for (std::size_t k = 0; k < size; ++k)
        numbers[k] = std::sin(1.0 + 12.9898 * static_cast<double>(k + 1) * static_cast<double>(k % 7 + 1));
    return numbers;
}

/// Factor that makes a disturbance as large as target.
[[nodiscard]] double length_of(const double* disturbing, int size, double largest_target) {
    double largest = 0.0;
    for (int k = 0; k < size; ++k) largest = std::max(largest, std::abs(disturbing[k]));
    return largest_target / largest;
}

}  // namespace

RealStep::RealStep(const Scene& scene, std::string_view method, const FrozenStart& start)
    : simulation_(with_method(scene, method)), start_(start) {}

/// A step on, in place.
bool RealStep::take(IntegrationState& state) {
    hold(state, h_);
    SilentObserver silent;
    const engine::Cancellation never;
    try {
        simulation_.restore(state);
        const Fault fault = simulation_.advance({.steps = 1}, silent, never);
        if (fault.kind != FaultKind::max_steps) return false;
    } catch (const std::exception&) {
        return false;  // a method that finds no polynomial
    }
    state = simulation_.integration_state();
    return std::all_of(state.state.begin(), state.state.end(), [](double x) { return std::isfinite(x); });
}

bool RealStep::prepare(double h) {
    h_ = h;
    base_ = simulation_.integration_state();
    base_.time = start_.time;
    base_.state = start_.state;
    base_.phases = start_.phases;
    base_.method.clear();
    base_.counters = {};
    image_ = base_;
    if (!take(image_)) return false;
    for (trial_ = 0; trial_ < 2 * std::size(disturbances);)
        if (!move_on()) return false;
    scale_ = scale_of_state(simulation_.workspace().layout(), h);
    scale_.resize(base_.state.size() + base_.method.size(), 1.0 / h);  // accelerations, most of them
    return true;
}

bool RealStep::move_on() {
    if (++trial_ % std::size(disturbances) != 0) return true;
    base_ = image_;
    return take(image_) && image_.method.size() == base_.method.size();
}

std::vector<double> RealStep::mixed_start() const {
    std::vector<double> start = mixed_numbers(base_.state.size());
    start.resize(scale_.size(), 0.0);
    return start;
}

bool RealStep::step(const double* from, double* to) {
    const double length = length_of(from, size(), disturbances[trial_ % std::size(disturbances)]);
    const std::size_t unknowns = base_.state.size();
    moved_ = base_;
    for (std::size_t k = 0; k < scale_.size(); ++k)
        (k < unknowns ? moved_.state[k] : moved_.method[k - unknowns]) += length * scale_[k] * from[k];
    if (!take(moved_)) return false;
    for (std::size_t k = 0; k < scale_.size(); ++k) {
        const double change = k < unknowns ? moved_.state[k] - image_.state[k] : moved_.method[k - unknowns] - image_.method[k - unknowns];
        to[k] = change / (length * scale_[k]);
    }
    return true;
}

HeldStep::HeldStep(const model::Variator& variator, const engine::StagePlan& plan, const FrozenStart& start)
    : layout_(variator.layout()), start_(start), stepper_(variator, plan, start_.phases) {
    stepper_.hold(start_.time, start_.state);
}

bool HeldStep::prepare(double h) {
    trial_ = 0;
    h_ = h;
    scale_ = scale_of_state(layout_, h);
    return true;
}

std::vector<double> HeldStep::mixed_start() const { return mixed_numbers(scale_.size()); }

bool HeldStep::step(const double* from, double* to) {
    const double length = length_of(from, size(), held_disturbances[trial_]);
    moved_ = start_.state;
    for (std::size_t k = 0; k < moved_.size(); ++k) moved_[k] += length * scale_[k] * from[k];
    stepper_.advance(start_.time, h_, 1, moved_);
    for (std::size_t k = 0; k < moved_.size(); ++k) to[k] = (moved_[k] - start_.state[k]) / (length * scale_[k]);
    return true;
}

namespace {

constexpr auto trials_in_a_row = static_cast<int>(3 * std::size(disturbances));  ///< three states, all disturbances

[[nodiscard]] std::unique_ptr<TakenStep> taken_step(const Scene& scene, const model::Variator& variator, std::string_view method,
                                                    const FrozenStart& start) {
    if (find_program(method) == nullptr) return std::make_unique<HeldStep>(variator, *engine::make_method(method), start);
    return std::make_unique<RealStep>(scene, method, start);
}

}  // namespace

MeasuredLimit measured_step_limit(const Scene& scene, std::string_view method, const FrozenStart& start, double expected) {
    const model::Variator variator(scene.parameters);
    const std::unique_ptr<TakenStep> taken = taken_step(scene, variator, method, start);
    TakenStep& step = *taken;
    MeasuredLimit limit;
    const auto stable = [&](double h) {
        limit.refused = !step.prepare(h);
        if (limit.refused) return false;
        for (int trial = 0; trial < trials_in_a_row; ++trial) {
            const auto map = [&](const double* from, double* to) { return step.step(from, to); };
            if (fastest_growth(step.size(), map, step.mixed_start()).factor <= 1.0 + growth_factor_tolerance) return true;
            if (!step.move_on()) return false;
        }
        return false;
    };
    const Bracket bracket = bracketed(expected, stable);
    limit.step = std::isinf(bracket.unstable) ? bracket.unstable : std::sqrt(bracket.stable * bracket.unstable);
    limit.refused = limit.refused && !std::isinf(limit.step);
    return limit;
}

}  // namespace cvtflow::bench
