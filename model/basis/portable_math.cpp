#include "model/basis/portable_math.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "model/basis/extended.hpp"

namespace cvtflow::model {

namespace {

// Extended precision makes up for what the series round: its basic operations are exact to the bit on every processor.
using Real = Extended;
using std::frexp, std::ldexp, std::rint, std::sqrt;

constexpr Real half_pi = extended(0xc90fdaa22168c235, -63), log_2 = extended(0xb17217f7d1cf79ac, -64);
constexpr Real half_pi_high = 0x1.921fb54p+0, log_2_high = 0x1.62e42fep-1;  ///< few digits: exact times any number that occurs
constexpr Real half_pi_low = extended(0x885a308d313198a3, -93), log_2_low = extended(0xfa39ef35793c7673, -93);  ///< the rest
constexpr Real sqrt_half = extended(0xb504f333f9de6484, -64);

/// Σ over k = first, first + 2, … ≤ 23 of ±r^k / k!
Real alternating(Real r, int first) noexcept {
    Real term = first == 0 ? 1.0 : r, sum = term;
    for (int k = first + 2; k <= 23; k += 2) {
        term *= -r * r / static_cast<Real>(k * (k - 1));
        sum += term;
    }
    return sum;
}

/// 1/k! of k = 0 … 23
constexpr std::array<Real, 24> inverse_factorial = [] {
    std::array<Real, 24> found{};
    Real factorial = 1.0;
    for (int k = 0; k < static_cast<int>(found.size()); ++k) {
        if (k > 1) factorial *= static_cast<Real>(k);
        found[static_cast<std::size_t>(k)] = 1.0 / factorial;
    }
    return found;
}();

/// alternating() to 2^-62 of its value, without divisions: terms that add and those that subtract, side by side.
Real alternating_by_products(Real r, int first) noexcept {
    constexpr int last = 18;
    const Real square = r * r, fourth = square * square;
    const Real* coefficient = inverse_factorial.data() + first;
    Real adding = coefficient[last - 2], subtracting = coefficient[last];
    for (int k = last - 6; k >= 0; k -= 4) {
        adding = coefficient[k] + fourth * adding;
        subtracting = coefficient[k + 2] + fourth * subtracting;
    }
    const Real sum = adding - square * subtracting;
    return first == 0 ? sum : r * sum;
}

/// x - turns π/2
Real without_turns(Real x, Real turns) noexcept { return (x - turns * half_pi_high) - turns * half_pi_low; }

/// sin(r + quarter π/2) by a series of r.
template <class Series>
Real wave_of(const Series& series, Real r, std::int64_t quarter) noexcept {
    const Real value = series(r, quarter % 2 == 0 ? 1 : 0);
    return (quarter & 2) == 0 ? value : -value;
}

/// sin(x + quarter π/2)
Real wave(Real x, int quarter) noexcept {
    const Real turns = rint(x / half_pi);
    return wave_of(alternating, without_turns(x, turns), static_cast<std::int64_t>(turns) + quarter);
}

/// wave() rounded to a double. Both series are good to 2^-61, so where all within 2^-60 of one of them is rounded to one double, the other
/// gives it as well: in all but one call of sixty the quick one suffices.
double rounded_wave(double x, int quarter) noexcept {
    constexpr Real error = 0x1p-60;
    const double turns = std::rint(x * (2.0 * std::numbers::inv_pi));
    const Real quick = wave_of(alternating_by_products, without_turns(x, turns), static_cast<std::int64_t>(turns) + quarter);
    const double low = static_cast<double>(quick - error * quick), high = static_cast<double>(quick + error * quick);
    return low == high ? low : static_cast<double>(wave(x, quarter));
}

/// log(x), x > 0
Real logarithm(Real x) noexcept {
    int exponent = 0;
    Real mantissa = frexp(x, &exponent);  // 0.5 … 1
    if (mantissa < sqrt_half) {
        mantissa *= 2.0;
        --exponent;
    }
    const Real s = (mantissa - 1.0) / (mantissa + 1.0), square = s * s;
    Real power = s, sum = 0.0;
    for (int k = 1; k <= 27; k += 2) {
        sum += power / static_cast<Real>(k);
        power *= square;
    }
    return static_cast<Real>(exponent) * log_2_high + (static_cast<Real>(exponent) * log_2_low + 2.0 * sum);
}

Real exponential(Real x) noexcept {
    if (!(x > -12000.0 && x < 12000.0)) return x > 0.0 ? ldexp(Real(1.0), 30000) : x < 0.0 ? Real(0.0) : x;
    const Real twos = rint(x / log_2);
    const Real r = (x - twos * log_2_high) - twos * log_2_low;
    Real term = 1.0, sum = 1.0;
    for (int k = 1; k <= 20; ++k) {
        term *= r / static_cast<Real>(k);
        sum += term;
    }
    return ldexp(sum, static_cast<int>(static_cast<std::int64_t>(twos)));
}

}  // namespace

double portable_sin(double x) noexcept { return rounded_wave(x, 0); }
double portable_cos(double x) noexcept { return rounded_wave(x, 1); }

/// Half the angle by Newton's method on its tangent.
double portable_asin(double x) noexcept {
    const Real tangent = static_cast<Real>(x) / (1.0 + sqrt((1.0 - static_cast<Real>(x)) * (1.0 + static_cast<Real>(x))));
    Real half = tangent;
    for (int iteration = 0; iteration < 4; ++iteration) {  // an error e becomes e³/3, and the first is below 0.22
        const Real sine = wave(half, 0), cosine = wave(half, 1);
        half -= (sine - tangent * cosine) / (cosine + tangent * sine);
    }
    return static_cast<double>(2.0 * half);
}

double portable_pow(double x, double y) noexcept {
    if (!(x > 0.0)) return x == 0.0 && y > 0.0 ? 0.0 : std::nan("");
    return static_cast<double>(exponential(static_cast<Real>(y) * logarithm(x)));
}

double legendre(int m, double x) noexcept {
    double previous = 1.0;
    if (m == 0) return previous;
    double current = x;
    for (int k = 1; k < m; ++k) {
        const double next = ((2 * k + 1) * x * current - k * previous) / (k + 1);
        previous = current;
        current = next;
    }
    return current;
}

double legendre_derivative(int m, double x) noexcept {
    // P'_m = Σ (2k+1) P_k over k = m-1, m-3, …: no division by 1 - x².
    double sum = 0.0;
    for (int k = m - 1; k >= 0; k -= 2) sum += (2 * k + 1) * legendre(k, x);
    return sum;
}

Quadrature gauss_legendre(int points) {
    Quadrature rule;
    for (int g = 0; g < points; ++g) {
        double x = -portable_cos(std::numbers::pi * (g + 0.75) / (points + 0.5));
        for (int iteration = 0; iteration < 100; ++iteration) {
            const double step = legendre(points, x) / legendre_derivative(points, x);
            x -= step;
            if (std::abs(step) < 1e-16) break;
        }
        if (2 * g + 1 == points) x = 0.0;
        const double slope = legendre_derivative(points, x);
        rule.position.push_back(x);
        rule.weight.push_back(1.0 / ((1.0 - x * x) * slope * slope));
    }
    return rule;
}

}  // namespace cvtflow::model
