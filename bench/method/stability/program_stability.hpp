#pragma once
/// Linear stability of methods that are programs and not tables of stages: effect of one step on their test equation.

#include <functional>
#include <limits>

#include "bench/method/product_names.hpp"
#include "tasks/method/friction/kick_tables.hpp"

namespace cvtflow::bench {

enum class TestEquation {
    oscillator,  ///< q' = v, v' = -ω² q - c v, elasticity explicit and friction c inside the step; x = h ω, y = h c
    linear,      ///< u' = λ u with its exact Jacobian; x = Re h λ, y = Im h λ
};

/// Effect of a step on a quantity that decays with h c or -h λ.
struct StageFigures {
    double growth = 0.0;  ///< largest value in a stage, for 1 at the start [1]
    double gain = 0.0;    ///< largest value at the end, for an error of 1 in one stage (a kink of the law) [1]
    double left = 0.0;    ///< value at the end, for 1 at the start [1]
};

/// Largest h ω with which an oscillator is stable whatever its friction, and the friction that allows no more.
struct FrictionLimit {
    double oscillation, friction;  ///< h ω and h c, as far as the method is stable [1]
};

struct ProgramStability {
    TestEquation equation;
    /// Spectral radius of one step among equal ones, history included; infinite where the method refuses to step. x [1], y [1]
    std::function<double(double x, double y)> radius;
    /// @param decay h c or -h λ, > 0, where the method steps
    std::function<StageFigures(double decay)> stages;
    double longest_decay;  ///< largest decay with which the method steps; infinite: any [1]
    /// Largest h δ of an explicit damping δ that is no friction, without oscillation, of methods for the oscillator [1].
    double longest_damping = std::numeric_limits<double>::infinity();
    /// Limit of an oscillator with any friction up to `stiffest` beside another with exactly that friction, which decides how many stages a
    /// step takes. Empty if the friction of others has no effect. stiffest [1]
    std::function<FrictionLimit(double stiffest)> beside = {};

    /// Whether growth is below 1e-6 a step. x [1], y [1]
    [[nodiscard]] bool stable(double x, double y) const { return radius(x, y) <= 1.0 + 1e-6; }
};

/// Reaches beyond this count as infinite [1].
inline constexpr double far_away = 1e6;

/// Largest r ≤ far_away such that the step is stable from (x, y) to (x, y) + r (along_x, along_y): scan in steps of 0.01, then of 1 %, and
/// bisection. From `enough` on the exact value does not matter: the scan ends. x, y, along_x, along_y, enough [1]
[[nodiscard]] double reach(const ProgramStability& method, double x, double y, double along_x, double along_y,
                           double enough = std::numeric_limits<double>::infinity());

/// Limit of a method for the oscillator.
[[nodiscard]] FrictionLimit limit_with_any_friction(const ProgramStability& method);

/// Largest figure of each kind over decays up to the method's longest or far_away, on a logarithmic grid; `left` at its end.
[[nodiscard]] StageFigures worst_stages(const ProgramStability& method);

// The test equation of methods that take friction apart: an oscillator whose friction acts inside the step.

/// Friction in stages of RKC, of order 2, damped more than usual: less leaves friction forces behind, more costs stages.
extern const Kick rkc_kick;
inline constexpr double rkc_kick_damping = 10.0;  ///< [1]

[[nodiscard]] ProgramStability leapfrog_stability(const Kick& kick);
/// Stability with converged sweeps over contacts: friction by backward Euler on velocities.
[[nodiscard]] ProgramStability backward_euler_leapfrog_stability();
/// Leapfrog of rigid pins: one implicit kick, all of it at the coordinates.
[[nodiscard]] ProgramStability rigid_leapfrog_stability();

}  // namespace cvtflow::bench
