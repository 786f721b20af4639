#include "bench/study/stability/real_step.hpp"

#include <algorithm>
#include <cmath>

#include "bench/method/laboratory_methods.hpp"

namespace cvtflow::bench {

using namespace tasks;

namespace {

constexpr double disturbance = 1e-6;  ///< largest velocity of one [m/s]; saturation speeds are thousands of it
constexpr double held_disturbances[] = {1e-7, 1e-6, 1e-5, 1e-8, 1e-9};  ///< [m/s]

[[nodiscard]] Scene with_method(Scene scene, std::string_view method) {
    scene.run.method = bench::in_double_precision(method);  // a disturbance drowns in the rounding of floats
    scene.run.step_control = StepControl::fixed;
    scene.run.step = scene.run.output_interval;  // any that is not automatic; hold() sets the step that is taken
    scene.run.schedule = "serial";
    return scene;
}

/// `state` as the start of a grid with that step, tips not to change.
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
    if (!take(image_) || !move_on() || !move_on()) return false;
    scale_ = scale_of_state(simulation_.workspace().layout(), h);
    scale_.resize(base_.state.size() + base_.method.size(), 1.0 / h);  // accelerations, most of them
    return true;
}

bool RealStep::move_on() {
    base_ = image_;
    return take(image_) && image_.method.size() == base_.method.size();
}

std::vector<double> RealStep::mixed_start() const {
    std::vector<double> start = mixed_numbers(base_.state.size());
    start.resize(scale_.size(), 0.0);
    return start;
}

bool RealStep::step(const double* from, double* to) {
    const double length = length_of(from, size(), disturbance);
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

}  // namespace cvtflow::bench
