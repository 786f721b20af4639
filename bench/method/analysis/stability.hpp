#pragma once
/// Linear stability, found by executing the plan on y' = λ y.

#include <complex>
#include <functional>
#include <limits>

#include "bench/method/product_names.hpp"
#include "engine/method/stage_plan.hpp"

namespace cvtflow::bench {

/// R(z): result of one step from y = 1 for h λ = z.
/// @param plan here and below: accepted by validate()
[[nodiscard]] std::complex<double> stability_function(const StagePlan& plan, std::complex<double> z);

/// R(z) as a function that is called often: the plan is compiled once. Not to be called by two threads at a time.
[[nodiscard]] std::function<std::complex<double>(std::complex<double>)> stability_function(const StagePlan& plan);

/// Largest r such that |R(ρ direction)| ≤ 1 + tolerance for all ρ in [0, r]: scan in steps fine enough for a Chebyshev polynomial of the
/// plan's degree, then bisection. At most 2 stages² + 10, which no consistent explicit method exceeds.
/// @param direction of unit length, e.g. -1 or i; a ray of damping ratio ζ is (-ζ, sqrt(1 - ζ²))
/// @param enough end of the scan: the result may be a little more, and the method stable farther out
[[nodiscard]] double stability_reach(const StagePlan& plan, std::complex<double> direction, double tolerance,
                                     double enough = std::numeric_limits<double>::infinity());

/// Reach along the negative real axis. The tolerance forgives ripple that just touches 1. tolerance [1]
[[nodiscard]] double real_stability(const StagePlan& plan, double tolerance = 1e-6);
/// Reach along the imaginary axis. A method that grows slowly there (|R| - 1 ~ y⁴, say) has a tiny positive reach. tolerance [1]
[[nodiscard]] double imaginary_stability(const StagePlan& plan, double tolerance = 1e-9);

/// Largest stage value |Y| / |y| for h λ in [-length, 0]: amplification of a stiff component within a step.
[[nodiscard]] double stage_growth(const StagePlan& plan, double length);

/// Largest factor, for h λ in [-length, 0], by which an error made in one stage (a kink of the law, say) reaches the step's end.
/// A long chain can be stable as a whole and still have a large gain.
[[nodiscard]] double perturbation_gain(const StagePlan& plan, double length);

}  // namespace cvtflow::bench
