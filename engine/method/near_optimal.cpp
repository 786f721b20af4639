#include "engine/method/near_optimal.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <stdexcept>

namespace cvtflow::engine {

namespace {

/// a = 1 + 0.13/degree² gives a ripple of 0.96; a real part of 1 - 3.15/degree² the longest interval whose first bump stays below 1.
/// Both are nearly independent of the degree.
constexpr long double damping = 0.13L;
constexpr long double first_bump = 3.15L;

/// Recurrence of the polynomials orthogonal with weight w²/sqrt(1 - x²): sums over Chebyshev's points are exact for them.
void orthogonalise(NearOptimalPolynomial& p) {
    const auto order = static_cast<std::size_t>(p.degree - 2);
    const std::size_t nodes = order + 4;
    std::vector<long double> x(nodes), weight(nodes), before(nodes, 0.0L), now(nodes, 1.0L);
    for (std::size_t i = 0; i < nodes; ++i) {
        x[i] = std::cos(std::numbers::pi_v<long double> * (static_cast<long double>(i) + 0.5L) / static_cast<long double>(nodes));
        const long double w = (x[i] - p.zero_real) * (x[i] - p.zero_real) + p.zero_imaginary * p.zero_imaginary;
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

/// w P and its first two derivatives.
struct Jet {
    long double value, first, second;
};

Jet jet(const NearOptimalPolynomial& p, long double x) {
    Jet before{0.0L, 0.0L, 0.0L}, now{1.0L, 0.0L, 0.0L};
    for (std::size_t j = 0; j < p.centre.size(); ++j) {
        const long double d = x - p.centre[j], c = p.coupling[j];
        const Jet next{d * now.value - c * before.value, now.value + d * now.first - c * before.first,
                       2.0L * now.first + d * now.second - c * before.second};
        before = now;
        now = next;
    }
    const long double d = x - p.zero_real, w = d * d + p.zero_imaginary * p.zero_imaginary;
    return {w * now.value, 2.0L * d * now.value + w * now.first, 2.0L * now.value + 4.0L * d * now.first + w * now.second};
}

/// R''(0) - 1 for a pair of zeros; sets the scale such that R'(0) = 1.
long double defect(NearOptimalPolynomial& p, long double imaginary) {
    p.zero_imaginary = imaginary;
    orthogonalise(p);
    const Jet at = jet(p, p.origin);
    p.scale = at.first / at.value;
    return at.second / at.value / (p.scale * p.scale) - 1.0L;
}

}  // namespace

long double NearOptimalPolynomial::value(long double z) const noexcept { return jet(*this, origin + z / scale).value / jet(*this, origin).value; }

NearOptimalPolynomial near_optimal_polynomial(int degree) {
    if (degree < fewest_near_optimal || degree > most_near_optimal)
        throw std::invalid_argument("near-optimal polynomials have degrees 5 to 400");
    const long double square = static_cast<long double>(degree) * degree;
    NearOptimalPolynomial p{degree, 1.0L + damping / square, 1.0L, 1.0L - first_bump / square, 0.0L, {}, {}};
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

}  // namespace cvtflow::engine
