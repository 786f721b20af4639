#pragma once
/// Eigenvalues of real matrices without symmetry. Matrices are column by column: entry (row, column) at column * size + row.

#include <complex>
#include <functional>
#include <vector>

#include "bench/method/product_names.hpp"

namespace cvtflow::bench {

using Eigenvalues = std::vector<std::complex<double>>;  ///< eigenvalues [1/s] if the matrix is a Jacobian

/// Scales rows and columns by powers of 2 (exactly) until they are about equally long: coordinates in metres and speeds in metres per
/// second differ by the frequencies of the variator, and rounding is relative to the largest entry. Eigenvalues stay the same.
/// Source: Parlett, Reinsch, Numer. Math. 13 (1969) 293-304.
void balance(std::vector<double>& matrix, int size);

/// Eigenvalues in the order of the dense QR iteration, neither balanced before nor sorted after; none if it does not converge. This is the
/// only place where the iteration is compiled. @param matrix [size * size]
[[nodiscard]] Eigenvalues dense_eigenvalues(const double* matrix, int size);

/// All eigenvalues, by real part, most negative first, then by imaginary part. Dense QR: 25 size³ operations.
/// @throws std::runtime_error if the iteration does not converge (entries that are not finite)
[[nodiscard]] Eigenvalues eigenvalues(std::vector<double> matrix, int size);

/// Sorts by real part, most negative first, then by imaginary part.
void sort_by_decay(Eigenvalues& values);

/// Settings of extremal_eigenvalues().
struct ExtremalOptions {
    double left_of = -1e6;      ///< upper bound of the real parts; the pair that oscillates fastest is included besides [1/s]
    double tolerance = 1e-6;    ///< ‖M x - λ x‖ / (|λ| ‖x‖) of all of them in the balanced matrix [1]
    int first_dimension = 120;  ///< dimension of the Krylov space before it grows
    std::function<void(int dimension, int settled, int requested)> progress;  ///< called after each check; may be empty
};

struct ExtremalEigenvalues {
    Eigenvalues values;     ///< the requested ones, sorted as by eigenvalues()
    double residual = 0.0;  ///< largest relative residual among them
    int dimension = 0;      ///< final dimension of the Krylov space; as large as the matrix: nothing was saved
};

/// Eigenvalues at the edge of the spectrum, by Arnoldi's method with twofold orthogonalisation: the space grows until all requested ones
/// have settled. Uses that most entries are zero. Deterministic: the start vector is fixed. Source: Saad, Numerical Methods for Large
/// Eigenvalue Problems, 6.2; the last component of Ritz vectors by Hyman's recurrence.
[[nodiscard]] ExtremalEigenvalues extremal_eigenvalues(std::vector<double> matrix, int size, const ExtremalOptions& options);

}  // namespace cvtflow::bench
