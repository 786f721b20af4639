#include "tasks/method/friction/rigid_sweep.hpp"

#include <algorithm>
#include <cmath>

#include "tasks/step/assembly/segment_tasks.hpp"

namespace cvtflow::tasks {

namespace {

/// Radii of pins are known to this without further work [m].
constexpr double radius_error = 1e-4;

[[nodiscard]] double least_inertia(const model::RigidCoefficients& c) noexcept { return std::min(c.mass, c.tilt_mass); }

}  // namespace

RigidSweep::RigidSweep(Workspace& workspace)
    : w_(workspace),
      stepper_(workspace.variator),
      fastest_(0.5 * least_inertia(workspace.variator.chain().rigid()->model().coefficients()) * fastest_pin * fastest_pin) {}

void RigidSweep::start_if_cold() {
    if (cold_) stepper_.start(w_.step.time, w_.states[0]);
    cold_ = false;
}

NextCycle RigidSweep::begin() {
    start_if_cold();
    stepper_.step(w_.step.time, w_.step.h);
    shown_ = false;
    ++w_.step.evaluations;
    if (!is_suspect()) return NextCycle::done();
    fault_ = find_fault();
    return fault_ ? NextCycle::failed() : NextCycle::done();
}

/// Whether a pin may be where or as fast as none should be; false for almost all steps without one.
bool RigidSweep::is_suspect() const noexcept {
    if (!(std::abs(stepper_.kinetic()) <= fastest_)) return true;
    if (w_.layout().pulley_size == 0) return false;
    const model::RigidReaction& found = stepper_.forces().reaction;
    const model::Pulley& pulley = w_.parameters.pulley;
    return found.deepest > w_.parameters.tip.deepest || found.innermost < pulley.innermost + radius_error ||
           found.outermost > pulley.outermost - radius_error;
}

Fault RigidSweep::find_fault() {
    const model::ChainLayout& at = w_.layout();
    show();
    SegmentResult result;
    for (int pin = 0; pin < at.links && !result.fault; ++pin) check_motion(w_, pin, w_.states[0] + at.link_begin(pin), result);
    if (result.fault || at.pulley_size == 0) return result.fault;
    model::SheaveMotion sheaves[4];
    w_.variator.pulleys().motions(w_.states[0] + at.pulley_begin(), sheaves);
    for (int link = 0; link < at.links && !result.fault; ++link) {
        model::NeighbourWindow near;
        model::TipProbe probe;
        w_.variator.chain().probe(near.of(at, w_.states[0], link), sheaves, false, probe);
        check_contact(w_, link, probe, result);
    }
    return result.fault;
}

/// A tip touches where it presses.
void RigidSweep::show() {
    if (cold_ || shown_) return;
    shown_ = true;
    const model::ChainLayout& at = w_.layout();
    stepper_.state(w_.states[0]);
    auto phase = w_.tips.phases.begin();
    for (int link = 0; link < at.links; ++link) {
        for (int tip = 0; tip < model::tips_per_link; ++tip)
            *phase++ = stepper_.touches(link, tip) ? model::Phase::touching : model::Phase::free;
    }
}

const StepAccount& RigidSweep::account() {
    start_if_cold();
    const model::RigidBalance& now = stepper_.balance();
    account_ = {now.lost, now.worked, now.impulse, now.stored(), {now.far, now.twisted}};
    return account_;
}

void RigidSweep::save(std::vector<double>& memory) const {
    memory.clear();
    if (!cold_) stepper_.save(memory);
}

void RigidSweep::load(std::span<const double> memory) {
    if (memory.empty()) return;
    stepper_.load(memory);
    cold_ = shown_ = false;
}

}  // namespace cvtflow::tasks
