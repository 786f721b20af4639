#pragma once
/// Growth of the fastest of all disturbances in one application of a linear map, by Arnoldi's method.

#include <algorithm>
#include <complex>
#include <vector>

#include "bench/method/analysis/eigenvalues.hpp"
#include "bench/method/product_names.hpp"

namespace cvtflow::bench {

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
