#pragma once
/// Stability polynomials of order 2 and 4 whose real interval is nearly the longest possible: 0.81 degree² and 0.35 degree².
/// R(z) = w(x) P(x) / (w(a) P(a)) with x = a + z/scale, w of degree 2 or 4 without real zeros and P orthogonal on [-1, 1] with weight
/// w²/sqrt(1 - x²); then w P oscillates between nearly equal bounds there. Sources: Abdulle, Medovikov, Second order Chebyshev methods
/// based on orthogonal polynomials, Numer. Math. 90 (2001) 1-18; Abdulle, Fourth order Chebyshev methods with recurrence relation, SIAM J.
/// Sci. Comput. 23 (2002) 2041-2054. The zeros of w are found here from the order conditions, for any degree.

#include <vector>

#include "bench/method/product_names.hpp"
#include "engine/method/stage_plan.hpp"

namespace cvtflow::bench {

/// Zeros of a real polynomial, in x: real ± i imaginary.
struct ZeroPair {
    long double real, imaginary;  ///< real [1]
};

/// One row of a recurrence of stage values: g_j = (1 - older) g_{j-1} + older g_{j-2} + h slope f(g_{j-1}).
struct RecurrenceRow {
    double slope, older;  ///< [1]
};

/// Polynomial in extended precision: after the rounding of a long recurrence the order still holds to the last digits.
struct NearOptimalPolynomial {
    int degree = 0;
    long double origin = 1.0L;    ///< a > 1: x of z = 0 [1]
    long double scale = 1.0L;     ///< dz/dx [1]
    std::vector<ZeroPair> zeros;  ///< zeros of w, half as many pairs as the order
    std::vector<long double> centre,
        coupling;  ///< monic recurrence P_j = (x - centre_j) P_{j-1} - coupling_j P_{j-2}, j = 1 … degree - order

    /// |R| ≤ 1 on [-real_length(), 0]; beyond the first bump, |R| < 0.97 from degree 10 on.
    [[nodiscard]] double real_length() const noexcept { return static_cast<double>(scale * (1.0L + origin)); }
    /// R(z).
    [[nodiscard]] long double value(long double z) const noexcept;
    /// P as stages: g_j = P_j(x)/P_j(a) for y' = z y.
    [[nodiscard]] std::vector<RecurrenceRow> recurrence() const;
};

inline constexpr int min_near_optimal = 5;
inline constexpr int max_near_optimal = 400;

/// The polynomial of order 2. @throws std::invalid_argument outside the limits above
[[nodiscard]] NearOptimalPolynomial near_optimal_polynomial(int degree);
/// The polynomial of order 4. @throws std::invalid_argument outside the limits above
[[nodiscard]] NearOptimalPolynomial near_optimal_polynomial_of_order_4(int degree);

/// State slot that holds g_j, j ≥ 1: three take turns.
[[nodiscard]] constexpr int recurrence_state(int j) noexcept { return 1 + (j - 1) % 3; }
/// Slope slot that holds f(g_j), j ≥ 1: two take turns.
[[nodiscard]] constexpr int recurrence_slope(int j) noexcept { return 1 + j % 2; }
/// Appends the stages g_1, g_2, … to a plan that consists of stage 0.
void add_recurrence(StagePlan& plan, const std::vector<RecurrenceRow>& rows);

}  // namespace cvtflow::bench
