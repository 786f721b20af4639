#include "tests/oracle/legendre.hpp"

#include <numbers>
#include <stdexcept>
#include <utility>

namespace cvtflow::oracle {

Real legendre(int m, Real x) {
    switch (m) {
        case 0: return 1.0L;
        case 1: return x;
        case 2: return (3.0L * x * x - 1.0L) / 2.0L;
        case 3: return (5.0L * x * x * x - 3.0L * x) / 2.0L;
        default: throw std::invalid_argument("order of a Legendre polynomial beyond 3");
    }
}

Real legendre_slope(int m, Real x) {
    switch (m) {
        case 0: return 0.0L;
        case 1: return 1.0L;
        case 2: return 3.0L * x;
        case 3: return (15.0L * x * x - 3.0L) / 2.0L;
        default: throw std::invalid_argument("order of a Legendre polynomial beyond 3");
    }
}

namespace {

/// P_n(x) and P_n'(x) by the three-term recurrence, |x| < 1.
std::pair<Real, Real> value_and_slope(int n, Real x) {
    Real before = 1.0L;
    Real value = x;
    for (int k = 2; k <= n; ++k) {
        const Real next = ((2 * k - 1) * x * value - (k - 1) * before) / k;
        before = value;
        value = next;
    }
    return {value, n * (x * value - before) / (x * x - 1.0L)};
}

}  // namespace

std::vector<QuadraturePoint> gauss_legendre(int count) {
    std::vector<QuadraturePoint> points;
    for (int g = 0; g < count; ++g) {
        Real x = -std::cos(std::numbers::pi_v<Real> * (g + 0.75L) / (count + 0.5L));
        for (int step = 0; step < 30; ++step) {
            const auto [value, slope] = value_and_slope(count, x);
            x -= value / slope;
        }
        const Real slope = value_and_slope(count, x).second;
        points.push_back({x, 1.0L / ((1.0L - x * x) * slope * slope)});
    }
    return points;
}

}  // namespace cvtflow::oracle
