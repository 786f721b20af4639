/// The part of Simulation that couples shafts to what turns beyond them and fills cylinders; what a run reports of both.
/// (model/EQUATIONS.md section 8)

#include "tasks/run/simulation_couplings.hpp"

#include <fmt/format.h>

#include <cmath>

namespace cvtflow::tasks {

/// Couplings and hydraulics take over where a run begins: at t = 0 after settling, or at a start that needs none.
void Simulation::couple() {
    rest_.couplings.clear();
    Workspace& w = *workspace_;
    if (needs_settling_ || w.layout().pulley_size == 0) return;
    double* const tail = w.states[0] + w.layout().pulley_begin();
    w.variator.pulleys().fill_cylinders(time_, tail);
    w.variator.couple(time_, tail);
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

std::vector<CouplingReport> couplings_of(const Simulation& simulation) {
    std::vector<CouplingReport> found;
    const model::PulleyModel& pulleys = simulation.variator().pulleys();
    const CouplingSums& energy = simulation.energy().couplings();
    for (const int shaft : {0, 1}) {
        if (!pulleys.coupled(shaft)) continue;
        const auto now = pulleys.coupling(simulation.time(), simulation.state() + simulation.workspace().layout().pulley_begin(), shaft);
        const auto k = static_cast<std::size_t>(shaft);
        found.push_back({shaft, now.twist, now.energy, energy.work[k], energy.dissipated[k]});
    }
    return found;
}

namespace {

std::string hydraulic_lines(const RunReport& r) {
    const model::HydraulicEnergy& power = r.whole.hydraulics;
    if (power.pump == 0.0) return {};
    std::string text = fmt::format(
        "  hydraulics          pump {:.1f} W: mechanical {:.1f}  volumetric {:.1f}  relief {:.1f}  valves {:.1f}  leakage {:.1f} W\n",
        power.pump, power.mechanical, power.volumetric, power.relief, power.valves, power.leakage);
    const double residual = power.pump - power.lost() - power.sheaves - power.stored;
    text += fmt::format("                      on the sheaves {:.1f}  stored {:.2g} W; balance {:.2g} of the pump's power", power.sheaves,
                        power.stored, std::abs(residual) / power.pump);
    if (std::isfinite(r.whole.with_pump)) text += fmt::format("; efficiency with pump {:.2f} %", 100.0 * r.whole.with_pump);
    return text + "\n";
}

}  // namespace

std::string outside_lines(const RunReport& r) {
    std::string text;
    for (const CouplingReport& c : r.couplings)
        text += fmt::format("  coupling of shaft {} twist {:.4g} rad, {:.4g} J stored at the end; far end: {} {:.4g} J; {:.3g} J lost\n",
                            c.shaft + 1, c.twist, c.stored, c.far_work >= 0.0 ? "brought" : "took", std::abs(c.far_work), c.dissipated);
    return text + hydraulic_lines(r);
}

}  // namespace cvtflow::tasks
