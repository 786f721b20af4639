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

double EnergySums::efficiency_since(const EnergySums& before, double further_work, double further_loss) const noexcept {
    double input = further_work;
    for (const model::Work by : {model::Work::drive, model::Work::load}) {
        const auto k = static_cast<std::size_t>(by);
        input += std::max(0.0, work[k] - before.work[k]);
    }
    return input > 0.0 ? 1.0 - (lost() - before.lost() + further_loss) / input : std::numeric_limits<double>::quiet_NaN();
}

EnergySums EnergyLedger::sums_before(double time) const noexcept {
    const double first = period_begin(time), start = time - m_.pin_period;
    const EnergySums& before = past(first);
    const bool inside = first + 1.0 < outputs_before(time) && before.time < start;
    return inside ? EnergySums::between(before, past(first + 1.0), start) : before;
}

double EnergyLedger::efficiency(double time) const noexcept {
    if (outputs_before(time) == 0.0) return std::numeric_limits<double>::quiet_NaN();
    return sums(time).efficiency_since(sums_before(time));
}

double EnergyLedger::efficiency(double time, const FurtherPowers& further) const noexcept {
    if (outputs_before(time) == 0.0) return std::numeric_limits<double>::quiet_NaN();
    const EnergySums before = sums_before(time);
    const double lasted = time - before.time;
    return sums(time).efficiency_since(before, further.input * lasted, further.lost * lasted);
}

}  // namespace cvtflow::tasks
