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
constexpr long double damping_2 = 0.13L;
constexpr long double first_bump = 3.15L;

/// Damping of order 4: a ripple of 0.90 and a bump of 0.945 for every degree.
constexpr long double damping_4 = 0.2L;
[[nodiscard]] long double first_bump_4(long double square) { return 14.06L + 50.0L / square + 390.0L / (square * square); }

/// (x - real)² + imaginary²
[[nodiscard]] long double quadratic(const ZeroPair& zero, long double x) noexcept {
    return (x - zero.real) * (x - zero.real) + zero.imaginary * zero.imaginary;
}

/// Recurrence of the polynomials orthogonal with weight w²/sqrt(1 - x²): sums over Chebyshev's points are exact for them.
void orthogonalise(NearOptimalPolynomial& p) {
    const auto order = static_cast<std::size_t>(p.degree) - 2 * p.zeros.size();
    const std::size_t nodes = order + 2 + 2 * p.zeros.size();
    std::vector<long double> x(nodes), weight(nodes), before(nodes, 0.0L), now(nodes, 1.0L);
    for (std::size_t i = 0; i < nodes; ++i) {
        x[i] = std::cos(std::numbers::pi_v<long double> * (static_cast<long double>(i) + 0.5L) / static_cast<long double>(nodes));
        long double w = 1.0L;
        for (const ZeroPair& zero : p.zeros) w *= quadratic(zero, x[i]);
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

/// Coefficients of t⁰ … t⁴.
using Taylor = std::array<long double, 5>;

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
    for (const ZeroPair& zero : p.zeros) now = quadratic_times(quadratic(zero, x), x - zero.real, now);
    return now;
}

/// The second, third and fourth derivative of R at 0, less 1.
using Defects = std::array<long double, 3>;

/// Defects of the present zeros. Sets recurrence and scale such that R'(0) = 1.
Defects defects(NearOptimalPolynomial& p) {
    orthogonalise(p);
    const Taylor at = expansion(p, p.origin);
    p.scale = at[1] / at[0];
    const long double square = p.scale * p.scale;
    return {2.0L * at[2] / at[0] / square - 1.0L, 6.0L * at[3] / at[0] / (square * p.scale) - 1.0L,
            24.0L * at[4] / at[0] / (square * square) - 1.0L};
}

/// R''(0) - 1 for a pair of zeros.
long double defect(NearOptimalPolynomial& p, long double imaginary) {
    p.zeros[0].imaginary = imaginary;
    return defects(p)[0];
}

void require_degree(int degree) {
    if (degree < min_near_optimal || degree > max_near_optimal)
        throw std::invalid_argument("near-optimal polynomials have degrees 5 to 400");
}

}  // namespace

long double NearOptimalPolynomial::value(long double z) const noexcept {
    return expansion(*this, origin + z / scale)[0] / expansion(*this, origin)[0];
}

std::vector<RecurrenceRow> NearOptimalPolynomial::recurrence() const {
    std::vector<RecurrenceRow> rows;
    long double before = 0.0L, ratio_before = 0.0L, now = 1.0L;  // monic polynomials at the origin
    for (std::size_t i = 0; i < centre.size(); ++i) {
        const long double next = (origin - centre[i]) * now - coupling[i] * before;
        const long double ratio = now / next;
        rows.push_back({static_cast<double>(ratio / scale), static_cast<double>(-coupling[i] * ratio * ratio_before)});
        ratio_before = ratio;
        before = now;
        now = next;
    }
    return rows;
}

void add_recurrence(StagePlan& plan, const std::vector<RecurrenceRow>& rows) {
    for (int j = 1; j <= static_cast<int>(rows.size()); ++j) {
        const auto [slope, older] = rows[static_cast<std::size_t>(j - 1)];
        Stage stage{{{0, 1.0}}, {{j == 1 ? 0 : recurrence_slope(j - 1), slope}}, recurrence_state(j), recurrence_slope(j)};
        if (j > 1) stage.states = {{recurrence_state(j - 1), 1.0 - older}, {j == 2 ? 0 : recurrence_state(j - 2), older}};
        plan.stages.push_back(stage);
    }
}

NearOptimalPolynomial near_optimal_polynomial(int degree) {
    require_degree(degree);
    const long double square = static_cast<long double>(degree) * degree;
    NearOptimalPolynomial p{degree, 1.0L + damping_2 / square, 1.0L, {{1.0L - first_bump / square, 0.0L}}, {}, {}};
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

namespace {

/// Imaginary part of the zeros that bound the first bump; real and imaginary part of the other pair: distances to x = 1.
using Unknowns = std::array<long double, 3>;

NearOptimalPolynomial with_zeros(NearOptimalPolynomial p, const Unknowns& u) {
    p.zeros[0].imaginary = u[0];
    p.zeros[1] = {1.0L - u[1], u[2]};
    return p;
}

long double largest(const Defects& f) noexcept { return std::max({std::abs(f[0]), std::abs(f[1]), std::abs(f[2])}); }

using Matrix = std::array<Defects, 3>;  // columns

long double determinant(const Matrix& m) noexcept {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[1][0] * (m[0][1] * m[2][2] - m[0][2] * m[2][1]) +
           m[2][0] * (m[0][1] * m[1][2] - m[0][2] * m[1][1]);
}

/// Newton's direction, with derivatives by differences.
Unknowns direction(const NearOptimalPolynomial& p, const Unknowns& u, const Defects& f) {
    Matrix derivatives;
    for (std::size_t k = 0; k < u.size(); ++k) {
        Unknowns moved = u;
        const long double by = 1e-8L * u[k];
        moved[k] += by;
        NearOptimalPolynomial other = with_zeros(p, moved);
        const Defects g = defects(other);
        for (std::size_t row = 0; row < f.size(); ++row) derivatives[k][row] = (g[row] - f[row]) / by;
    }
    Unknowns step{};
    for (std::size_t k = 0; k < u.size(); ++k) {
        Matrix replaced = derivatives;
        for (std::size_t row = 0; row < f.size(); ++row) replaced[k][row] = -f[row];
        step[k] = determinant(replaced) / determinant(derivatives);
    }
    return step;
}

}  // namespace

NearOptimalPolynomial near_optimal_polynomial_of_order_4(int degree) {
    require_degree(degree);
    const long double square = static_cast<long double>(degree) * degree;
    const NearOptimalPolynomial blank{degree, 1.0L + damping_4 / square, 1.0L, {{1.0L - first_bump_4(square) / square, 0.0L}, {}}, {}, {}};
    // Newton's method from where the zeros are for long polynomials; whole steps may overshoot for short ones.
    Unknowns u{7.52L / square, 1.55L / square, 20.4L / square};
    NearOptimalPolynomial p = with_zeros(blank, u);
    Defects now = defects(p);
    for (int iteration = 0; iteration < 30 && largest(now) > 1e-18L; ++iteration) {
        const Unknowns step = direction(blank, u, now);
        bool better = false;
        for (long double share = 1.0L; share > 1e-3L && !better; share *= 0.5L) {
            const Unknowns tried{u[0] + share * step[0], u[1] + share * step[1], u[2] + share * step[2]};
            NearOptimalPolynomial next = with_zeros(blank, tried);
            const Defects f = defects(next);
            better = largest(f) < largest(now);
            if (!better) continue;
            u = tried;
            now = f;
            p = next;
        }
        if (!better) break;
    }
    if (!(largest(now) < 1e-14L)) throw std::invalid_argument("no near-optimal polynomial of this degree was found");
    return p;
}

}  // namespace cvtflow::bench
