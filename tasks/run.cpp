#include "tasks/run.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <numbers>

#include "engine/base/hash.hpp"
#include "engine/record/state_file.hpp"
#include "tasks/auto_schedule.hpp"
#include "tasks/run_recorder.hpp"
#include "tasks/stable_step.hpp"

namespace cvtflow::tasks {

namespace {

const engine::Cancellation never;

[[nodiscard]] double since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Settles if the start needs it; the fault, if any, is in the report.
void settle(Simulation& simulation, const Scene& scene, RunRecorder& recorder, const engine::Cancellation& cancel, RunReport& report) {
    if (!simulation.needs_settling()) return;
    const auto started = std::chrono::steady_clock::now();
    report.settled = true;
    recorder.begin_part(-scene.parameters.start.settling_time, 0.0);
    report.fault = simulation.settle(recorder, cancel);
    report.settling = simulation.counters();
    report.settling_wall = since(started);
}

}  // namespace

RunReport run_scene(const Scene& scene, const RunOptions& options) {
    const engine::Cancellation& cancel = options.cancel != nullptr ? *options.cancel : never;
    const Choice choice = scene.run.schedule == "auto" ? choose_schedule(scene) : Choice{schedule_of(scene.run, scene.parameters.chain.pins), {}, ""};
    Simulation simulation(scene, choice.schedule);
    RunRecorder recorder(scene, simulation, options);
    RunReport report;
    report.method = scene.run.method;
    report.schedule = choice.reason.empty() ? choice.schedule.text() : fmt::format("{} ({})", choice.schedule.text(), choice.reason);
    report.start_differences = simulation.start_differences();
    settle(simulation, scene, recorder, cancel, report);
    if (!report.fault) {
        const auto started = std::chrono::steady_clock::now();
        report.begin = simulation.time();
        report.stable_step = largest_stable_step(simulation.variator(), scene.run.method, simulation.time(), simulation.state(), simulation.phases());
        recorder.begin_part(simulation.time(), scene.run.until);
        report.fault = simulation.run(scene.run.until, recorder, cancel);
        report.counters = simulation.counters();
        report.wall = since(started);
    }
    report.end = simulation.time();
    report.step = simulation.step();
    report.hash = simulation.hash();
    recorder.finish(report);
    return report;
}

void settle_scene(const Scene& scene, const std::string& state_file, const RunOptions& options) {
    Scene unsettled = scene;
    unsettled.state_file.clear();
    const engine::Cancellation& cancel = options.cancel != nullptr ? *options.cancel : never;
    Simulation simulation(unsettled);
    RunOptions quiet = options;
    quiet.file.clear();
    RunRecorder recorder(unsettled, simulation, quiet);
    RunReport report;
    settle(simulation, unsettled, recorder, cancel, report);
    if (report.fault) throw SettlingFault(report.fault);
    engine::write_state(state_file, simulation.saved_state());
}

namespace {

std::string operating_point(const RunReport& r) {
    std::string text;
    const auto line = [&text]<class... Args>(fmt::format_string<Args...> format, Args&&... args) {
        text += "  " + fmt::format(format, std::forward<Args>(args)...) + "\n";
    };
    constexpr double rpm = 30.0 / std::numbers::pi;
    line("strand tension      tight {:9.1f} N      slack {:9.1f} N      difference {:8.1f} N", r.tight, r.slack, r.tight - r.slack);
    if (!r.has_pulleys) return text;
    line("torque              drive {:9.3f} N*m    load  {:9.3f} N*m", r.torque[0], r.torque[1]);
    line("speed               drive {:9.2f} rpm    driven{:9.2f} rpm", rpm * r.speed[0], rpm * r.speed[1]);
    line("running radius      drive {:9.3f} mm     driven{:9.3f} mm", 1e3 * r.radius[0], 1e3 * r.radius[1]);
    line("clamping            S_1   {:9.1f} N      S_2   {:9.1f} N      thrust ratio {:.4f}", r.clamping[0], r.clamping[1],
         r.clamping[1] != 0.0 ? r.clamping[0] / r.clamping[1] : 0.0);
    line("axial tip forces    1-{:9.1f}  1+{:9.1f}  2-{:9.1f}  2+{:9.1f} N", r.axial_force[0], r.axial_force[1], r.axial_force[2], r.axial_force[3]);
    line("speed ratio         {:.5f}   (first fifth {:.5f}, last fifth {:.5f})", r.ratio, r.ratio_begin, r.ratio_end);
    const bool steady = r.efficiency > 0.0 && r.efficiency < 1.02;   // else shafts are still speeding up or braking
    line("slip                {:.3f} %      efficiency {}", 100.0 * r.slip, steady ? fmt::format("{:.2f} %", 100.0 * r.efficiency) : "- (not steady)");
    return text;
}

}  // namespace

/// Said when the step is the likely reason of a fault, or beyond what the method can take: chattering friction looks plausible and is wrong.
std::string stability_line(const RunReport& r) {
    const bool unstable = r.fault.kind == FaultKind::non_finite || r.fault.kind == FaultKind::blow_up || r.fault.kind == FaultKind::penetration ||
                          r.fault.kind == FaultKind::left_sheave;
    const bool known = r.stable_step > 0.0 && std::isfinite(r.stable_step);
    if (!known || (r.step <= beyond_stability * r.stable_step && !unstable)) return "";
    return fmt::format("  stable step         {} is stable for steps up to {:.2g} s here (estimate){}\n", r.method, r.stable_step,
                       r.step > beyond_stability * r.stable_step ? "; this step is beyond" : "");
}

std::string summary(const RunReport& r) {
    const double simulated = r.end - r.begin;
    std::string text = fmt::format("{}\n", r.fault ? "stopped: " + r.fault.message() : fmt::format("finished at t = {:.6g} s", r.end));
    for (const std::string& difference : r.start_differences) text += "  start state: " + difference + "\n";
    if (r.settled) text += fmt::format("  settled             {} steps, {} evaluations, {:.2f} s of wall time\n", r.settling.steps, r.settling.evaluations, r.settling_wall);
    if (r.outputs > 0) text += operating_point(r);
    text += fmt::format("  method              {}, step {:.4g} s: {} steps, {} evaluations\n", r.method, r.step, r.counters.steps, r.counters.evaluations);
    text += stability_line(r);
    text += fmt::format("  schedule            {}\n", r.schedule);
    text += fmt::format("  transitions         {} detected, {} steps truncated, {} suppressed\n", r.counters.detected, r.counters.truncated, r.counters.suppressed);
    if (simulated > 0.0) text += fmt::format("  wall time           {:.3f} s, {:.0f} s per simulated second\n", r.wall, r.wall / simulated);
    text += fmt::format("  state hash          {}\n", engine::hex(r.hash));
    return text;
}

}  // namespace cvtflow::tasks
