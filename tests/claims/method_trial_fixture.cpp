#include "tests/claims/method_trial_fixture.hpp"

#include <chrono>
#include <cmath>

#include "bench/method/implicit/trapezoidal.hpp"
#include "bench/study/method_run.hpp"
#include "model/observe/observation.hpp"

namespace cvtflow::bench {

using namespace tasks;

TrialEnd try_method(const model::Parameters& parameters, const FrozenStart& start, const std::string& name, double step, double duration) {
    MethodRun run(parameters, name);
    SilentObserver silent;
    const engine::Cancellation never;
    const auto began = std::chrono::steady_clock::now();
    TrialEnd end;
    end.fault = run.run(start, duration, step, duration, silent, never);
    end.wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    end.counters = run.counters();
    end.step = run.step();
    end.report = run.method().report();
    if (const auto* trapezoidal = dynamic_cast<const TrapezoidalMethod*>(&run.method())) end.newton = trapezoidal->statistics();
    const Workspace& workspace = run.workspace();
    end.state.assign(workspace.state(), workspace.state() + workspace.layout().size());
    model::Observer observer(workspace.variator);
    const model::Observation& seen = observer.observe(run.time(), workspace.state(), workspace.tips.phases.data());
    end.axial_force = seen.tip_axial;
    end.tension = seen.tension;
    return end;
}

}  // namespace cvtflow::bench
