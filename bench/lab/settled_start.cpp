#include "bench/lab/settled_start.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "bench/study/run_watch.hpp"
#include "tasks/run/run.hpp"
#include "tasks/run/simulation.hpp"
#include "tools/program/guard.hpp"

namespace cvtflow::bench {

using namespace tools;

tasks::FrozenStart settled_start(const tasks::Scene& scene, bool settle, const std::string& what) {
    tasks::Simulation simulation(scene);
    if (simulation.needs_settling() && !settle) {
        throw tasks::SceneError(
            fmt::format("{}: the start is not settled, so {} are meaningless: add --settle, or a state file with "
                        "--set start.state=FILE (cvtflow settle)",
                        scene.name, what));
    }
    if (simulation.needs_settling()) {
        tasks::SilentObserver silent;
        const tasks::Fault fault = simulation.advance({.until = 0.0}, silent, catch_interrupts());
        if (fault) throw tasks::SettlingFault(fault);
    }
    return frozen_start(simulation);
}

long touching_tips(const tasks::FrozenStart& start) {
    return std::count_if(start.phases.begin(), start.phases.end(), [](model::Phase phase) { return phase != model::Phase::free; });
}

}  // namespace cvtflow::bench
