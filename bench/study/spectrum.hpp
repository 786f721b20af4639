#pragma once
/// Eigenvalues of the equations of motion at a state: what a method has to cope with.

#include <complex>
#include <vector>

#include "model/variator/variator.hpp"

namespace cvtflow::bench {

/// Central differences of the right-hand side at (t, state) with frozen phases: [size * size], column by column (d f / d y_k contiguous).
/// Steps: 1e-9 m (rad) for coordinates, 1e-6 m/s (rad/s) for velocities: small against contact depths and saturation speeds.
[[nodiscard]] std::vector<double> jacobian(const model::Variator& variator, double t, const std::vector<double>& state,
                                           const std::vector<model::Phase>& phases);

/// All eigenvalues of the Jacobian [1/s], sorted by real part, most negative first. Dense QR: about a second for 650 unknowns, some minutes
/// for 3,400.
[[nodiscard]] std::vector<std::complex<double>> spectrum(const model::Variator& variator, double t, const std::vector<double>& state,
                                                         const std::vector<model::Phase>& phases);

}  // namespace cvtflow::bench
