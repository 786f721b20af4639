#pragma once
/// Largest stable step of a table: by its region and a spectrum, and by steps about a held state, which confirm the spectrum without it.

#include <complex>
#include <span>

#include "bench/study/stability/frozen_step.hpp"
#include "engine/method/stage_plan.hpp"
#include "model/variator/variator.hpp"
#include "tasks/step/integration_state.hpp"

namespace cvtflow::bench {

struct StableStep {
    double step = 0.0;                ///< largest stable step [s]; 0: no step is
    std::complex<double> limiting{};  ///< the eigenvalue that leaves the region first [1/s]
};

/// A mode may grow this much faster than by itself and still count as stable: e-fold in 10 ms, longer than simulations. Without it, weakly
/// damped slow modes would exclude every method whose region lacks the imaginary axis, however slowly they grow.
inline constexpr double growth_rate_tolerance = 100.0;  ///< [1/s]

/// The largest h such that no mode grows with any h' ≤ h: log|R(h' λ)|/h' ≤ max(Re λ, 0) + growth_rate_tolerance. Steps are tried in
/// ratios of 1.01 from 0.1/max|λ| on, then bisected to 1e-6. The conjugate of a pair is skipped.
/// @param eigenvalues [1/s], not all zero; those at the edge of the spectrum suffice
/// @throws std::invalid_argument if all eigenvalues are zero
[[nodiscard]] StableStep largest_stable_step(const engine::StagePlan& plan, std::span<const std::complex<double>> eigenvalues);

/// The largest stable step, found by taking steps.
struct MeasuredStep {
    double stable = 0.0;    ///< longest step tried with which a small disturbance died out [s]
    double unstable = 0.0;  ///< shortest step tried with which it grew [s]; 0: none did, the limit is beyond
    long evaluations = 0;   ///< evaluations of the right-hand side
    [[nodiscard]] double limit() const noexcept { return unstable > 0.0 ? 0.5 * (stable + unstable) : stable; }
};

/// Whether a disturbance of all velocities by ± 1e-9 m/s (so little that hardly a contact comes to the kink of its law) grows in `steps`
/// steps about the held state: twofold in their second half, or a thousandfold in all, beyond natural growth.
/// @param natural_growth largest positive real part in the spectrum, or 0 [1/s]
[[nodiscard]] bool disturbance_grows(const model::Variator& variator, const engine::StagePlan& plan, const tasks::FrozenStart& start,
                                     double h, int steps, double natural_growth = 0.0);

/// Brackets the limit to 0.5 % between 0.6 and 1.6 times `expected`, with up to 2000 steps per trial, fewer for methods of many stages.
/// @param expected > 0 [s]
[[nodiscard]] MeasuredStep measured_stable_step(const model::Variator& variator, const engine::StagePlan& plan,
                                                const tasks::FrozenStart& start, double expected, double natural_growth = 0.0);

}  // namespace cvtflow::bench
