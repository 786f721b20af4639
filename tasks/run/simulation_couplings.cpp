/// The part of Simulation that couples shafts to what turns beyond them. (model/EQUATIONS.md section 8)

#include "tasks/run/simulation.hpp"

namespace cvtflow::tasks {

/// Couplings take over where a run begins: at t = 0 after settling, or at a start that needs none.
void Simulation::couple() {
    rest_.couplings.clear();
    Workspace& w = *workspace_;
    if (needs_settling_ || w.layout().pulley_size == 0) return;
    w.variator.couple(time_, w.states[0] + w.layout().pulley_begin());
    for (const model::ReferenceAngle& from : w.variator.pulleys().held().reference)
        rest_.couplings.insert(rest_.couplings.end(), {from.since, from.angle, from.zero});
}

void Simulation::restore_couplings(std::span<const double> numbers) {
    model::HeldInputs held = workspace_->variator.pulleys().held();
    held.coupled = !numbers.empty();
    for (model::ReferenceAngle& reference : held.reference) {
        reference = {};
        if (!held.coupled) continue;
        reference = {numbers[0], numbers[1], numbers[2]};
        numbers = numbers.subspan(3);
    }
    workspace_->variator.hold(held);
}

}  // namespace cvtflow::tasks
