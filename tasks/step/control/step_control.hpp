#pragma once
/// Length of a step: fixed, chosen by an AutoStep, or so long that its estimated local error meets a tolerance; and the end of a run.

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "engine/base/archive.hpp"
#include "model/parameters/chain_layout.hpp"

namespace cvtflow::tasks {

enum class StepControl {
    fixed,   ///< run.step, whatever the error
    report,  ///< run.step, and the local error is estimated and reported
    error,   ///< steps up to run.step, so that the local error stays below the tolerance
};

/// Size of an error of 1: coordinates (elastic deformations are micrometres) and velocities (friction saturates at some mm/s).
struct ErrorScale {
    double coordinate = 1e-6;  ///< [m]
    double velocity = 1e-3;    ///< [m/s], the tips' saturation speed

    /// Root mean square of the errors of `size` coordinates and their velocities, [e_q | e_v], in these units.
    [[nodiscard]] double norm(const double* errors, int size) const noexcept;
};

/// Lengths of steps from errors of steps: proportional and integral control.
/// Source: Gustafsson, Control theoretic techniques for stepsize selection in explicit Runge-Kutta methods, ACM TOMS 17 (1991) 533-554.
class StepSizeControl {
public:
    StepSizeControl() = default;
    /// @param longest first and longest step [s]   @param power the estimate falls like step^power, ≥ 1
    StepSizeControl(double longest, int power) noexcept : longest_(longest), power_(power), proposal_(longest) {}

    /// Proposed length of the next step [s].
    [[nodiscard]] double proposal() const noexcept { return proposal_; }
    /// Whether a step of length `step` with this error, in units of the tolerance, is good enough. An error that is no number never is.
    /// error [1], step [s]
    [[nodiscard]] bool judge(double error, double step) noexcept;

    void visit(engine::Archive& archive) {
        archive("proposed_step", proposal_), archive("error_before", previous_), archive("rejected_step", rejected_);
    }

private:
    double longest_ = 0.0;  ///< [s]
    int power_ = 1;
    double proposal_ = 0.0;  ///< [s]
    double previous_ = 1.0;  ///< error of the last accepted step [1]
    bool rejected_ = false;  ///< the last step was
};

/// Chooses the length of automatic steps; implemented by AutoStep.
class StepChoice {
public:
    /// Longest time between two questions [s].
    static constexpr double ask_interval = 125e-6;

    virtual ~StepChoice() = default;
    /// Longest step that is ever chosen [s]: the step grid starts from it.
    [[nodiscard]] virtual double longest() const noexcept = 0;
    /// Whether longest() reads the state at a time [s].
    [[nodiscard]] virtual bool reads_state(double /*time*/) const noexcept { return true; }
    /// Longest step at a state [s]. @param time [s] @param state [layout.size()], any where it is not read @param phases [4 links]
    [[nodiscard]] virtual double longest(double time, const double* state, const model::Phase* phases) noexcept = 0;
    /// Share of that step to take where the energy balance has used up this much of its tolerance (EnergyLedger::balance_error_ratio).
    [[nodiscard]] virtual double caution(double balance_error_ratio) const noexcept = 0;
    /// A new integration begins.
    virtual void restart() noexcept = 0;
    /// All that a state has to keep.
    virtual void visit(engine::Archive& archive) = 0;

protected:
    StepChoice() = default;
    StepChoice(const StepChoice&) = default;
    StepChoice& operator=(const StepChoice&) = default;
};

/// Settings for the length of steps and the end of a run.
struct StepSettings {
    double begin = 0.0;  ///< [s]
    double until = 0.0;  ///< [s]
    double step = 5e-8;  ///< longest step [s]; a fixed step divides the output interval. 0: automatic, and `choice` must be there
    double output_interval = 1e-5;  ///< [s]
    long max_steps = 0;             ///< 0: no budget
    double max_wall = 0.0;          ///< [s], 0: no budget
    StepControl control = StepControl::fixed;
    double tolerance = 1.0;        ///< tolerance of local errors, in units of ErrorScale
    StepChoice* choice = nullptr;  ///< chooser of automatic steps; outlives the controller
    const bool* pause = nullptr;   ///< if true (set by an observer), the run ends before the next step as if cancelled

    [[nodiscard]] bool automatic() const noexcept { return choice != nullptr && step == 0.0; }
};

/// Local errors of accepted steps, in units of ErrorScale; only with StepControl::report and error.
struct LocalErrorStatistics {
    long steps = 0;
    double largest = 0.0;  ///< [1]
    double sum = 0.0;      ///< [1]

    [[nodiscard]] double mean() const noexcept { return steps > 0 ? sum / static_cast<double>(steps) : 0.0; }
};

}  // namespace cvtflow::tasks
