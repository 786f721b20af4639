#include "tasks/stability/real_step.hpp"

#include <algorithm>
#include <cmath>

namespace cvtflow::tasks {

namespace {

constexpr double disturbance = 1e-6;   ///< largest velocity of one [m/s]; saturation speeds are thousands of it
constexpr double far_beyond = 1e6;     ///< a time that no step reaches [s]

[[nodiscard]] Scene with_method(Scene scene, std::string_view method) {
    scene.run.method = method;
    scene.run.step_control = StepControl::fixed;
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
    std::fill(state.changed.begin(), state.changed.end(), state.time);
}

}  // namespace

RealStep::RealStep(const Scene& scene, std::string_view method, const FrozenStart& start) : simulation_(with_method(scene, method)), start_(start) {}

/// A step on, in place.
bool RealStep::take_one(IntegrationState& state) {
    hold(state, h_);
    SilentObserver nobody;
    const engine::Cancellation never;
    try {
        simulation_.restore(state);
        const Fault fault = simulation_.advance(far_beyond, 1, nobody, never);
        if (fault.kind != FaultKind::max_steps) return false;
    } catch (const std::exception&) {
        return false;   // a method that finds no polynomial
    }
    state = simulation_.integration_state();
    return std::all_of(state.state.begin(), state.state.end(), [](double x) { return std::isfinite(x); });
}

bool RealStep::take(const IntegrationState& from, IntegrationState& to) {
    to = from;
    for (int step = 0; step < steps_; ++step) {
        if (!take_one(to)) return false;
    }
    return true;
}

bool RealStep::prepare(double h) {
    h_ = h;
    base_ = simulation_.integration_state();
    base_.time = start_.time;
    base_.state = start_.state;
    base_.phases = start_.phases;
    base_.method.clear();
    base_.counters = {};
    if (!take_one(base_) || !take_one(base_) || !combine(1)) return false;
    const model::ChainLayout& at = simulation_.variator().layout();
    scale_.assign(base_.state.size(), 1.0);
    for (int link = 0; link < at.links; ++link) std::fill_n(scale_.begin() + at.link_begin(link), at.link_size(), h);
    std::fill_n(scale_.begin() + at.pulley_begin(), at.pulley_size, h);
    scale_.resize(base_.state.size() + base_.method.size(), 1.0 / h);   // accelerations, most of them
    return true;
}

bool RealStep::combine(int steps) {
    steps_ = steps;
    return take(base_, image_) && image_.method.size() == base_.method.size();
}

std::vector<double> RealStep::mixed_start() const {
    std::vector<double> start(scale_.size(), 0.0);
    for (std::size_t k = 0; k < base_.state.size(); ++k) start[k] = std::sin(1.0 + 12.9898 * static_cast<double>(k + 1) * static_cast<double>(k % 7 + 1));
    return start;
}

bool RealStep::step(const double* from, double* to) {
    double largest = 0.0;
    for (int k = 0; k < size(); ++k) largest = std::max(largest, std::abs(from[k]));
    const double length = disturbance / largest;
    const std::size_t unknowns = base_.state.size();
    moved_ = base_;
    for (std::size_t k = 0; k < scale_.size(); ++k) (k < unknowns ? moved_.state[k] : moved_.method[k - unknowns]) += length * scale_[k] * from[k];
    if (!take(IntegrationState(moved_), moved_)) return false;
    for (std::size_t k = 0; k < scale_.size(); ++k) {
        const double change = k < unknowns ? moved_.state[k] - image_.state[k] : moved_.method[k - unknowns] - image_.method[k - unknowns];
        to[k] = change / (length * scale_[k]);
    }
    return true;
}

}  // namespace cvtflow::tasks
