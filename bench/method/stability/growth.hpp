#pragma once
/// Growth of the fastest of all disturbances in one application of a linear map, by Arnoldi's method.

#include <algorithm>
#include <complex>
#include <functional>
#include <vector>

#include "bench/method/product_names.hpp"

namespace cvtflow::bench {

// Arnoldi's method: eigenvalues of a linear map that can only be applied, outermost ones first to be right.

/// Computes to = map(from), both [size]; false: it cannot be applied.
using LinearMap = std::function<bool(const double* from, double* to)>;

/// An approximate eigenvector of unit length.
struct RitzVector {
    std::vector<std::complex<double>> vector;  ///< [size]
    double residual = 0.0;                     ///< |map(vector) - value vector|: 0 in an invariant space [1]
};

/// A Krylov space with its Hessenberg matrix. Grows by one dimension at a time, orthogonalised twice; the same bits every time.
class KrylovSpace {
public:
    /// @param most largest number of dimensions; at most `size`   @param start first direction [size]; of another length, or zero: one that
    /// has a share of every eigenvector
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

struct Growth {
    double factor = 0.0;                  ///< spectral radius; infinite where the map cannot be applied or is not finite [1]
    std::complex<double> multiplier;      ///< eigenvalue of this modulus, of positive imaginary part or real
    std::vector<double> real, imaginary;  ///< eigenvector of the multiplier [size]
    double uncertainty = 0.0;             ///< residual of the eigenvalue: distance of the map from one that has it exactly [1]
    int applications = 0;

    /// Many slow motions have multipliers near 1, and an estimate there may lie outside all of them, since the map is not normal [1]
    static constexpr double crowded = 0.6;
    /// The growth that is beyond doubt: within `crowded` of 1 an estimate counts only if its residual is far smaller than the growth [1]
    [[nodiscard]] double certain() const noexcept {
        const bool doubtful = std::abs(multiplier - 1.0) < crowded && uncertainty > 0.1 * (factor - 1.0);
        return doubtful ? std::min(factor, 1.0) : factor;
    }
};

struct GrowthSettings {
    /// Multipliers nearer to 1 do not count: motions that a step resolves so well grow by themselves or not at all, whatever the method.
    double from_one = 0.1;  ///< [1]
    int most = 160;         ///< dimension of the Krylov space
    double settled = 1e-4;  ///< change of the factor since there were half as many directions
    int restarts = 3;       ///< restarts with the eigenvector found so far, while growth is found but uncertain
};

/// Deterministic. @param start first direction; of another length: one that has a share of everything
[[nodiscard]] Growth fastest_growth(int size, const LinearMap& map, const std::vector<double>& start, const GrowthSettings& settings = {});

}  // namespace cvtflow::bench
