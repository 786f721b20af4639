/// SERK2: ten blocks of Chebyshev recurrences, each restarted from the last stage of the block before; the result is a weighted sum of all
/// stages, which makes a near-optimal stability polynomial. All stages are kept until the end of the step.
/// Source: Kleefeld, Martin-Vaquero, SERK2v2: a new second-order stabilized explicit Runge-Kutta method for stiff problems,
/// Numer. Methods PDE 29 (2013) 170-185. Basis as published (alpha = 2.5/s²); the weights are computed here, for any multiple of ten.

#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>

#include "bench/method/family/near_optimal.hpp"
#include "bench/method/product_names.hpp"
#include "engine/method/stage_plan.hpp"

namespace cvtflow::bench {

namespace {

constexpr int block_count = 10;

using LongRow = std::vector<long double>;

/// Coefficients of R in Chebyshev's polynomials of x = 1 + alpha z.
LongRow chebyshev_coefficients(const NearOptimalPolynomial& p, long double alpha) {
    const auto points = static_cast<std::size_t>(p.degree) + 1;
    LongRow coefficients(points, 0.0L);
    for (std::size_t i = 0; i < points; ++i) {
        const long double angle = std::numbers::pi_v<long double> * (static_cast<long double>(i) + 0.5L) / static_cast<long double>(points);
        const long double value = p.value((std::cos(angle) - 1.0L) / alpha);
        for (std::size_t k = 0; k < points; ++k)
            coefficients[k] +=
                (k == 0 ? 1.0L : 2.0L) / static_cast<long double>(points) * value * std::cos(static_cast<long double>(k) * angle);
    }
    return coefficients;
}

/// T_n times a sum of Chebyshev's polynomials: T_n T_k = (T_{n+k} + T_{|n-k|})/2.
LongRow times(const LongRow& row, std::size_t n) {
    LongRow product(row.size() + n, 0.0L);
    for (std::size_t k = 0; k < row.size(); ++k) {
        product[n + k] += 0.5L * row[k];
        product[n > k ? n - k : k - n] += 0.5L * row[k];
    }
    return product;
}

/// Weights of the stages 0 … s: the stage of degree k = (i-1) m + j is T_m^(i-1) T_j, so weights follow from the highest degree down.
LongRow stage_weights(LongRow rest, std::size_t m) {
    std::vector<LongRow> starts{{1.0L}};
    for (int block = 1; block < block_count; ++block) starts.push_back(times(starts.back(), m));
    LongRow weights(rest.size(), 0.0L);
    for (std::size_t k = rest.size() - 1; k > 0; --k) {
        const LongRow stage = times(starts[(k - 1) / m], (k - 1) % m + 1);
        weights[k] = rest[k] / stage[k];
        for (std::size_t i = 0; i <= k; ++i) rest[i] -= weights[k] * stage[i];
    }
    weights[0] = rest[0];
    return weights;
}

int block_slope_slot(int k) { return k == 0 ? 0 : 1 + k % 2; }

/// Stage k of blocks of m: an Euler step at the beginning of a block, Chebyshev's recurrence within.
Stage recurrence(int k, int m, double length) {
    if ((k - 1) % m == 0) return {{{k - 1, 1.0}}, {{block_slope_slot(k - 1), length}}, k, block_slope_slot(k)};
    return {{{k - 1, 2.0}, {k - 2, -1.0}}, {{block_slope_slot(k - 1), 2.0 * length}}, k, block_slope_slot(k)};
}

/// The weighted sum of all stages, with the last one (never evaluated) written out; evaluated itself, for the next step and the error.
Stage end(const LongRow& weights, const Stage& last) {
    const std::size_t s = weights.size() - 1;
    std::vector<double> factors(s, 0.0);
    const auto weight = static_cast<double>(weights[s]);
    double rest = 1.0;
    for (std::size_t k = 1; k < s; ++k) factors[k] = static_cast<double>(weights[k]);
    for (const Term& term : last.states) factors[static_cast<std::size_t>(term.slot)] += weight * term.factor;
    for (std::size_t k = 1; k < s; ++k) rest -= factors[k];
    Stage stage{{{0, rest}}, {{last.slopes.front().slot, weight * last.slopes.front().factor}}, last.keep, last.slope};
    for (std::size_t k = 1; k < s; ++k) stage.states.push_back({static_cast<int>(k), factors[k]});
    return stage;
}

}  // namespace

StagePlan serk2(int stages) {
    const NearOptimalPolynomial p = near_optimal_polynomial(stages);
    const int m = stages / block_count;
    const long double alpha = 2.5L / (static_cast<long double>(stages) * stages);
    const LongRow weights = stage_weights(chebyshev_coefficients(p, alpha), static_cast<std::size_t>(m));
    StagePlan plan{"serk2-s" + std::to_string(stages),
                   "SERK2, stabilised along the real axis, by restarted Chebyshev recurrences",
                   "Kleefeld, Martin-Vaquero, Numer. Methods PDE 29 (2013) 170-185",
                   stages + 1,
                   3,
                   {{{{0, 1.0}}, {}, -1, 0}},
                   {},
                   {}};
    const auto length = static_cast<double>(alpha);
    for (int k = 1; k < stages; ++k) plan.stages.push_back(recurrence(k, m, length));
    plan.stages.push_back(end(weights, recurrence(stages, m, length)));
    plan.result = {{{stages, 1.0}}, {}};
    plan.error = Combination{{{0, 0.8}, {stages, -0.8}}, {{0, 0.4}, {block_slope_slot(stages), 0.4}}};
    return plan;
}

}  // namespace cvtflow::bench
