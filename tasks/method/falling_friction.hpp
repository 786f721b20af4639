#pragma once
/// How fast sliding grows where the friction of tips falls with the sliding speed.

#include "model/observe/observation.hpp"

namespace cvtflow::tasks {

/// A pin half that slides at both tips, with normal forces N, obeys m u' = -2 N μ(u) + …: where μ falls, sliding grows with the rate
/// 2 N |μ'|/m. A step of first order h errs in the growth, and so in losses, in proportion to h 2 N |μ'|/m.
class FallingFriction {
public:
    /// `variator` must outlive it. Takes all its memory here.
    FallingFriction(const model::Variator& variator, const model::Parameters& parameters);

    /// Largest growth rate of all tips at a state, at the sliding speed where friction falls most steeply; 0: it does not fall [1/s].
    /// t [s], state [unknowns]
    [[nodiscard]] double growth(double t, const double* state, const model::Phase* phases) noexcept;

private:
    /// Largest -μ' from the saturation speed on, at the present temperature of the oil [s/m].
    [[nodiscard]] double steepest_fall() const noexcept;

    const model::Variator& variator_;
    double half_mass_;  ///< [kg]
    model::Observer observer_;
};

}  // namespace cvtflow::tasks
