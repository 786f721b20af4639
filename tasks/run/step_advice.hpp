#pragma once
/// The longest step that a method can take at a state: extreme eigenvalues of the equations of motion against the method's stability
/// region.

#include <complex>
#include <string>
#include <string_view>
#include <vector>

#include "model/variator/variator.hpp"
#include "tasks/scene/scene.hpp"

namespace cvtflow::tasks {

/// Extreme eigenvalues at (t, state) with frozen phases [1/s], of positive imaginary part or real: Ritz values of an Arnoldi iteration on
/// the right-hand side, `directions` evaluations by central differences. The outermost are good to some per cent; a bound they are not.
/// Empty if the right-hand side is not finite there.
[[nodiscard]] std::vector<std::complex<double>> extreme_eigenvalues(const model::Variator& variator, double t, const double* state,
                                                                    const std::vector<model::Phase>& phases, int directions = 60);

/// Factor on the largest stable step above which a step is reported as beyond stability. The estimate is good to some per cent, and a
/// method that is a little unstable in a few contacts only (RK4 at 50 ns on the baseline: 1.1) still gives good results.
inline constexpr double beyond_stability = 1.25;

/// Largest h for which h λ lies in the method's stability region for all of these eigenvalues [s]. Infinity for a method that is no table
/// of stages (implicit: linear stability sets no limit), or if there are no eigenvalues. Eigenvalues that grow by themselves, or are damped
/// by less than a thousandth, count as damped by a thousandth.
[[nodiscard]] double largest_stable_step(std::string_view method, const std::vector<std::complex<double>>& eigenvalues);

/// Both in one; programs by their own test equation (StepLimitBound). tasks/method/stability/predicted_step.hpp knows it better, and takes
/// longer. t [s], state [unknowns]
[[nodiscard]] double largest_stable_step(const model::Variator& variator, std::string_view method, double t, const double* state,
                                         const std::vector<model::Phase>& phases);

/// One line about an energy balance that does not close. setting: run.step, step: the last one that was chosen [s]
[[nodiscard]] std::string unreliable_text(double suspicion, const AutoNumber& setting, double step);

}  // namespace cvtflow::tasks
