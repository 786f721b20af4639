#include "bench/study/run_watch.hpp"

#include <algorithm>

#include "engine/executor/cancellation.hpp"
#include "engine/method/catalogue.hpp"
#include "tasks/step/workspace.hpp"

namespace cvtflow::bench {

using namespace tasks;

void RunWatch::add(const model::Observation& now, const Workspace& workspace) {
    means_.add(now, workspace.energy.sums(now.time), workspace.pin_period());
}

WatchResult RunWatch::result(const EnergyLedger& ledger, double before) const {
    const EnergyBalance balance = ledger.balance();  // ends with the last sample, which lies elsewhere with other steps
    const MeanCurve& curve = means_.curve();
    const double begin = curve.empty() ? 0.0 : curve.first().time, end = curve.last().time;
    return {balance.relative(), std::max(before, ledger.balance_error_ratio()), ledger.sums(end).lost(), curve.pin_period(), end - begin,
            means_.all()};
}

FrozenStart frozen_start(const Simulation& simulation) {
    const Workspace& at = simulation.workspace();
    const std::size_t size = static_cast<std::size_t>(at.layout().size());
    Workspace probed(at.parameters, *engine::find_method("rk4"), Partition::equal(at.layout().links, 1));
    std::copy_n(at.state(), size, probed.state_to_set());
    probed.tips.phases = at.tips.phases;
    SilentObserver silent;
    const engine::Cancellation never;
    StageMethod method(probed);
    StepController controller(probed, method, StepSettings{}, silent, never);  // probes the start
    return {simulation.time(), {probed.state_to_set(), probed.state_to_set() + size}, probed.tips.phases, simulation.balance_error_ratio()};
}

}  // namespace cvtflow::bench
