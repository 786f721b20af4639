#pragma once
/// Stability polynomials of order 2 whose real interval is nearly the longest possible: 0.81 degree².
/// R(z) = w(x) P(x) / (w(a) P(a)) with x = a + z/scale, w of degree 2 without real zeros and P orthogonal on [-1, 1] with weight
/// w²/sqrt(1 - x²); then w P oscillates between nearly equal bounds there. Source: Abdulle, Medovikov, Second order Chebyshev methods based
/// on orthogonal polynomials, Numer. Math. 90 (2001) 1-18. The zeros of w are found here from the order condition, for any degree.

#include <vector>

#include "bench/method/product_names.hpp"

namespace cvtflow::bench {

/// Zeros of a real polynomial, in x: real ± i imaginary.
struct ZeroPair {
    long double real, imaginary;  ///< real [1]
};

/// Polynomial in extended precision: after the rounding of a long recurrence the order still holds to the last digits.
struct NearOptimalPolynomial {
    int degree = 0;
    long double origin = 1.0L;  ///< a > 1: x of z = 0 [1]
    long double scale = 1.0L;   ///< dz/dx [1]
    ZeroPair zeros{};           ///< of w
    std::vector<long double> centre,
        coupling;  ///< monic recurrence P_j = (x - centre_j) P_{j-1} - coupling_j P_{j-2}, j = 1 … degree - 2

    /// |R| ≤ 1 on [-real_length(), 0]; beyond the first bump, |R| < 0.97 from degree 10 on.
    [[nodiscard]] double real_length() const noexcept { return static_cast<double>(scale * (1.0L + origin)); }
    /// R(z).
    [[nodiscard]] long double value(long double z) const noexcept;
};

inline constexpr int min_near_optimal = 5;
inline constexpr int max_near_optimal = 400;

/// The polynomial of order 2. @throws std::invalid_argument outside the limits above
[[nodiscard]] NearOptimalPolynomial near_optimal_polynomial(int degree);
}  // namespace cvtflow::bench
