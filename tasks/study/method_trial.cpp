#include "tasks/study/method_trial.hpp"

#include <chrono>
#include <cmath>

#include "model/observe/observation.hpp"
#include "tasks/method/implicit/trapezoidal.hpp"
#include "tasks/method/method_choice.hpp"

namespace cvtflow::tasks {

TrialEnd try_method(const model::Parameters& parameters, const FrozenStart& start, const std::string& name, double step, double duration) {
    const auto plan = plan_for(name);
    if (!plan) throw std::invalid_argument("there is no method '" + name + "' (cvtflow list methods)");
    Workspace workspace(parameters, *plan, Partition::equal(parameters.chain.pins, 1));
    std::copy(start.state.begin(), start.state.end(), workspace.states[0]);
    workspace.phases = start.phases;
    const std::unique_ptr<StepMethod> method = make_step_method(name, workspace);
    workspace.method = method.get();
    const engine::TaskGraph graph = step_graph(workspace, {});
    SilentObserver nobody;
    const engine::Cancellation never;
    StepController controller(workspace, *method, {start.time, start.time + duration, step, duration, 0, 0.0}, nobody, never);
    const auto began = std::chrono::steady_clock::now();
    make_executor(Schedule{})->run(graph, &workspace, controller);
    TrialEnd end;
    end.wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    end.fault = controller.fault();
    end.counters = controller.counters();
    end.step = controller.step();
    end.report = method->report();
    if (const auto* trapezoidal = dynamic_cast<const TrapezoidalMethod*>(method.get())) end.newton = trapezoidal->statistics();
    end.state.assign(workspace.states[0], workspace.states[0] + workspace.layout().size());
    model::Observer observer(workspace.variator);
    const model::Observation& seen = observer.observe(controller.time(), workspace.states[0], workspace.phases.data());
    end.axial_force = seen.tip_axial;
    end.tension = seen.tension;
    return end;
}

double relative_difference(const std::vector<double>& values, const std::vector<double>& reference) noexcept {
    double error = 0.0, size = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        error += (values[i] - reference[i]) * (values[i] - reference[i]);
        size += reference[i] * reference[i];
    }
    return size > 0.0 ? std::sqrt(error / size) : 0.0;
}

}  // namespace cvtflow::tasks
