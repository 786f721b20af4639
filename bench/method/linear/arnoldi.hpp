#pragma once
/// Eigenvalues at the edge of a spectrum, by Arnoldi's method.

#include <functional>
#include <vector>

#include "bench/method/linear/eigenvalues.hpp"

namespace cvtflow::bench {

/// Settings of extremal_eigenvalues().
struct ExtremalOptions {
    double left_of = -1e6;      ///< all eigenvalues whose real part is less [1/s]; besides the pair that oscillates fastest
    double tolerance = 1e-6;    ///< ‖M x - λ x‖ / (|λ| ‖x‖) of all of them in the balanced matrix [1]
    int first_dimension = 120;  ///< of the Krylov space, before it grows
    std::function<void(int dimension, int settled, int requested)> progress;  ///< after each check; may be empty
};

struct ExtremalEigenvalues {
    Eigenvalues values;     ///< the requested ones, sorted as by eigenvalues()
    double residual = 0.0;  ///< largest relative residual among them
    int dimension = 0;      ///< of the Krylov space in the end; as large as the matrix: nothing was saved
};

/// Eigenvalues at the edge of the spectrum, by Arnoldi's method with twofold orthogonalisation: the space grows until all requested ones
/// have settled. Uses that most entries are zero. Deterministic: the start vector is fixed. Source: Saad, Numerical Methods for Large
/// Eigenvalue Problems, 6.2; the last component of Ritz vectors by Hyman's recurrence.
[[nodiscard]] ExtremalEigenvalues extremal_eigenvalues(std::vector<double> matrix, int size, const ExtremalOptions& options);

}  // namespace cvtflow::bench
