#pragma once
/// Stage methods that choose their stability polynomial by the spectrum, from a ladder of plans.

#include <memory>
#include <vector>

#include "tasks/method/spectral_bound.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

/// Keeps an estimate of the spectrum up to date: at the start, every tenth of a millisecond, after a rejected step.
class SpectralChoice : public PlanChoice {
public:
    /// Factors on the extents of the spectrum, because it is estimated from below and changes within a tenth of a millisecond.
    static constexpr double real_margin = 1.2, imaginary_margin = 1.15;  ///< [1]

    [[nodiscard]] const engine::CompiledPlan& choose(bool again) final;
    [[nodiscard]] double longest_step(double requested) final;  ///< [s]
    void restart() noexcept override;
    void visit(engine::Archive& archive) override;

protected:
    explicit SpectralChoice(Workspace& workspace) : w_(workspace), bound_(workspace.variator) {}

    /// A plan that is stable for a step of this length. h [s]
    [[nodiscard]] virtual const engine::CompiledPlan& stable_plan(double h) = 0;
    /// longest_step() while the estimate is up to date [s].
    [[nodiscard]] virtual double longest(double requested) = 0;

    [[nodiscard]] double real() const noexcept { return real_margin * bound_.real(); }
    [[nodiscard]] double imaginary() const noexcept { return imaginary_margin * bound_.imaginary(); }

private:
    void check_spectrum();

    Workspace& w_;
    SpectralBound bound_;
    double checked_ = -1e300;  ///< time of the last estimate [s]
};

/// A plan of a ladder and how far it is stable.
struct PolynomialRange {
    engine::CompiledPlan plan;
    double real;       ///< reach along the negative real axis
    double imaginary;  ///< reach along the ray of damping ratio 1 %
};

/// Ascending.
using Ladder = std::vector<PolynomialRange>;
[[nodiscard]] Ladder dumka3_ladder();
/// The first polynomial whose reach along the real axis is at least `real`, or the last one. real [1]
[[nodiscard]] std::size_t table_for(const Ladder& ladder, double real) noexcept;

/// The first polynomial that is stable on the real axis; where steps are free, also the rule of DUMKA3: the one before it with a shorter
/// step if that is cheaper per time. A free step is also kept within the imaginary reach, which the published rule ignores. Source of the
/// rule: A. A. Medovikov's program; High order explicit methods for parabolic equations, BIT 38 (1998) 372-390.
class LadderChoice final : public SpectralChoice {
public:
    LadderChoice(Workspace& workspace, Ladder tables) : SpectralChoice(workspace), tables_(std::move(tables)) {}

protected:
    [[nodiscard]] const engine::CompiledPlan& stable_plan(double h) override;  ///< h [s]
    [[nodiscard]] double longest(double requested) override;                   ///< [s]

private:
    Ladder tables_;
};

[[nodiscard]] std::unique_ptr<StepMethod> by_ladder(Workspace& workspace, int error_power, Ladder tables);
[[nodiscard]] std::unique_ptr<StepMethod> dumka3_by_spectrum(Workspace& workspace);

}  // namespace cvtflow::tasks
