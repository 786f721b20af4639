#include "bench/method/family/near_optimal.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <stdexcept>

namespace cvtflow::bench {

namespace {

/// a = 1 + 0.13/degree² gives a ripple of 0.96; a real part of 1 - 3.15/degree² the longest interval whose first bump stays below 1.
/// Both are nearly independent of the degree.
constexpr long double damping = 0.13L;
constexpr long double first_bump = 3.15L;

/// (x - real)² + imaginary²
[[nodiscard]] long double quadratic(const ZeroPair& zero, long double x) noexcept {
    return (x - zero.real) * (x - zero.real) + zero.imaginary * zero.imaginary;
}

/// Recurrence of the polynomials orthogonal with weight w²/sqrt(1 - x²): sums over Chebyshev's points are exact for them.
void orthogonalise(NearOptimalPolynomial& p) {
    const auto order = static_cast<std::size_t>(p.degree) - 2;
    const std::size_t nodes = order + 4;
    std::vector<long double> x(nodes), weight(nodes), before(nodes, 0.0L), now(nodes, 1.0L);
    for (std::size_t i = 0; i < nodes; ++i) {
        x[i] = std::cos(std::numbers::pi_v<long double> * (static_cast<long double>(i) + 0.5L) / static_cast<long double>(nodes));
        const long double w = quadratic(p.zeros, x[i]);
        weight[i] = w * w;
    }
    p.centre.assign(order, 0.0L);
    p.coupling.assign(order, 0.0L);
    long double last = 0.0L;
    for (std::size_t j = 0; j < order; ++j) {
        long double square = 0.0L, moment = 0.0L;
        for (std::size_t i = 0; i < nodes; ++i) {
            const long double part = weight[i] * now[i] * now[i];
            square += part;
            moment += part * x[i];
        }
        p.centre[j] = moment / square;
        p.coupling[j] = j == 0 ? 0.0L : square / last;
        last = square;
        for (std::size_t i = 0; i < nodes; ++i) {
            const long double next = (x[i] - p.centre[j]) * now[i] - p.coupling[j] * before[i];
            before[i] = now[i];
            now[i] = next;
        }
    }
}

/// Coefficients of t⁰ … t².
using Taylor = std::array<long double, 3>;

/// (d + t) times a polynomial.
[[nodiscard]] Taylor linear_times(long double d, const Taylor& of) noexcept {
    Taylor product{d * of[0]};
    for (std::size_t k = 1; k < of.size(); ++k) product[k] = of[k - 1] + d * of[k];
    return product;
}

/// (w + 2 d t + t²) times a polynomial.
[[nodiscard]] Taylor quadratic_times(long double w, long double d, const Taylor& of) noexcept {
    Taylor product{w * of[0], 2.0L * d * of[0] + w * of[1]};
    for (std::size_t k = 2; k < of.size(); ++k) product[k] = of[k - 2] + 2.0L * d * of[k - 1] + w * of[k];
    return product;
}

/// w P about x.
[[nodiscard]] Taylor expansion(const NearOptimalPolynomial& p, long double x) noexcept {
    Taylor before{}, now{1.0L};
    for (std::size_t j = 0; j < p.centre.size(); ++j) {
        Taylor next = linear_times(x - p.centre[j], now);
        for (std::size_t k = 0; k < next.size(); ++k) next[k] -= p.coupling[j] * before[k];
        before = now;
        now = next;
    }
    return quadratic_times(quadratic(p.zeros, x), x - p.zeros.real, now);
}

/// R''(0) - 1 for that imaginary part of the zeros. Sets recurrence and scale such that R'(0) = 1.
long double defect(NearOptimalPolynomial& p, long double imaginary) {
    p.zeros.imaginary = imaginary;
    orthogonalise(p);
    const Taylor at = expansion(p, p.origin);
    p.scale = at[1] / at[0];
    const long double square = p.scale * p.scale;
    return 2.0L * at[2] / at[0] / square - 1.0L;
}

void require_degree(int degree) {
    if (degree < min_near_optimal || degree > max_near_optimal)
        throw std::invalid_argument("near-optimal polynomials have degrees 5 to 400");
}

}  // namespace

long double NearOptimalPolynomial::value(long double z) const noexcept {
    return expansion(*this, origin + z / scale)[0] / expansion(*this, origin)[0];
}

NearOptimalPolynomial near_optimal_polynomial(int degree) {
    require_degree(degree);
    const long double square = static_cast<long double>(degree) * degree;
    NearOptimalPolynomial p{degree, 1.0L + damping / square, 1.0L, {1.0L - first_bump / square, 0.0L}, {}, {}};
    // Secant from where the zero is for long polynomials.
    long double previous = 3.2L / square, current = 3.4L / square;
    long double before = defect(p, previous), now = defect(p, current);
    for (int iteration = 0; iteration < 30 && now != before && std::abs(now) > 1e-18L; ++iteration) {
        const long double next = current - now * (current - previous) / (now - before);
        previous = current;
        before = now;
        current = next;
        now = defect(p, current);
    }
    if (!(std::abs(now) < 1e-14L)) throw std::invalid_argument("no near-optimal polynomial of this degree was found");
    return p;
}

}  // namespace cvtflow::bench
