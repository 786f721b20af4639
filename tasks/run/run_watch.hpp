#pragma once
/// Whether the figures of a run are reliable: its energy balance, and its length.

#include <string>

#include "tasks/run/run_means.hpp"
#include "tasks/step/fault.hpp"

namespace cvtflow::tasks {

class Workspace;

/// Pin periods that means of slip and efficiency need. Mean slip over 16 of them is within 1.2 % of that over 20 ms, over 8 within 4 %,
/// over one within 12 % (baseline, control, low, overdrive).
inline constexpr double enough_pin_periods = 16.0;

struct RunVerdict {
    double residual = 0.0;    ///< of the energy balance over the losses [1]
    double suspicion = 0.0;   ///< EnergyLedger::suspicion(), of what came before the run as well; above 1 the results are wrong [1]
    double loss = 0.0;        ///< dissipated up to the last output [J]
    double pin_period = 0.0;  ///< at the end; 0: nothing passes a pulley [s]
    double duration = 0.0;    ///< between the first and the last output [s]
    SpanMeans means;          ///< over all outputs

    [[nodiscard]] bool reliable() const noexcept { return suspicion <= 1.0; }
    [[nodiscard]] double pin_periods() const noexcept { return pin_period > 0.0 ? duration / pin_period : 0.0; }
    /// Whether slip and efficiency are means over enough of them.
    [[nodiscard]] bool long_enough() const noexcept { return pin_period == 0.0 || pin_periods() >= enough_pin_periods; }
    /// "finished", "unreliable" or the fault's name.
    [[nodiscard]] std::string status(const Fault& fault) const { return fault ? fault.name() : reliable() ? "finished" : "unreliable"; }
};

/// Gathers it at outputs.
class RunWatch {
public:
    /// An output, the first one included.
    void add(const model::Observation& now, const Workspace& workspace);
    /// @param ledger of the run   @param before suspicion of what it began with; before [1]
    [[nodiscard]] RunVerdict verdict(const EnergyLedger& ledger, double before = 0.0) const;
    /// Whether add() is needed at this time, between outputs. time [s]
    [[nodiscard]] bool due(double time) const noexcept { return begun_ && means_.due(time); }
    [[nodiscard]] const RunMeans& means() const noexcept { return means_; }

private:
    RunMeans means_;
    double begin_ = 0.0, end_ = 0.0, pin_period_ = 0.0;  ///< [s]
    bool begun_ = false;
};

}  // namespace cvtflow::tasks
