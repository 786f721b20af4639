#include "tasks/run/run_watch.hpp"

#include <algorithm>

#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

void RunWatch::add(const model::Observation& now, const Workspace& workspace) {
    if (!begun_) begin_ = now.time;
    begun_ = true;
    end_ = now.time;
    pin_period_ = workspace.pin_period();
    means_.add(now, workspace.energy.sums(now.time), pin_period_);
}

RunVerdict RunWatch::verdict(const EnergyLedger& ledger, double before) const {
    const EnergyBalance balance = ledger.balance();  // ends with the last sample, which lies elsewhere with other steps
    return {balance.relative(), std::max(before, ledger.suspicion()), ledger.sums(end_).lost(), pin_period_, end_ - begin_, means_.all()};
}

}  // namespace cvtflow::tasks
