/// The C interface to what needs threads and files: worker threads, records of simulations.

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "api/c/boundary.hpp"
#include "engine/record/run/run_reader.hpp"
#include "engine/thread/worker_threads.hpp"
#include "tasks/run/run_recorder.hpp"

using namespace cvtflow;

namespace {

/// Writes the record of a simulation while it is advanced.
struct Recording final : public tasks::RunObserver {
    api::HostSimulation& simulation;
    const tasks::Scene& scene;
    tasks::RunOptions options;
    tasks::RunRecorder recorder;
    double next;  ///< outputs are numbered by their multiples of the interval

    Recording(api::HostSimulation& of, const std::string& path, bool replace)
        : simulation(of),
          scene(of.scene()),
          options(writing(path, of, replace)),
          recorder(scene, of.simulation(), options),
          next(std::ceil(std::max(0.0, of.simulation().time()) / scene.run.output_interval - 1e-9)) {
        simulation.callbacks().recorder = this;
    }
    ~Recording() override { detach(); }
    Recording(const Recording&) = delete;
    Recording& operator=(const Recording&) = delete;

    [[nodiscard]] static tasks::RunOptions writing(const std::string& path, api::HostSimulation& of, bool replace) {
        if (of.callbacks().recorder != nullptr) throw Error(ErrorCode::state, "the simulation is being recorded already");
        tasks::RunOptions made;
        made.file = {path, engine::any_file(replace), "remove it, name another file, or replace = true"};
        engine::require_place(made.file, input_files(of.scene()));
        return made;
    }

    void detach() noexcept {
        if (simulation.callbacks().recorder == this) simulation.callbacks().recorder = nullptr;
    }

    void output(double time, const tasks::Workspace& workspace, const tasks::Counters& counters) override {
        // Calls of advance_to() also end with an output, settling with one at t = 0 that the run repeats.
        const double number = time / scene.run.output_interval + 1e-9;
        if (simulation.simulation().needs_settling()) return;
        if (number < next || (simulation.simulation().part().outputs_together() > 1 && time != workspace.step.output)) {
            if (recorder.samples(time)) sample(time, workspace, counters);
            return;
        }
        next = std::floor(number) + 1.0;
        api::translated(ErrorCode::record, [&] { recorder.output(time, workspace, counters); });
    }
    [[nodiscard]] bool samples(double time) const noexcept override {
        return !simulation.simulation().needs_settling() && recorder.samples(time);
    }
    void sample(double time, const tasks::Workspace& workspace, const tasks::Counters& counters) override {
        api::translated(ErrorCode::record, [&] { recorder.sample(time, workspace, counters); });
    }
    void transition(const tasks::TransitionRecord& record) override {
        if (simulation.simulation().needs_settling()) return;
        api::translated(ErrorCode::record, [&] { recorder.transition(record); });
    }

    void finish(bool complete) {
        detach();
        const tasks::Simulation& now = simulation.simulation();
        tasks::RunReport report;
        if (!complete) report.fault.kind = tasks::FaultKind::cancelled;
        report.fault.time = now.time();
        report.step_setting = scene.run.step;
        recorder.finish(now, report);
    }
};

}  // namespace

extern "C" {

cvtflow_code cvtflow_shutdown(void) {
    const api::FloatingDefaults defaults;
    return engine::end_worker_threads() ? CVTFLOW_OK : CVTFLOW_BUSY;
}

cvtflow_code cvtflow_record_begin(cvtflow_simulation* simulation, const char* path, int32_t replace, cvtflow_message* message) {
    const auto action = [&] {
        const api::HostSimulation::Scope scope(api::of(simulation), api::HostSimulation::Scope::As::visitor);
        simulation->recording = std::make_shared<Recording>(*simulation->simulation, &api::given(path, "path"), replace != 0);
    };
    return api::guarded(message, action, ErrorCode::record);
}

cvtflow_code cvtflow_record_finish(cvtflow_simulation* simulation, int32_t complete, cvtflow_message* message) {
    const auto action = [&] {
        const auto ending = std::exchange(api::given(simulation, "simulation").recording, nullptr);
        if (!ending) throw Error(ErrorCode::state, "the recording has ended");
        if (complete >= 0) static_cast<Recording&>(*ending).finish(complete != 0);
    };
    return api::guarded(message, action, ErrorCode::record);
}

cvtflow_code cvtflow_record_check(const char* path, cvtflow_message* message) {
    return api::guarded(
        message, [&] { engine::require_unchanged(&api::given(path, "path")); }, ErrorCode::record);
}

}  // extern "C"
