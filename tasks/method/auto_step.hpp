#pragma once
/// `run.step = "auto"`: the longest step within the method's stability at the present state, with a margin, and within the error that the
/// default promises.

#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "tasks/method/falling_friction.hpp"
#include "tasks/method/method.hpp"
#include "tasks/method/spectral_bound.hpp"
#include "tasks/step/control/step_control.hpp"

namespace cvtflow::tasks {

/// How far a method is stable, by its own test equation.
struct MethodReach {
    double oscillation;  ///< largest h ω of an elastic oscillation, whatever the friction beside it [1]
    double decay;        ///< largest h |λ| of friction and damping [1]
    double accurate;     ///< largest h ω that it does not damp much more than the chain does itself [1]
    /// Of methods that take friction apart, without any: h ω without damping, and h δ of a damping δ without oscillation. [1]
    double frictionless = std::numeric_limits<double>::infinity(), damping = std::numeric_limits<double>::infinity();
};

/// Of any method of the catalogue; computed once per name. Infinite where linear stability sets no limit, or where the method
/// sees to it by itself (methods that choose among polynomials).
[[nodiscard]] MethodReach reach_of(const Method& method);

/// The longest step that is ever chosen for a method where steps are automatic: what the error of its friction allows (decisions 75, 96)
/// [s].
[[nodiscard]] double longest_automatic_step(const Method& method, const model::Parameters& parameters);

class AutoStep final : public StepChoice {
public:
    /// Share of the stable step that is taken. The spectrum is estimated from below, to some per cent, and changes between two estimates;
    /// friction beside an oscillation is not the worst one. DECISIONS 75 has what was measured.
    static constexpr double margin = 0.85;
    /// The same where friction takes no stability away: the limit is that of the whole linearised step to half a per cent, and what is left
    /// is that of the spectrum.
    static constexpr double sharp_margin = 0.9;
    /// Time between two estimates of the spectrum [s]; shorter at the start, when tips reach the sheaves and loads rise:
    /// whenever the time since the beginning has doubled.
    static constexpr double look_interval = 1e-3;

    /// `variator`, that of `parameters` or of the same machine, must outlive it. Takes all its memory here.
    AutoStep(const model::Variator& variator, const model::Parameters& parameters, const Method& method);

    [[nodiscard]] double longest() const noexcept override { return longest_; }
    void restart() noexcept override;
    /// Estimates the spectrum if the last estimate is too old. time [s], state [unknowns]
    [[nodiscard]] double longest(double time, const double* state, const model::Phase* phases) noexcept override;

    /// Largest stable step as last estimated [s]; infinite: no limit.
    [[nodiscard]] double stable_step() const noexcept { return stable_; }
    /// Evaluations of the right-hand side that looking has taken.
    [[nodiscard]] long evaluations() const noexcept { return evaluations_; }
    [[nodiscard]] const SpectralBound& bound() const noexcept { return bound_; }

    void save(std::vector<double>& memory) const override;
    void load(std::span<const double> memory) override;  ///< memory [what save() wrote]

private:
    /// Of the leapfrog of rigid pins: the row of links sets its limit, which hardly moves; in that of tables friction counts [s].
    static constexpr double rigid_look_interval = 20e-3;

    [[nodiscard]] double damped_step(double time, const double* state, const model::Phase* phases) noexcept;

    MethodReach reach_;
    double longest_;         ///< of all steps [s]
    double interval_;        ///< between two looks, in the long run [s]
    bool keeps_directions_;  ///< damped_parts_ begin with the directions of the last look: of rigid pins
    SpectralBound bound_;
    std::unique_ptr<const model::Variator> frictionless_;      ///< the machine without friction, where damping has a limit of its own
    bool friction_matters_ = true;                             ///< for the stability of oscillations with damping
    std::vector<SpectralBound> damped_parts_;                  ///< of it
    double damped_ = std::numeric_limits<double>::infinity();  ///< longest stable step without friction [s]
    std::unique_ptr<FallingFriction> falling_;                 ///< of machines whose friction depends on the sliding speed
    double growth_ = 0.0;                                      ///< of sliding, as found [1/s]
    const model::Variator& variator_;
    model::Chain chain_;
    double pin_period_ = 0.0;                  ///< as found; 0: sets no limit [s]
    double looked_ = -1e300, begun_ = -1e300;  ///< when [s]
    double damped_at_ = -1e300;                ///< when damped_ was found [s]
    double stable_ = 0.0;                      ///< the longest stable step found [s]
    long evaluations_ = 0;
};

}  // namespace cvtflow::tasks
