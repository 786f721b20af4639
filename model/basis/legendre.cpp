#include "model/basis/legendre.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>

#include "model/basis/portable_math.hpp"

namespace cvtflow::model {

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
