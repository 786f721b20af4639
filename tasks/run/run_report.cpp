/// Reports of runs as text.

#include "tasks/run/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/base/hash.hpp"

namespace cvtflow::tasks {

std::vector<CouplingReport> couplings_of(const Simulation& simulation) {
    std::vector<CouplingReport> found;
    const Workspace& w = simulation.workspace();
    const model::PulleyModel& pulleys = w.variator.pulleys();
    const CouplingSums& energy = w.energy.input_works().couplings;
    for (const int shaft : {0, 1}) {
        if (!pulleys.torques().coupled(shaft)) continue;
        const auto now = pulleys.torques().coupling(simulation.time(), w.state() + w.layout().pulley_begin(), shaft);
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
    return text + "\n";
}

std::string drag_lines(const RunReport& r) {
    const auto& [driving, driven] = r.whole.drag;
    if (driving == 0.0 && driven == 0.0) return {};
    return fmt::format(
        "  drag                seals, bearings and oil take {:.4g} W from shaft 1 and {:.4g} W from shaft 2, part of what is lost\n",
        driving, driven);
}

/// Efficiencies with losses that the chain's does not contain: of a pump, of the shafts' drag.
std::string efficiency_lines(const RunReport& r) {
    const bool pump = r.whole.hydraulics.pump != 0.0, drag = r.whole.drag[0] != 0.0 || r.whole.drag[1] != 0.0;
    if ((!pump && !drag) || !std::isfinite(r.whole.efficiency)) return {};
    std::string text = fmt::format("  efficiencies        {:.2f} % of the variator", 100.0 * r.whole.efficiency);
    if (pump) text += fmt::format("; {:.2f} % with the pump", 100.0 * r.whole.with_pump);
    if (drag) text += fmt::format("; {:.2f} % with drag of the shafts{}", 100.0 * r.whole.overall, pump ? " and the pump" : "");
    return text + "\n";
}

/// Energies of a cycle, of the vehicle and of the shafts.
std::string trip_lines(const RunReport& r) {
    using enum model::TripAccount;
    const auto of = [&r](model::TripAccount account) { return 1e-3 * r.trip[static_cast<std::size_t>(account)]; };
    if (of(distance) == 0.0) return {};
    const double lasted = r.end - r.whole.begin;
    return fmt::format(
        "  vehicle             {:.4g} m; traction {:.4g} kJ at the wheels; shaft 2 needs {:.4g} kJ: kinetic {:.4g}  climb {:.4g}  air "
        "{:.4g}\n"
        "                      rolling {:.4g}  brakes {:.4g}  clutch {:.4g}  final drive {:.4g} kJ; shaft 1 delivers {:.4g}, shaft 2 "
        "{:.4g} kJ\n"
        "                      speed of shaft 2 is off the cycle's by {:.3g} % on average, by {:+.3g} % at t = {:.4g} s\n",
        1e3 * of(distance), of(traction), of(shaft), of(kinetic), of(climb), of(air), of(rolling), of(brakes), of(clutch), of(final_drive),
        1e-3 * lasted * r.whole.shaft_power[0], -1e-3 * lasted * r.whole.shaft_power[1], 100.0 * r.whole.astray, 100.0 * r.cycle_miss.share,
        r.cycle_miss.time);
}

std::string outside_lines(const RunReport& r) {
    std::string text;
    for (const CouplingReport& c : r.couplings)
        text += fmt::format("  coupling of shaft {} twist {:.4g} rad, {:.4g} J stored at the end; far end: {} {:.4g} J; {:.3g} J lost\n",
                            c.shaft + 1, c.twist, c.stored, c.far_work >= 0.0 ? "brought" : "took", std::abs(c.far_work), c.dissipated);
    return text + hydraulic_lines(r) + drag_lines(r) + efficiency_lines(r) + trip_lines(r);
}

std::string heat_text(const model::HeatBalance& heat) {
    if (!heat.enabled()) return {};
    return fmt::format(
        "  temperature         pulleys {:.3f} K      oil {:.3f} K      heat {:.4g} J: {:.4g} J stored, {:.4g} J to ambient\n",
        heat.pulleys(), heat.oil(), heat.given(), heat.stored(), heat.taken());
}

std::string periods_text(const SpanMeans& means) {
    return means.periods > 0.0 ? fmt::format("{:.0f} pin periods", means.periods) : "less than a pin period";
}

/// Errors of the means, and when those begin that a run waits for.
std::string error_of_means_lines(const RunReport& r) {
    if (r.errors.batches == 0) return {};
    const auto error = [&r](std::size_t k) { return r.errors.error[k].sum(); };
    std::string text = fmt::format("  errors of means     tight ± {:.1f} N   slack ± {:.1f} N   thrust ratio ± {:.4f}   ratio ± {:.5f}\n",
                                   error(2), error(3), error(1), error(0));
    text += fmt::format("                      slip ± {:.4f} %   by friction ± {:.4f} %", 100.0 * error(4), 100.0 * error(5));
    if (std::isfinite(error(7))) text += fmt::format("   efficiency ± {:.3f} %", 100.0 * error(7));
    text += fmt::format("   lost ± {:.3g} W\n", error(6));
    if (r.revolutions == 0.0) return text;
    return text + fmt::format("  settled for         {:.4g} ms, {:.2f} revolutions of the chain; means are over as long again\n",
                              1e3 * (r.whole.begin - r.begin), r.revolutions);
}

std::string operating_point(const RunReport& r) {
    const SpanMeans& m = r.whole;
    std::string text;
    const auto line = [&text]<class... Args>(fmt::format_string<Args...> format, Args&&... args) {
        text += "  " + fmt::format(format, std::forward<Args>(args)...) + "\n";
    };
    constexpr double rpm = 30.0 / std::numbers::pi;
    line("strand tension      tight {:9.1f} N      slack {:9.1f} N      difference {:8.1f} N", m.tight, m.slack, m.tight - m.slack);
    if (!r.has_pulleys) return text;
    line("torque              drive {:9.3f} N*m    load  {:9.3f} N*m", m.torque[0], m.torque[1]);
    line("speed               drive {:9.2f} rpm    driven{:9.2f} rpm", rpm * m.speed[0], rpm * m.speed[1]);
    if (m.input > 0.0)
        line("power               in {:.5g} W      out {:.5g} W      lost {:.4g} W      stored {:.3g} W      out/in {:.2f} %", m.input,
             m.taken, m.lost, m.stored * m.input, 100.0 * m.taken / m.input);
    line("running radius      drive {:9.3f} mm     driven{:9.3f} mm", 1e3 * m.radius[0], 1e3 * m.radius[1]);
    line("clamping            S_1   {:9.1f} N      S_2   {:9.1f} N      thrust ratio {:.4f}", m.clamping[0], m.clamping[1],
         m.clamping[1] != 0.0 ? m.clamping[0] / m.clamping[1] : 0.0);
    line("axial tip forces    1-{:9.1f}  1+{:9.1f}  2-{:9.1f}  2+{:9.1f} N", m.axial_force[0], m.axial_force[1], m.axial_force[2],
         m.axial_force[3]);
    line("speed ratio         {:.5f}   (first fifth {:.5f}, last fifth {:.5f})", m.ratio, r.first_fifth.ratio, r.last_fifth.ratio);
    const auto percent = [](const SpanMeans& means) {
        if (std::isfinite(means.efficiency)) return fmt::format("{:.2f} %", 100.0 * means.efficiency);
        return std::string(means.no_load ? "- (no load)" : means.input > 0.0 ? "- (more is lost than comes in)" : "- (no input)");
    };
    line("slip                {:.3f} %      efficiency {}   (over {})", 100.0 * m.slip, percent(r.whole), periods_text(r.whole));
    if (r.whole.loss_slip > 0.0) {
        line("                    by friction {:.3f} %", 100.0 * r.whole.friction_slip);
        line("creep loss          {:.3f} % of the power", 100.0 * r.whole.loss_slip);
    }
    line("last fifth          slip {:.3f} %      efficiency {}      tight {:.1f} N      slack {:.1f} N", 100.0 * r.last_fifth.slip,
         percent(r.last_fifth), r.last_fifth.tight, r.last_fifth.slack);
    text += error_of_means_lines(r);
    text += outside_lines(r);
    return text;
}

/// Step, and up to which one the method is stable.
std::string step_text(const RunReport& r) {
    const bool known = r.stable_step > 0.0 && std::isfinite(r.stable_step);
    const std::string limit = known     ? fmt::format("stable up to about {:.3g} s", r.stable_step)
                              : r.fault ? "no stable step is known at its end"
                                        : "linear stability sets no limit";
    if (r.step_setting.automatic()) return fmt::format("{:.4g} s (auto; {})", r.step, limit);
    const bool shortened = r.step < r.step_setting * (1.0 - 1e-9) && r.step_control != StepControl::error;
    return fmt::format("{:.4g} s ({}{})", r.step,
                       shortened ? fmt::format("shortened from {:.4g} s to divide the time between outputs; ", r.step_setting.value) : "",
                       limit) +
           (r.beyond_stability() ? " BEYOND STABILITY" : "");
}

/// The energy balance, and what is odd.
std::string trust_lines(const RunReport& r) {
    const bool judged = !r.reliable() || r.energy.balance_error_ratio() > 0.0 || r.energy.relative() < 1.0;
    std::string text = "  energy balance      not judged: too few samples of the losses";
    if (judged) text = fmt::format("  energy balance      closes to {:.2g} % of {:.3g} J lost", 100.0 * r.energy.relative(), r.energy.loss);
    if (const JudgedBalance& j = r.judged; j.ratio > 1.0)
        text = fmt::format("  energy balance      is off by {:.2g} % of {:.3g} J lost from {:.6g} to {:.6g} s", 100.0 * j.relative, j.loss,
                           j.begin, j.end);
    const bool settled_wrongly = !r.reliable() && r.judged.ratio <= 1.0;
    if (r.settled) text += fmt::format("; settling {:.2g} %{}", 100.0 * r.settling_residual, settled_wrongly ? " in a part of it" : "");
    text += r.reliable() ? "\n" : "\n  " + unreliable_text(r) + "\n";
    for (const Note& note : r.notes) text += fmt::format("  note                {}\n", note.text);
    return text;
}

std::string transitions_text(const Counters& c) {
    return fmt::format("{} detected, {} steps truncated, {} suppressed", c.detected, c.truncated, c.suppressed);
}

/// Local errors and step-size control, as text; empty for StepControl::fixed.
std::string error_lines(const RunReport& r) {
    if (r.step_control == StepControl::fixed || r.local_errors.steps == 0) return {};
    std::string text = fmt::format("  local error         largest {:.2e}, mean {:.2e}", r.local_errors.largest, r.local_errors.mean());
    if (r.step_control == StepControl::report) return text + " (reported only)\n";
    const double mean_step = (r.end - r.begin) / static_cast<double>(std::max(1L, r.counters.steps));
    return text + fmt::format(", tolerance {:.2e}: mean step {:.3g} s, {} steps rejected\n", r.tolerance, mean_step, r.counters.rejected);
}

}  // namespace

std::string unreliable_text(const RunReport& r) { return unreliable_text(r.balance_error_ratio, r.step_setting, r.step); }

std::string summary(const RunReport& r) {
    const double simulated = r.end - r.begin;
    std::string text =
        fmt::format("{}\n", r.fault ? "stopped: " + r.fault.message() : fmt::format("{} at t = {:.6g} s", r.status(), r.end));
    for (const std::string& difference : r.start_differences) text += "  start state: " + difference + "\n";
    if (r.settled)
        text += fmt::format("  settled             {} steps, {} evaluations, {:.2f} s of wall time\n", r.settling.steps,
                            r.settling.evaluations, r.settling_wall);
    if (r.outputs > 0) text += operating_point(r) + heat_text(r.heat);
    text += fmt::format("  method              {}, step {}: {} steps, {} evaluations\n", r.method, step_text(r), r.counters.steps,
                        r.counters.evaluations);
    text += error_lines(r);
    text += trust_lines(r);
    if (!r.method_report.empty()) text += fmt::format("                      {}\n", r.method_report);
    text += fmt::format("  schedule            {}\n", r.schedule);
    text += fmt::format("  kernels             {}, working set {} KiB{}\n", r.kernels, (r.working_set + 1023) / 1024,
                        r.counts_method ? "" : ", without the method's memory");
    text += fmt::format("  transitions         {}{}\n", transitions_text(r.counters),
                        r.settled ? "; settling " + transitions_text(r.settling) : "");
    if (simulated > 0.0) {
        text += fmt::format("  wall time           {:.3f} s, {:.3g} s per simulated second ({:.2g} x real time)\n", r.wall,
                            r.wall / simulated, r.wall > 0.0 ? simulated / r.wall : 0.0);
    }
    text += fmt::format("  state hash          {}\n", engine::hex(r.hash));
    return text;
}

}  // namespace cvtflow::tasks
