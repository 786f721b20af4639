#pragma once
/// Functions on which results depend, from additions, multiplications, divisions and roots alone. The C library has several of each and
/// takes one by the processor (with fused operations or without), and they differ in last bits; these are the same everywhere. Legendre
/// polynomials and their quadrature are the basis of a pin half's axis.

#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

namespace cvtflow::model {

/// Within one unit of the last place for |x| ≤ 1e4, nearly always rounded correctly. x [1 or rad]
[[nodiscard]] double portable_sin(double x) noexcept;
[[nodiscard]] double portable_cos(double x) noexcept;  ///< x [1 or rad]
/// |x| ≤ 1. x [1 or rad]
[[nodiscard]] double portable_asin(double x) noexcept;
/// x > 0; 0 for x = 0 and y > 0. Within one unit of the last place for |y log x| ≤ 500. x [1 or rad], y [1]
[[nodiscard]] double portable_pow(double x, double y) noexcept;
/// √(x² + y²) of numbers whose squares neither overflow nor vanish: lengths, speeds. x [1], y [1]
[[nodiscard]] inline double portable_hypot(double x, double y) noexcept { return std::sqrt(x * x + y * y); }

/// P_m(x), any m ≥ 0.
[[nodiscard]] double legendre(int m, double x) noexcept;
/// P_m'(x), any m ≥ 0, valid at x = ±1 too.
[[nodiscard]] double legendre_derivative(int m, double x) noexcept;

struct Quadrature {
    std::vector<double> position;  ///< nodes in (-1, 1), ascending
    std::vector<double> weight;    ///< weights with the sum 1
};
/// Gauss-Legendre rule with `points` ≥ 1 nodes (Newton iteration on P_n; Abramowitz & Stegun 25.4.29).
[[nodiscard]] Quadrature gauss_legendre(int points);

namespace {

/// x^(10/9) for x ≥ 0; 0 below 1e-290. Within two units of the last place, where the result is no denormal number. x [1]
[[nodiscard]] inline double ten_ninths(double x) noexcept {
    if (!(x >= 1e-290)) return x < 1e-290 ? 0.0 : x;  // not a number stays one
    // The ninth root: a ninth of the number's bits is within 3.4 %; Halley's method then takes an error e to 20/3 e³.
    std::uint64_t bits;
    std::memcpy(&bits, &x, sizeof bits);
    bits = bits / 9 + 0x38d4b17e4b17e55cu;  // eight ninths of the bits of 1, moved so that errors of both signs are equal
    double root;                            ///< the ninth root [1]
    std::memcpy(&root, &bits, sizeof root);
    for (int iteration = 0; iteration < 3; ++iteration) {
        const double square = root * root, fourth = square * square, ninth = fourth * fourth * root;
        root += root * ((x - ninth) / (5.0 * ninth + 4.0 * x));
    }
    return x * root;
}

}  // namespace
}  // namespace cvtflow::model
