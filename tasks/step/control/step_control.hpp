#pragma once
/// How long a step is: fixed, or so long that its estimated local error meets a tolerance.

#include <array>
#include <cstddef>
#include <span>

namespace cvtflow::tasks {

enum class StepControl {
    fixed,   ///< run.step, whatever the error
    report,  ///< run.step, and the local error is estimated and reported
    error,   ///< up to run.step, so that the local error stays below the tolerance
};

/// What counts as an error of 1: coordinates (elastic deformations are micrometres) and velocities (friction saturates at some mm/s).
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

    /// How long the next step should be [s].
    [[nodiscard]] double proposal() const noexcept { return proposal_; }
    /// Whether a step of length `step` with this error, in units of the tolerance, is good enough. An error that is no number never is.
    /// error [1], step [s]
    [[nodiscard]] bool judge(double error, double step) noexcept;

    /// What it remembers, for checkpoints.
    static constexpr std::size_t memory_size = 3;
    [[nodiscard]] std::array<double, memory_size> save() const noexcept { return {proposal_, previous_, rejected_ ? 1.0 : 0.0}; }
    /// memory [what save() wrote]
    void load(std::span<const double> memory) noexcept {
        proposal_ = memory[0];
        previous_ = memory[1];
        rejected_ = memory[2] != 0.0;
    }

private:
    double longest_ = 0.0;  ///< [s]
    int power_ = 1;
    double proposal_ = 0.0;  ///< [s]
    double previous_ = 1.0;  ///< error of the last accepted step [1]
    bool rejected_ = false;  ///< the last step was
};

}  // namespace cvtflow::tasks
