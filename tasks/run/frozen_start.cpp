#include "tasks/step/integration_state.hpp"

#include <algorithm>

#include "engine/executor/cancellation.hpp"
#include "engine/method/catalogue.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/step/control/step_controller.hpp"

namespace cvtflow::tasks {

FrozenStart frozen_start(const Simulation& simulation) {
    const Workspace& at = simulation.workspace();
    const std::size_t size = static_cast<std::size_t>(at.layout().size());
    Workspace probed(at.parameters, *engine::find_method("rk4"), Partition::equal(at.layout().links, 1));
    std::copy_n(simulation.state(), size, probed.states[0]);
    probed.tips.phases = simulation.phases();
    SilentObserver nobody;
    const engine::Cancellation never;
    StepController controller(probed, StepSettings{}, nobody, never);  // probes the start
    return {simulation.time(), {probed.states[0], probed.states[0] + size}, probed.tips.phases, simulation.suspicion()};
}

}  // namespace cvtflow::tasks
