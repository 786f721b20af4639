#include "tasks/run/run.hpp"
#include "tasks/method/auto_step.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "engine/base/hash.hpp"
#include "engine/record/run/state_file.hpp"
#include "model/basis/isa.hpp"
#include "tasks/method/stability/predicted_step.hpp"
#include "tasks/method/stability/step_search.hpp"
#include "tasks/run/run_recorder.hpp"
#include "tasks/run/simulation_couplings.hpp"
#include "tasks/run/unreliable_text.hpp"

namespace cvtflow::tasks {

namespace {

const engine::Cancellation never;

[[nodiscard]] double since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Runs a simulation with checkpoints: at intervals the run pauses at an output, is written to disk, and continues.
class Keeper final : public RunObserver {
public:
    Keeper(const Scene& scene, const RunOptions& options, Simulation& simulation, RunRecorder& recorder)
        : scene_(scene), options_(options), simulation_(simulation), recorder_(recorder) {
        simulation.pause_on(&due_);
    }

    void output(double time, const Workspace& workspace, const Counters& counters) override {
        recorder_.output(time, workspace, counters);
        due_ = options_.checkpoint_every > 0.0 && since(last_) >= options_.checkpoint_every;
    }
    [[nodiscard]] bool samples(double time) const noexcept override { return recorder_.samples(time); }
    void sample(double time, const Workspace& workspace) override { recorder_.sample(time, workspace); }
    void transition(const TransitionRecord& record) override { recorder_.transition(record); }

    /// The present part of the run, from the present state to its end. @param until end of a part that is not settling
    [[nodiscard]] Fault go(double until, const engine::Cancellation& cancel, RunReport& report) {
        Simulation& s = simulation_;
        recorder_.begin_part(s.needs_settling() ? -scene_.parameters.start.settling_time : report.begin, s.needs_settling() ? 0.0 : until);
        Fault fault = s.advance({.until = until}, *this, cancel);
        while (fault.kind == FaultKind::cancelled && due_) {
            save(report);
            fault = s.advance({.until = until}, *this, cancel);
        }
        const bool may_go_on =
            fault.kind == FaultKind::cancelled || fault.kind == FaultKind::max_steps || fault.kind == FaultKind::max_wall;
        if (may_go_on && !options_.checkpoint.empty()) save(report);
        return fault;
    }

private:
    void save(const RunReport& report) {
        due_ = false;
        last_ = std::chrono::steady_clock::now();
        Checkpoint checkpoint;
        checkpoint.integration = simulation_.integration_state();
        checkpoint.history = {report.settled, report.settling, report.begin, report.wall, report.settling_wall};
        (simulation_.needs_settling() ? checkpoint.history.settling_wall : checkpoint.history.wall) += since(started_);
        if (!options_.file.empty()) checkpoint.record = std::filesystem::absolute(options_.file.path()).string();
        checkpoint.run = recorder_.run();
        checkpoint.replaces = options_.replaces;
        checkpoint.recorder = recorder_.position();
        sign(checkpoint, scene_, simulation_.variator());
        write_checkpoint(options_.checkpoint, checkpoint);
    }

    const Scene& scene_;
    const RunOptions& options_;
    Simulation& simulation_;
    RunRecorder& recorder_;
    bool due_ = false;
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now(), started_ = last_;
};

/// Puts simulation, recorder and report to where the checkpoint was taken.
void restore(const Checkpoint& from, Simulation& simulation, RunRecorder& recorder, RunReport& report) {
    simulation.restore(from.integration);
    recorder.restore(from.recorder);
    report.settled = from.history.settled;
    report.settling = from.history.settling;
    report.settling_wall = from.history.settling_wall;
    report.begin = from.history.begin;
    report.wall = from.history.wall;
}

/// Warns at the start of a run if the step exceeds the stability limit. The quick bound is at most a fifth too low: where it
/// is not enough, the growth of this one step decides, and its limit is searched for only where it is beyond: ten times the work.
void warn_if_unstable(const Scene& scene, const RunOptions& options, const Simulation& simulation, RunReport& report) {
    if (scene.run.step.automatic()) return;  // what chooses it knows the limit
    AutoStep advice(simulation.variator(), scene.parameters, simulation.method());
    const double automatic = advice.longest(simulation.time(), simulation.state(), simulation.phases().data());
    report.stable_step = advice.stable_step();
    report.step = scene.run.step;
    if (!report.beyond_stability()) return;
    const LinearChain chain(simulation.variator(), scene.parameters, frozen_start(simulation));
    report.stable_step = predicted_growth(chain, simulation.method(), report.step) <= 1.0 + growth_factor_tolerance
                             ? report.step
                             : predicted_step_limit(chain, simulation.method()).step;
    if (!report.beyond_stability() || !options.notice) return;
    options.notice(fmt::format("run.step = {:.3g} s exceeds the stability limit of {} here ({:.3g} s): run.step = \"auto\" takes {:.3g} s",
                               report.step, simulation.method_name(), report.stable_step, automatic));
}

/// A run that ended before its checkpoint would count as finished, and nobody could go on with it. @throws SimulationError
void require_rest(const std::string& file, const Checkpoint& from, const Scene& scene) {
    if (scene.run.until >= from.integration.time * (1.0 - 1e-12)) return;
    throw SimulationError(fmt::format("{}: run.until = {} s is before the checkpoint, which is at t = {} s; it can only be continued", file,
                                      scene.run.until, from.integration.time));
}

/// Settling, if the start needs it, and the run.
void run_parts(const Scene& scene, const RunOptions& options, Simulation& simulation, RunRecorder& recorder, RunReport& report) {
    const engine::Cancellation& cancel = options.cancel != nullptr ? *options.cancel : never;
    if (simulation.needs_settling()) {
        const auto started = std::chrono::steady_clock::now();
        report.settled = true;
        report.fault = Keeper(scene, options, simulation, recorder).go(0.0, cancel, report);
        report.settling = simulation.counters();
        report.settling_wall += since(started);
    }
    if (report.fault) return;
    const auto started = std::chrono::steady_clock::now();
    if (!simulation.integration_state().started) report.begin = simulation.time();
    warn_if_unstable(scene, options, simulation, report);
    report.fault = Keeper(scene, options, simulation, recorder).go(scene.run.until, cancel, report);
    report.counters = simulation.counters();
    report.local_errors = simulation.local_errors();
    report.wall += since(started);
}

}  // namespace

RunReport run_scene(const Scene& scene, const RunOptions& options) {
    Simulation simulation(scene);
    if (options.from != nullptr) {
        require_same(options.checkpoint, *options.from, scene, simulation.variator(), options.mixed);
        require_rest(options.checkpoint, *options.from, scene);
    }
    RunRecorder recorder(scene, simulation, options);
    RunReport report;
    report.method = simulation.method_name();
    report.step_setting = scene.run.step;
    report.step_control = scene.run.step_control;
    report.tolerance = scene.run.tolerance;
    report.kernels = model::name_of(simulation.variator().chain().isa());
    if (model::fuses_multiply_add()) report.kernels += " with fused multiply-adds";
    report.working_set = simulation.workspace().bytes() + simulation.step_method().bytes().value_or(0);
    report.counts_method = simulation.step_method().bytes().has_value();
    report.counts_transitions = scene.parameters.detail.pins != model::PinDetail::rigid;
    report.start_differences = simulation.start_differences();
    if (options.from != nullptr)
        restore(*options.from, simulation, recorder, report);
    else if (simulation.needs_settling() && !report.start_differences.empty() && options.notice)
        options.notice(fmt::format("start.state: {}", report.start_differences.back()));
    run_parts(scene, options, simulation, recorder, report);
    report.end = simulation.time();
    report.step = simulation.step();
    if (simulation.step_choice() != nullptr) report.stable_step = simulation.step_choice()->stable_step();
    report.energy = simulation.energy().balance();
    report.couplings = couplings_of(simulation);
    report.heat = simulation.workspace().heat;
    report.suspicion = simulation.suspicion();
    report.settling_residual = simulation.integration_state().settling_residual;
    report.method_report = simulation.method_report();
    report.schedule = simulation.runner().text();
    report.hash = simulation.hash();
    recorder.finish(report);
    // Rows of a record that this run did not continue are in no finished record.
    const bool complete = options.from == nullptr || options.from->run.empty() || !options.file.empty();
    if (!report.fault && complete && !options.checkpoint.empty()) remove_checkpoint(options.checkpoint);
    return report;
}

double settle_scene(const Scene& scene, const engine::Permit& state_file, const RunOptions& options) {
    Scene unsettled = scene;
    unsettled.state_file.clear();
    const engine::Cancellation& cancel = options.cancel != nullptr ? *options.cancel : never;
    Simulation simulation(unsettled);
    RunOptions quiet = options;
    quiet.file = {};
    RunRecorder recorder(unsettled, simulation, quiet);
    recorder.begin_part(-unsettled.parameters.start.settling_time, 0.0);
    if (simulation.needs_settling()) {
        if (const Fault fault = simulation.advance({.until = 0.0}, recorder, cancel)) throw SettlingFault(fault);
    }
    engine::write_state(state_file, simulation.saved_state());
    return simulation.suspicion();
}

namespace {

std::string periods_text(const SpanMeans& means) {
    return means.periods > 0.0 ? fmt::format("{:.0f} pin periods", means.periods) : "less than a pin period";
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
    const auto percent = [&r](const SpanMeans& means) {
        if (r.whole.no_load || means.no_load) return std::string("- (no load)");
        return std::isfinite(means.efficiency) ? fmt::format("{:.2f} %", 100.0 * means.efficiency) : std::string("- (no input)");
    };
    line("slip                {:.3f} %      efficiency {}   (over {})", 100.0 * m.slip, percent(r.whole), periods_text(r.whole));
    if (r.whole.loss_slip > 0.0) {
        line("                    by friction {:.3f} %", 100.0 * r.whole.friction_slip);
        line("creep loss          {:.3f} % of the power", 100.0 * r.whole.loss_slip);
    }
    line("last fifth          slip {:.3f} %      efficiency {}      tight {:.1f} N      slack {:.1f} N", 100.0 * r.last_fifth.slip,
         percent(r.last_fifth), r.last_fifth.tight, r.last_fifth.slack);
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
    std::string text = fmt::format("  energy balance      {} {:.2g} % of {:.3g} J lost", r.reliable() ? "closes to" : "is off by",
                                   100.0 * r.energy.relative(), r.energy.loss);
    if (r.settled) text += fmt::format("; settling {:.2g} %", 100.0 * r.settling_residual);
    text += r.reliable() ? "\n" : "\n  " + unreliable_text(r) + "\n";
    for (const Note& note : r.notes) text += fmt::format("  note                {}\n", note.text);
    return text;
}

std::string transitions_text(const Counters& c) {
    return fmt::format("{} detected, {} steps truncated, {} suppressed", c.detected, c.truncated, c.suppressed);
}

/// What was asked about local errors and what came out; empty if nothing was.
std::string error_lines(const RunReport& r) {
    if (r.step_control == StepControl::fixed || r.local_errors.steps == 0) return {};
    std::string text = fmt::format("  local error         largest {:.2e}, mean {:.2e}", r.local_errors.largest, r.local_errors.mean());
    if (r.step_control == StepControl::report) return text + " (reported only)\n";
    const double mean_step = (r.end - r.begin) / static_cast<double>(std::max(1L, r.counters.steps));
    return text + fmt::format(", tolerance {:.2e}: mean step {:.3g} s, {} steps rejected\n", r.tolerance, mean_step, r.counters.rejected);
}

}  // namespace

std::string unreliable_text(const RunReport& r) { return unreliable_text(r.suspicion, r.step_setting, r.step); }

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
    text += fmt::format("  transitions         {}{}\n", r.counts_transitions ? transitions_text(r.counters) : transitions_not_counted,
                        r.settled && r.counts_transitions ? "; settling " + transitions_text(r.settling) : "");
    if (simulated > 0.0) {
        text += fmt::format("  wall time           {:.3f} s, {:.0f} s per simulated second ({:.2g} x real time)\n", r.wall,
                            r.wall / simulated, r.wall > 0.0 ? simulated / r.wall : 0.0);
    }
    text += fmt::format("  state hash          {}\n", engine::hex(r.hash));
    return text;
}

}  // namespace cvtflow::tasks
