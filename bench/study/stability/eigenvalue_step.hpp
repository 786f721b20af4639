#pragma once
/// How long a step may be, for a method and a spectrum.

#include <complex>
#include <span>

#include "engine/method/stage_plan.hpp"

namespace cvtflow::bench {

struct StableStep {
    double step = 0.0;                ///< largest stable step [s]; 0: no step is
    std::complex<double> limiting{};  ///< the eigenvalue that leaves the region first [1/s]
};

/// A mode may grow this much faster than it does by itself and still count as stable: e-fold in 10 ms, longer than what is simulated.
/// Without it, hardly damped slow modes would condemn every method whose region lacks the imaginary axis, however slowly they grow.
inline constexpr double growth_rate_tolerance = 100.0;  ///< [1/s]

/// The largest h such that no mode grows with any h' ≤ h: log|R(h' λ)|/h' ≤ max(Re λ, 0) + growth_rate_tolerance. Steps are tried in
/// ratios of 1.01 from 0.1/max|λ| on, then bisected to 1e-6. The conjugate of a pair is skipped.
/// @param eigenvalues [1/s], not all zero; those at the edge of the spectrum suffice
/// @throws std::invalid_argument if all eigenvalues are zero
[[nodiscard]] StableStep largest_stable_step(const engine::StagePlan& plan, std::span<const std::complex<double>> eigenvalues);

}  // namespace cvtflow::bench
