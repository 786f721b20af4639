#pragma once
/// Legendre polynomials and Gauss-Legendre quadrature: the basis of a pin half's axis.

#include <vector>

namespace cvtflow::model {

/// P_m(x), any m ≥ 0.
[[nodiscard]] double legendre(int m, double x) noexcept;
/// P_m'(x), any m ≥ 0, valid at x = ±1 too.
[[nodiscard]] double legendre_derivative(int m, double x) noexcept;

struct Quadrature {
    std::vector<double> position;  ///< in (-1, 1), ascending [1]
    std::vector<double> weight;    ///< sums to 1 [1]
};
/// Gauss-Legendre rule with `points` ≥ 1 nodes (Newton iteration on P_n; Abramowitz & Stegun 25.4.29).
[[nodiscard]] Quadrature gauss_legendre(int points);

}  // namespace cvtflow::model
