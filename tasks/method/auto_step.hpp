#pragma once
/// `run.step = "auto"`: the longest step within the method's stability at the present state, with a margin, and within the error that the
/// default promises.

#include <array>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "model/observe/observation.hpp"
#include "tasks/method/method.hpp"
#include "tasks/method/spectral_bound.hpp"
#include "tasks/step/control/step_control.hpp"

namespace cvtflow::tasks {

/// A pin half that slides at both tips, with normal forces N, obeys m u' = -2 N μ(u) + …: where μ falls, sliding grows with the rate
/// g = 2 N |μ'|/m, or s where friction has a memory: s² + a s = a g, a = (|u| + v0)/L. A step of first order h errs in the growth, and so
/// in losses, in proportion to h g.
class NegativeSlopeFriction {
public:
    /// `variator` must outlive it. Takes all its memory here.
    NegativeSlopeFriction(const model::Variator& variator, const model::Parameters& parameters);

    /// Largest growth rate of all tips at a state, at the sliding speed where friction falls most steeply; 0: it does not fall [1/s].
    /// t [s], state [unknowns]
    [[nodiscard]] double growth(double t, const double* state, const model::Phase* phases) noexcept;

private:
    /// Largest growth over all sliding speeds from the saturation speed on, at the present temperature of the oil [1/s]. force of a tip [N]
    [[nodiscard]] double fastest_growth(double force) const noexcept;
    /// Growth with the law's memory, given that without. at_once [1/s], speed [m/s]
    [[nodiscard]] double with_memory(double at_once, double speed) const noexcept;

    const model::Variator& variator_;
    double half_mass_;  ///< [kg]
    model::Observer observer_;
};

/// The longest step that is ever chosen for a method where steps are automatic: what the error of its friction allows (decisions 75, 96)
/// [s].
[[nodiscard]] double longest_automatic_step(const Method& method, const model::Parameters& parameters);

/// Reason why a step cannot be longer.
enum class StepLimiter {
    nothing,      ///< linear stability sets no limit
    oscillation,  ///< stability at the fastest one
    decay,        ///< stability at the fastest one: friction, damping
    damping,      ///< stability of an oscillation with its damping, which the method takes explicitly
    error,        ///< a longer one would be stable, and its friction not accurate
    accuracy,     ///< the method would damp the fastest oscillation much more than the chain does
    growth,       ///< sliding grows, where friction falls with the sliding speed
};

/// The largest step of a method at a state with which small disturbances die out and are right: within its linear stability by the margin
/// of AutoStep, for contacts as they are at rest, and within its accuracy. Results of a larger step are not reliable; with a smaller one
/// the error of friction may still be too large.
struct LargestStep {
    double step = std::numeric_limits<double>::infinity();  ///< [s]
    StepLimiter by = StepLimiter::nothing;
    double rate = 0.0;  ///< frequency [rad/s], with damping an upper bound, or rate [1/s] of the limiter
};
/// "1.62 us (oscillation of 120 kHz)", "linear stability sets no limit".
[[nodiscard]] std::string text_of(const LargestStep& limit);

class AutoStep final : public StepChoice {
public:
    /// Share of the stable step that is taken. The spectrum is estimated from below, to some per cent, and changes between two estimates;
    /// the margin covers both. Measurements: DECISIONS 75.
    static constexpr double margin = 0.85;
    /// Share if friction does not reduce stability: the limit is that of the whole linearised step to half a per cent, and the rest covers
    /// the spectrum.
    static constexpr double sharp_margin = 0.9;
    /// Time between two estimates of the spectrum [s]; shorter at the start, when tips reach the sheaves and loads rise:
    /// whenever the time since the beginning has doubled.
    static constexpr double check_interval = 1e-3;

    /// `variator`, that of `parameters` or of the same machine, must outlive it. Takes all its memory here.
    AutoStep(const model::Variator& variator, const model::Parameters& parameters, const Method& method);

    [[nodiscard]] double longest() const noexcept override { return longest_; }
    void restart() noexcept override;
    [[nodiscard]] bool reads_state(double time) const noexcept override;
    /// Estimates the spectrum if the last estimate is too old: of pin halves at once, of rigid pins, a millisecond after the beginning and
    /// later, an iteration at a time, so that no call of a host takes much longer than others. time [s], state [unknowns]
    [[nodiscard]] double longest(double time, const double* state, const model::Phase* phases) noexcept override;
    /// Two thirds of a step with filtered waves, from then on, once the balance has used up 0.7 of its tolerance: its residual
    /// grows with the step and with the clamping.
    [[nodiscard]] double caution(double balance_error_ratio) const noexcept override {
        return filter_ > 0.0 && balance_error_ratio > 0.7 ? 2.0 / 3.0 : 1.0;
    }

    /// Limit by the last estimate.
    [[nodiscard]] LargestStep largest() const noexcept;
    /// Step of largest(); infinite: no limit [s].
    [[nodiscard]] double stable_step() const noexcept { return largest().step; }
    /// Right-hand-side evaluations used by the estimates.
    [[nodiscard]] long evaluations() const noexcept { return evaluations_; }

    void visit(engine::Archive& archive) override;

private:
    /// check_interval of the leapfrog of rigid pins, and time between two estimates where clamping has not risen in between: the row of
    /// links sets its limit, which hardly changes; that of tables depends on friction [s].
    static constexpr double rigid_check_interval = 20e-3, rigid_estimate_interval = 100e-3;

    /// Time after a rise of the clamping until damping is estimated again, and whenever it has doubled [s].
    static constexpr double soonest_after_rise = 0.25e-3;

    /// Time after the beginning or a rise after which filtered waves, which are the links' own, keep their limit, once loads are full [s].
    static constexpr double waves_change = 1.2e-3;

    /// An iteration of two evaluations in every such time [s]: 4 of 35 steps of 7.1 us. The 15 of an estimate are complete within 4 ms.
    static constexpr double turn_interval = 250e-6;
    static constexpr int turn_evaluations = 2;
    static constexpr int no_part = -1;

    /// Longest step with which the waves of a part are filtered far enough; 0: the filter does not lengthen its steps [s].
    [[nodiscard]] double filtered_limit(const SpectralBound& part) const noexcept;
    /// Longest stable step of a part of the machine without friction [s].
    [[nodiscard]] double limit_of(const SpectralBound& part) const noexcept;
    /// Finds it for sweeps, by trial: part.step(). time [s], state [unknowns]
    void find_limit(SpectralBound& part, double time, const double* state, const model::Phase* phases) noexcept;
    /// The one of damped_parts_, which must not be empty, with the shortest limit.
    [[nodiscard]] const SpectralBound& most_limiting() const noexcept;
    /// Whether a clamping force has risen by a fifth since damped_with_: contacts damp in proportion. time [s], state [unknowns]
    [[nodiscard]] bool clamping_has_risen(double time, const double* state) const noexcept;
    [[nodiscard]] std::array<double, 2> clamping(double time, const double* state) const noexcept;
    [[nodiscard]] bool spreads(double time) const noexcept;  ///< an estimate is continued from turn to turn: of rigid pins, once they run
    [[nodiscard]] bool check_is_due(double time) const noexcept;  ///< pins' period is to be renewed, and perhaps the estimate
    [[nodiscard]] bool turn_is_due(double time) const noexcept;   ///< the present estimate is to be continued
    /// Continues the present estimate. time [s], state [unknowns]   @param budget evaluations
    void estimate(double time, const double* state, const model::Phase* phases, int budget) noexcept;

    MethodReach reach_;
    double longest_;                                ///< maximum of all steps [s]
    double interval_;                               ///< time between two estimates, in the long run [s]
    bool reuses_eigenvectors_;                      ///< damped_parts_ begin with the directions of the last estimate: rigid pins
    std::shared_ptr<const model::HeldLinks> held_;  ///< nullptr: steps hold no links
    double filter_;                                 ///< β of the method's filter of waves along the chain; 0: it has none
    std::shared_ptr<SpectralMemory> memory_;        ///< memory that all bounds share
    SpectralBound bound_;
    std::unique_ptr<const model::Variator> frictionless_;      ///< machine without friction, where damping has another limit
    bool friction_matters_ = true;                             ///< friction reduces the stability of oscillations with damping
    std::vector<SpectralBound> damped_parts_;                  ///< bounds of `frictionless_`; of filtered waves last
    double damped_ = std::numeric_limits<double>::infinity();  ///< longest stable step without friction [s]
    std::unique_ptr<NegativeSlopeFriction> friction_growth_;   ///< nullptr where friction does not depend on the sliding speed
    double growth_ = 0.0;                                      ///< largest growth of sliding at the last estimate [1/s]
    const model::Variator& variator_;
    model::Chain chain_;
    model::Start start_;
    double pin_period_ = 0.0;                   ///< period at the last estimate; 0: sets no limit [s]
    double checked_ = -1e300, begun_ = -1e300;  ///< times of the last estimate, and of the first one or of a rise [s]
    double estimated_ = -1e300;                 ///< time at which the last estimate began [s]
    double damped_at_ = -1e300;                 ///< time of the estimate of damped_ [s]
    std::array<double, 2> damped_with_{};       ///< clamping forces there [N]
    double soonest_ = check_interval;           ///< from begun_ to the second estimate of damped_ [s]
    double stable_ = 0.0;                       ///< longest stable step of the last estimate [s]
    double turned_ = -1e300;                    ///< time at which the present estimate was last continued [s]
    int part_ = no_part;                        ///< part in work: 0 bound_, then damped_parts_; no_part: no estimate is under way
    bool damping_due_ = false;                  ///< the present estimate includes damped_parts_
    long evaluations_ = 0;
};

}  // namespace cvtflow::tasks
