/// The part of Simulation::Impl that reports whether results are reliable.

#include "api/simulation/simulation_impl.hpp"
#include "engine/thread/worker_threads.hpp"
#include "tasks/run/simulation.hpp"

namespace cvtflow {
inline namespace v0 {

std::vector<std::string> Simulation::Impl::notices() const {
    std::vector<std::string> lines = simulation_.start_differences();
    if (!energy().reliable) lines.push_back(tasks::unreliable_text(energy().suspicion, data().run.step, simulation_.step()));
    const engine::ThreadShortage threads = engine::thread_shortage();
    if (threads.requested > 0)
        lines.push_back("threads: available " + std::to_string(threads.had) + " of " + std::to_string(threads.requested));
    return lines;
}

Energy Simulation::Impl::energy() const noexcept {
    const tasks::EnergyBalance balance = simulation_.energy().balance();
    const double suspicion = simulation_.suspicion();
    return {balance.residual(), balance.loss, suspicion, suspicion <= 1.0};
}

}  // namespace v0
}  // namespace cvtflow
