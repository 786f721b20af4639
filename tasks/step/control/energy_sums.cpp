#include <algorithm>
#include <limits>
#include <numeric>

#include "tasks/step/control/energy_ledger.hpp"

namespace cvtflow::tasks {

double EnergySums::lost() const noexcept { return std::accumulate(loss.begin(), loss.end(), 0.0); }

EnergySums EnergySums::between(const EnergySums& from, const EnergySums& to, double time) noexcept {
    const double share = (time - from.time) / (to.time - from.time);
    EnergySums at = from;
    at.time = time;
    for (std::size_t k = 0; k < at.loss.size(); ++k) at.loss[k] += share * (to.loss[k] - from.loss[k]);
    for (std::size_t k = 0; k < at.work.size(); ++k) at.work[k] += share * (to.work[k] - from.work[k]);
    return at;
}

double EnergySums::efficiency_since(const EnergySums& before) const noexcept {
    double input = 0.0;
    for (std::size_t k = 0; k < work.size(); ++k) input += std::max(0.0, work[k] - before.work[k]);
    return input > 0.0 ? 1.0 - (lost() - before.lost()) / input : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace cvtflow::tasks
