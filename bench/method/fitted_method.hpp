#pragma once
/// Stage methods of the laboratory that choose their polynomial by the spectrum: ladders of RKC, and polynomials fitted when needed.

#include <optional>

#include "bench/method/product_names.hpp"
#include "tasks/method/spectral_method.hpp"

namespace cvtflow::bench {

[[nodiscard]] Ladder rkc_ladder();

/// The polynomial of at most max_stages stages that is stable for this extent (step times spectrum); empty if there is none.
[[nodiscard]] std::optional<engine::StagePlan> fitted_plan(double real, double imaginary);
/// Extent of a first fit over the extent that the step needs.
inline constexpr double fit_headroom = 1.1;

/// Fits its polynomial to the spectrum (engine::fit), again when the spectrum or the step outgrows it or stays far below it.
/// A refit takes milliseconds and allocates memory: the only thing in the step loop that does.
class FittedChoice final : public SpectralChoice {
public:
    static constexpr int max_stages = 64;

    explicit FittedChoice(Workspace& workspace) : SpectralChoice(workspace) {}

    [[nodiscard]] int fits() const noexcept { return fits_; }
    void restart() noexcept override;
    void visit(engine::Archive& archive) override;

protected:
    /// h [s]
    /// @throws std::runtime_error if no polynomial of max_stages stages is stable for such a step
    [[nodiscard]] const engine::CompiledPlan& stable_plan(double h) override;
    [[nodiscard]] double longest(double requested) override;  ///< [s]

private:
    void refit(double real, double imaginary);  ///< real [1], imaginary [1]

    std::vector<engine::CompiledPlan> plan_;             ///< one, or none yet
    double fitted_real_ = 0.0, fitted_imaginary_ = 0.0;  ///< [1]
    double max_recent_extent_ = 0.0;                     ///< largest real extent requested since the last review
    int steps_since_review_ = 0;
    int fits_ = 0;
};

[[nodiscard]] std::unique_ptr<StepMethod> rkc_by_spectrum(Workspace& workspace);
[[nodiscard]] std::unique_ptr<StepMethod> fitted_by_spectrum(Workspace& workspace);

}  // namespace cvtflow::bench
