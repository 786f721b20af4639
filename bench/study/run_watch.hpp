#pragma once
/// Means of a run, whether they are reliable, and the state that one begins with.

#include <string>

#include "tasks/run/run_means.hpp"
#include "tasks/run/simulation.hpp"

namespace cvtflow::bench {

/// Pin periods that means of slip and efficiency need. Mean slip over 16 of them is within 1.2 % of that over 20 ms, over 8 within 4 %,
/// over one within 12 % (baseline, control, low, overdrive).
inline constexpr double enough_pin_periods = 16.0;

struct WatchResult {
    double residual = 0.0;             ///< residual of the energy balance over the losses
    double balance_error_ratio = 0.0;  ///< EnergyLedger::balance_error_ratio(), the time before the run included; above 1: wrong results
    double loss = 0.0;                 ///< dissipated up to the last output [J]
    double pin_period = 0.0;           ///< pin period at the end; 0: nothing passes a pulley [s]
    double duration = 0.0;             ///< time between the first and the last output [s]
    tasks::SpanMeans means;            ///< means over all outputs

    [[nodiscard]] bool reliable() const noexcept { return balance_error_ratio <= 1.0; }
    [[nodiscard]] double pin_periods() const noexcept { return pin_period > 0.0 ? duration / pin_period : 0.0; }
    /// Whether slip and efficiency are means over enough pin periods.
    [[nodiscard]] bool long_enough() const noexcept { return pin_period == 0.0 || pin_periods() >= enough_pin_periods; }
    /// "finished", "unreliable" or the fault's name.
    [[nodiscard]] std::string status(const tasks::Fault& fault) const {
        return fault ? fault.name() : reliable() ? "finished" : "unreliable";
    }
};

/// Gathers a WatchResult at outputs.
class RunWatch {
public:
    /// An output, the first one included.
    void add(const model::Observation& now, const tasks::Workspace& workspace);
    /// @param ledger of the run   @param before balance_error_ratio of its start state [1]
    [[nodiscard]] WatchResult result(const tasks::EnergyLedger& ledger, double before = 0.0) const;

private:
    tasks::RunMeans means_;
};

/// The simulation's present state, with the phases that a run would begin with.
[[nodiscard]] tasks::FrozenStart frozen_start(const tasks::Simulation& simulation);

}  // namespace cvtflow::bench
