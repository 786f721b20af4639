#pragma once
/// Legendre polynomials and Gauss-Legendre quadrature on [-1, 1].

#include "tests/oracle/vectors.hpp"

#include <vector>

namespace cvtflow::oracle {

/// P_m(x) for m = 0…3, written out.
Real legendre(int m, Real x);
/// P_m'(x) for m = 0…3, written out.
Real legendre_slope(int m, Real x);

struct QuadraturePoint {
    Real at;      ///< ξ_g
    Real weight;  ///< w_g; all weights sum to one
};

/// Gauss-Legendre points in ascending order, any count ≥ 1; the weights sum to one (not two).
std::vector<QuadraturePoint> gauss_legendre(int count);

}  // namespace cvtflow::oracle
