#include "tasks/run/run.hpp"
#include "tasks/method/auto_step.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>

#include "engine/base/hash.hpp"
#include "engine/record/run/state_file.hpp"
#include "model/kernels/kernels.hpp"
#include "tasks/run/run_loop.hpp"

namespace cvtflow::tasks {

namespace {

const engine::Cancellation never;

[[nodiscard]] double since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Writes checkpoints of a run, at intervals and where it ends early.
class CheckpointPauses final : public Pauses {
public:
    CheckpointPauses(const Scene& scene, const RunOptions& options, const Simulation& simulation, RunRecorder& recorder,
                     const RunHistory& history)
        : scene_(scene), options_(options), simulation_(simulation), recorder_(recorder), history_(history) {}

    [[nodiscard]] bool due(double /*time*/, const Counters& /*counters*/) override {
        return options_.checkpoint_every > 0.0 && since(last_) >= options_.checkpoint_every;
    }
    [[nodiscard]] bool pass() override {
        save();
        return true;
    }
    void save() {
        Checkpoint checkpoint;
        checkpoint.integration = simulation_.integration_state();
        checkpoint.history = history_;
        if (!options_.file.empty()) checkpoint.record = std::filesystem::absolute(options_.file.path).string();
        checkpoint.run = recorder_.run();
        checkpoint.recorder = recorder_.position();
        sign(checkpoint, scene_, simulation_.workspace().variator);
        engine::write_state(options_.checkpoint, checkpoint);
        last_ = std::chrono::steady_clock::now();  // saving takes no more than half of the time
    }

private:
    const Scene& scene_;
    const RunOptions& options_;
    const Simulation& simulation_;
    RunRecorder& recorder_;
    const RunHistory& history_;
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// Puts simulation, recorder and report to where the checkpoint was taken.
void restore(const Checkpoint& from, Simulation& simulation, RunRecorder& recorder, RunReport& report) {
    simulation.restore(from.integration);
    recorder.restore(from.recorder);
    static_cast<RunHistory&>(report) = from.history;
}

/// Warns at the start of a run if the step is beyond what is stable and accurate.
void warn_if_unstable(const Scene& scene, const RunOptions& options, const Simulation& simulation, RunReport& report) {
    if (scene.run.step.automatic()) return;  // what chooses it knows the limit
    report.stable_step = largest_step(simulation).step;
    report.step = scene.run.step;
    if (!report.beyond_stability() || !options.notice) return;
    options.notice(
        fmt::format("run.step = {:.3g} s is beyond what {} takes here, stable and accurate ({:.3g} s): run.step = \"auto\" takes {:.3g} s",
                    report.step, simulation.method().name(), report.stable_step, automatic_step(simulation)));
}

/// A run that ended before its checkpoint would count as finished, and could not be resumed. @throws SimulationError
void require_rest(const std::string& file, const Checkpoint& from, const Scene& scene) {
    if (scene.run.until.automatic() || scene.run.until >= from.integration.time * (1.0 - 1e-12)) return;
    throw SimulationError(fmt::format("{}: run.until = {} s is before the checkpoint, which is at t = {} s; it can only be continued", file,
                                      scene.run.until, from.integration.time));
}

/// Settling, if the start needs it, and the run.
void run_parts(const Scene& scene, const RunOptions& options, Simulation& simulation, RunRecorder& recorder, RunReport& report) {
    CheckpointPauses checkpoints(scene, options, simulation, recorder, report);
    SilentObserver silent;
    RunLoop loop(simulation, report, recorder.means(), checkpoints, silent, options.cancel != nullptr ? *options.cancel : never);
    loop.record(&recorder);
    report.fault = loop.settle(-scene.parameters.start.settling_time);
    if (!report.fault) {
        warn_if_unstable(scene, options, simulation, report);
        report.fault = loop.run(end_of(scene));
        report.counters = simulation.counters();
        report.local_errors = simulation.part().local_errors();
    }
    const FaultKind ended = report.fault.kind;
    if (ended != FaultKind::cancelled && ended != FaultKind::max_steps && ended != FaultKind::max_wall) return;
    if (!options.checkpoint.empty()) checkpoints.save();
}

}  // namespace

RunReport run_scene(const Scene& scene, const RunOptions& options) {
    Simulation simulation(scene);
    if (options.from != nullptr) {
        require_same(options.checkpoint, *options.from, scene, simulation.workspace().variator, options.mixed);
        require_rest(options.checkpoint, *options.from, scene);
    }
    RunRecorder recorder(scene, simulation, options);
    RunReport report;
    report.method = simulation.method().name();
    report.step_setting = scene.run.step;
    report.step_control = scene.run.step_control;
    report.tolerance = scene.run.tolerance;
    report.kernels = model::name_of(simulation.workspace().variator.chain().isa());
    report.working_set = simulation.workspace().bytes() + simulation.integrator().method().bytes().value_or(0);
    report.counts_method = simulation.integrator().method().bytes().has_value();
    report.start_differences = simulation.start_differences();
    if (options.from != nullptr)
        restore(*options.from, simulation, recorder, report);
    else if (simulation.needs_settling() && !report.start_differences.empty() && options.notice)
        options.notice(fmt::format("start.state: {}", report.start_differences.back()));
    run_parts(scene, options, simulation, recorder, report);
    if (simulation.part().step_choice() != nullptr) report.stable_step = simulation.part().step_choice()->stable_step();
    report.couplings = couplings_of(simulation);
    report.heat = simulation.workspace().heat;
    report.trip = simulation.workspace().trip.sums(simulation.time());
    report.settling_residual = simulation.integration_state().settling_residual;
    report.method_report = simulation.integrator().method().report();
    report.schedule = simulation.integrator().runner().text();
    recorder.finish(simulation, report, report.wall);
    // Rows of a record that this run did not continue are in no finished record.
    const bool complete = options.from == nullptr || options.from->run.empty() || !options.file.empty();
    if (!report.fault && complete && !options.checkpoint.empty()) remove_checkpoint(options.checkpoint);
    return report;
}

double settle_scene(const Scene& scene, const engine::OutputFile& state_file, const RunOptions& options) {
    Scene unsettled = scene;
    unsettled.state_file.clear();
    const engine::Cancellation& cancel = options.cancel != nullptr ? *options.cancel : never;
    Simulation simulation(unsettled);
    RunOptions quiet = options;
    quiet.file = {};
    RunRecorder recorder(unsettled, simulation, quiet);
    recorder.begin_part(-unsettled.parameters.start.settling_time, 0.0);
    if (simulation.needs_settling()) {
        if (const Fault fault = simulation.advance({.until = 0.0, .rows_between = true}, recorder, cancel)) throw SettlingFault(fault);
    }
    engine::write_state(state_file, simulation.saved_state());
    return simulation.balance_error_ratio();
}

}  // namespace cvtflow::tasks
