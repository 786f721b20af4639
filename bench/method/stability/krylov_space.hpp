#pragma once
/// Arnoldi's method: eigenvalues of a linear map that can only be applied, outermost ones first to be right.

#include <complex>
#include <functional>
#include <vector>

#include "bench/method/product_names.hpp"

namespace cvtflow::bench {

/// to = map(from), both [size]; false: it cannot be applied.
using LinearMap = std::function<bool(const double* from, double* to)>;

/// An approximate eigenvector of unit length.
struct RitzVector {
    std::vector<std::complex<double>> vector;  ///< [size]
    double residual = 0.0;                     ///< |map(vector) - value vector|: 0 in an invariant space [1]
};

/// A Krylov space with its Hessenberg matrix. Grows by one dimension at a time, orthogonalised twice; the same bits every time.
class KrylovSpace {
public:
    /// @param most dimensions that it may have; no more than `size`   @param start first direction [size]; of another length, or zero: one
    /// that has a share of every eigenvector
    KrylovSpace(int size, int most, const std::vector<double>& start = {});

    /// One more dimension; false: the map could not be applied, or its result is not finite.
    [[nodiscard]] bool grow(const LinearMap& map);
    [[nodiscard]] int dimension() const noexcept { return dimension_; }
    /// Invariant, or as large as it may become: growing is over.
    [[nodiscard]] bool full() const noexcept { return invariant_ || dimension_ == most_; }

    /// Ritz values of imaginary part 0 or more [dimension, conjugates left out], in no order; exact in an invariant space.
    [[nodiscard]] std::vector<std::complex<double>> values() const;
    /// The Ritz vector of one of them, by two steps of inverse iteration [size].
    [[nodiscard]] RitzVector vector_of(std::complex<double> value) const;

private:
    const int size_, most_;
    std::vector<double> basis_;       ///< orthonormal, column by column [size][most + 1]
    std::vector<double> hessenberg_;  ///< column by column [most + 1][most]
    int dimension_ = 0;
    bool invariant_ = false;
};

}  // namespace cvtflow::bench
