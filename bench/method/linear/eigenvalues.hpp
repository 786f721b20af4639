#pragma once
/// Eigenvalues of real matrices without symmetry. Matrices are column by column: entry (row, column) at column * size + row.

#include <complex>
#include <vector>

#include "bench/method/product_names.hpp"

namespace cvtflow::bench {

using Eigenvalues = std::vector<std::complex<double>>;  ///< [1/s] where the matrix is a Jacobian

/// Scales rows and columns by powers of 2 (exactly) until they are about equally long: coordinates in metres and speeds in metres per
/// second differ by the frequencies of the variator, and rounding is relative to the largest entry. Eigenvalues stay the same.
/// Source: Parlett, Reinsch, Numer. Math. 13 (1969) 293-304.
void balance(std::vector<double>& matrix, int size);

/// Eigenvalues as the dense QR iteration leaves them, neither balanced before nor sorted after; none if it does not converge. This is the
/// only place where the iteration is compiled. @param matrix [size * size]
[[nodiscard]] Eigenvalues dense_eigenvalues(const double* matrix, int size);

/// All eigenvalues, by real part, most negative first, then by imaginary part. Dense QR: 25 size³ operations.
/// @throws std::runtime_error if the iteration does not converge (entries that are not finite)
[[nodiscard]] Eigenvalues eigenvalues(std::vector<double> matrix, int size);

/// Sorts by real part, most negative first, then by imaginary part.
void sort_by_decay(Eigenvalues& values);

}  // namespace cvtflow::bench
