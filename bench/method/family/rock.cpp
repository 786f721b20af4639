/// ROCK2 and ROCK4: near-optimal stability polynomials of order 2 and 4 as stages.

#include "bench/method/family/families.hpp"

#include <array>
#include <cstddef>
#include <span>
#include <string>

#include "bench/method/family/near_optimal.hpp"
#include "bench/method/product_names.hpp"
#include "engine/method/stage_plan.hpp"

namespace cvtflow::bench {

// ROCK2: stages on the three-term recurrence of a near-optimal stability polynomial, then a finish of two stages that carries its pair of
// complex zeros: w(z) = 1 + 2 sigma z + tau z².
// Source: Abdulle, Medovikov, Numer. Math. 90 (2001) 1-18. The polynomials are computed here, not taken from the published program.

StagePlan rock2(int stages) {
    const NearOptimalPolynomial p = near_optimal_polynomial(stages);
    StagePlan plan{"rock2-s" + std::to_string(stages),
                   "ROCK2, stabilised along the real axis, by orthogonal polynomials",
                   "Abdulle, Medovikov, Numer. Math. 90 (2001) 1-18",
                   5,
                   4,
                   {{{{0, 1.0}}, {}, -1, 0}},
                   {},
                   {}};
    add_recurrence(plan, p.recurrence());
    const ZeroPair& zero = p.zeros.front();
    const long double d = p.origin - zero.real, size = d * d + zero.imaginary * zero.imaginary;
    const long double sigma = d / (p.scale * size), tau = 1.0L / (p.scale * p.scale * size);
    const int u = recurrence_state(stages - 2), f = recurrence_slope(stages - 2);
    const auto step = static_cast<double>(sigma), correction = static_cast<double>(sigma - tau / sigma);
    plan.stages.push_back({{{u, 1.0}}, {{f, step}}, 4, 3});
    plan.result = {{{4, 1.0}}, {{3, step - correction}, {f, correction}}};
    plan.error = Combination{{}, {{3, -correction}, {f, correction}}};
    return plan;
}

// ROCK4: stages on the three-term recurrence of a near-optimal stability polynomial of order 4, then a finish of four stages that carries
// its two pairs of complex zeros and makes the whole of order 4. Source: Abdulle, SIAM J. Sci. Comput. 23 (2002) 2041-2054. Polynomials
// and finish are computed here, not taken from the published program.

namespace {

using Real = long double;

/// Elementary weights by rooted tree: none; •; [•]; [• •], [[•]]; [• • •], [• [•]], [[• •]], [[[•]]]. The weights of the exact flow are
/// 1/density.
using Series = std::array<Real, 9>;

/// Weights of h f(g), g a state.
Series slope_of(const Series& g) noexcept { return {0.0L, 1.0L, g[1], g[1] * g[1], g[2], g[1] * g[1] * g[1], g[1] * g[2], g[3], g[4]}; }

/// Weights of the last stage of a recurrence, as it is rounded.
Series series_of(std::span<const RecurrenceRow> rows) noexcept {
    Series before{1.0L}, now{1.0L};
    for (const auto& [slope, older] : rows) {
        const Series f = slope_of(now);
        Series next{};
        for (std::size_t t = 0; t < next.size(); ++t) next[t] = (1.0 - older) * now[t] + older * before[t] + slope * f[t];
        before = now;
        now = next;
    }
    return now;
}

/// Order conditions of the finish by itself: sums over its stages, c times and d = Σ a c.
struct Moments {
    Real b, bc, bcc, bd;        ///< orders 1 to 3
    Real bccc, bcd, bacc, bad;  ///< order 4; Σ b a c², Σ b a d
};

/// Moments by the order conditions of the composition, one after the other. @param g series of the state where the finish begins
Moments moments(const Series& g) noexcept {
    const Real c = g[1], d = g[2];
    Moments m{};
    m.b = 1.0L - c;
    m.bc = 1.0L / 2.0L - d - c * m.b;
    m.bcc = 1.0L / 3.0L - g[3] - c * c * m.b - 2.0L * c * m.bc;
    m.bd = 1.0L / 6.0L - g[4] - d * m.b - c * m.bc;
    m.bccc = 1.0L / 4.0L - g[5] - c * c * c * m.b - 3.0L * c * c * m.bc - 3.0L * c * m.bcc;
    m.bcd = 1.0L / 8.0L - g[6] - c * d * m.b - (d + c * c) * m.bc - c * (m.bd + m.bcc);
    m.bacc = 1.0L / 12.0L - g[7] - g[3] * m.b - c * c * m.bc - 2.0L * c * m.bd;
    m.bad = 1.0L / 24.0L - g[8] - g[4] * m.b - d * m.bc - c * m.bd;
    return m;
}

/// Explicit tableau of four stages, and the error estimate Σ e f with the slope at the result as the fifth.
struct Finish {
    Real a21, a31, a32, a41, a42, a43;
    std::array<Real, 4> b;
    std::array<Real, 5> e;
};

/// Times of the second and third stage, as shares of the finish. Two of ten coefficients are free; these give the least error of order 5 of
/// those whose stages do not exceed the step's start (from 12 stages on; 1.7 times at 5).
constexpr Real second_time = 0.87L, third_time = 0.56L;

/// Weight of the slope at the result in the error estimate: the embedded method then misses the fourth power of z by a sixteenth.
constexpr Real estimate_weight = 0.1L;

/// x y z such that Σ factor (x, y, z) over three times, times squared, and 0, d3, d4 are the right-hand side.
std::array<Real, 3> estimate(Real c2, Real c3, Real c4, Real d3, Real d4, std::array<Real, 3> right) noexcept {
    // Eliminates the second stage from the rows of times.
    const Real p3 = c3 * (c3 - c2), p4 = c4 * (c4 - c2), p = right[1] - c2 * right[0];
    const Real size = p3 * d4 - p4 * d3;
    const Real x3 = (p * d4 - p4 * right[2]) / size, x4 = (p3 * right[2] - p * d3) / size;
    return {(right[0] - c3 * x3 - c4 * x4) / c2, x3, x4};
}

/// Solves the eight conditions in closed form: b from the moments of times, then a32 and the sum of a42 and a43 from those of d, then a43;
/// the last condition leaves one equation, linear in each of c2 and c4 and without c3.
Finish finish_of(const Moments& m) noexcept {
    const Real c2 = second_time * m.b, c3 = third_time * m.b;
    const Real c4 = (m.bad * m.bccc - m.bad * m.bcc * c2 - m.bacc * m.bcd + c2 * m.bd * m.bcd) /
                    (c2 * m.bd * m.bd - m.bd * m.bacc + m.bad * m.bcc - c2 * m.bad * m.bc);
    const auto weight = [&](Real at, Real one, Real other) {
        return (m.bccc - (one + other) * m.bcc + one * other * m.bc) / (at * (at - one) * (at - other));
    };
    const Real b2 = weight(c2, c3, c4), b3 = weight(c3, c2, c4), b4 = weight(c4, c2, c3);
    const Real d3 = (c4 * m.bd - m.bcd) / (b3 * (c4 - c3)), d4 = (m.bd - b3 * d3) / b4;
    Finish f{};
    f.b = {m.b - b2 - b3 - b4, b2, b3, b4};
    f.a21 = c2;
    f.a32 = d3 / c2;
    f.a31 = c3 - f.a32;
    f.a43 = (m.bacc - c2 * m.bd) / (b4 * c3 * (c3 - c2));
    f.a42 = (d4 - f.a43 * c3) / c2;
    f.a41 = c4 - f.a42 - f.a43;
    // No power of h below the fourth; the result is a stage at the time m.b, its d is m.bc.
    const auto [e2, e3, e4] = estimate(c2, c3, c4, d3, d4, {-estimate_weight * m.b, -estimate_weight * m.b * m.b, -estimate_weight * m.bc});
    f.e = {-estimate_weight - e2 - e3 - e4, e2, e3, e4, estimate_weight};
    return f;
}

Term term(int slot, Real factor) { return {slot, static_cast<double>(factor)}; }

/// @param last number of the recurrence's last stage
void add_finish(StagePlan& plan, const Finish& f, int last) {
    const int u = recurrence_state(last), end = recurrence_state(last + 1);
    const std::array<int, 5> k{recurrence_slope(last), recurrence_slope(last + 1), 3, 4, 5};
    const std::vector<Term> from{{u, 1.0}};
    plan.stages.push_back({from, {term(k[0], f.a21)}, -1, k[1]});
    plan.stages.push_back({from, {term(k[0], f.a31), term(k[1], f.a32)}, -1, k[2]});
    plan.stages.push_back({from, {term(k[0], f.a41), term(k[1], f.a42), term(k[2], f.a43)}, -1, k[3]});
    plan.stages.push_back({from, {term(k[0], f.b[0]), term(k[1], f.b[1]), term(k[2], f.b[2]), term(k[3], f.b[3])}, end, k[4]});
    plan.result = {{{end, 1.0}}, {}};
    plan.error = Combination{{}, {}};
    for (std::size_t i = 0; i < k.size(); ++i) plan.error->slopes.push_back(term(k[i], f.e[i]));
}

}  // namespace

StagePlan rock4(int stages) {
    const std::vector<RecurrenceRow> rows = near_optimal_polynomial_of_order_4(stages).recurrence();
    StagePlan plan{"rock4-s" + std::to_string(stages),
                   "ROCK4, stabilised along the real axis, by orthogonal polynomials",
                   "Abdulle, SIAM J. Sci. Comput. 23 (2002) 2041-2054",
                   4,
                   6,
                   {{{{0, 1.0}}, {}, -1, 0}},
                   {},
                   {}};
    add_recurrence(plan, rows);
    add_finish(plan, finish_of(moments(series_of(rows))), stages - 4);
    return plan;
}

}  // namespace cvtflow::bench
