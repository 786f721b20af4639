#pragma once
/// An integrator, assembled once: the memory of the step loop, the method, the graph of its tasks and the executor.

#include <memory>
#include <string_view>
#include <vector>

#include "tasks/method/method.hpp"
#include "tasks/schedule/schedule_runner.hpp"
#include "tasks/step/integration_state.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

class Integrator {
public:
    /// @param method a name of the catalogue, or "auto": resolved here, once   @param candidates as for ScheduleRunner, the first one's
    /// segments to begin with
    /// @throws MethodRefused, and std::invalid_argument as the executors' make
    Integrator(const model::Parameters& parameters, std::string_view method, const std::vector<Schedule>& candidates = {Schedule{}},
               const ChooserOptions& options = {}, engine::StampRecorder* recorder = nullptr);
    Integrator(const Integrator&) = delete;
    Integrator& operator=(const Integrator&) = delete;

    [[nodiscard]] Workspace& workspace() noexcept { return workspace_; }
    [[nodiscard]] const Workspace& workspace() const noexcept { return workspace_; }
    [[nodiscard]] StepMethod& method() noexcept { return *method_; }
    [[nodiscard]] const StepMethod& method() const noexcept { return *method_; }
    /// The method in use, from the catalogue, never "auto".
    [[nodiscard]] const Method& chosen_method() const noexcept { return chosen_; }
    [[nodiscard]] const ScheduleRunner& runner() const noexcept { return runner_; }

    /// The next integration begins there, and the method has no past. The controller is to be made afterwards.
    void begin_at(const FrozenStart& start);
    /// Runs until the controller stops. The controller is one of this workspace and method.
    void run(StepController& controller) { runner_.run(controller); }
    /// Replaces the parameters by others, with which the state vector has the same layout; between two integrations.
    void adopt(const model::Parameters& parameters);

private:
    Method chosen_;
    Workspace workspace_;
    std::unique_ptr<StepMethod> method_;
    ScheduleRunner runner_;
};

}  // namespace cvtflow::tasks
