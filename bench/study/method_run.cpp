#include "bench/study/method_run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "tasks/method/method.hpp"

namespace cvtflow::bench {

using namespace tasks;

MethodRun::MethodRun(const model::Parameters& parameters, const std::string& method, const Schedule& schedule)
    : integrator_(parameters, method, {schedule}) {}

MethodRun::~MethodRun() = default;

Fault MethodRun::run(const FrozenStart& start, double duration, double step, double output_interval, RunObserver& observer,
                     const engine::Cancellation& cancel) {
    Workspace& workspace = integrator_.workspace();
    integrator_.begin_at(start);
    if (step == 0.0 && choice_ == nullptr)
        choice_ = std::make_unique<AutoStep>(workspace.variator, workspace.parameters, integrator_.chosen_method());
    StepSettings settings{start.time, start.time + duration, step, output_interval, 0, 0.0};
    if (step == 0.0) settings.choice = choice_.get();
    StepController controller(workspace, integrator_.method(), settings, observer, cancel);
    integrator_.run(controller);
    counters_ = controller.counters();
    step_ = controller.step();
    controller.rethrow();
    return controller.fault();
}

namespace {

/// The state a step later; nothing if a transition came in between or the step failed.
std::vector<double> one_step(MethodRun& method, const FrozenStart& start, double h, long steps) {
    SilentObserver silent;
    const engine::Cancellation never;
    const Fault fault = method.run(start, h, h / static_cast<double>(steps), h, silent, never);
    if (fault || method.counters().detected > 0) return {};
    const double* state = method.workspace().state();
    return {state, state + start.state.size()};
}

}  // namespace

std::vector<LocalError> local_errors(const model::Parameters& parameters, const std::string& method, const FrozenStart& start,
                                     std::span<const double> steps) {
    const model::Variator variator(parameters);
    if (const Method found(method); found.program() == nullptr) return local_errors(variator, found.plan(), start, steps);
    MethodRun coarse(parameters, method), fine(parameters, "rk4");
    std::vector<LocalError> errors;
    for (const double h : steps) {
        const std::vector<double> is = one_step(coarse, start, h, 1), should = one_step(fine, start, h, reference_steps(h, 32));
        constexpr double none = std::numeric_limits<double>::quiet_NaN();
        errors.push_back(is.empty() || should.empty() ? LocalError{h, none, none, none, none} : error_of(variator, start, h, is, should));
    }
    return errors;
}

}  // namespace cvtflow::bench
