/// ROCK2: stages on the three-term recurrence of a near-optimal stability polynomial, then a finish of two stages that carries its pair of
/// complex zeros: w(z) = 1 + 2 sigma z + tau z².
/// Source: Abdulle, Medovikov, Numer. Math. 90 (2001) 1-18. The polynomials are computed here, not taken from the published program.

#include <cmath>
#include <string>

#include "engine/method/near_optimal.hpp"
#include "engine/method/stage_plan.hpp"

namespace cvtflow::engine {

namespace {

int rock2_state_slot(int j) { return 1 + (j - 1) % 3; }

/// Stage values g_1 … g_{s-2}; the last one is in rock2_state_slot(stages - 2), its slope in slot 1.
void add_recurrence(StagePlan& plan, const NearOptimalPolynomial& p) {
    const int last = p.degree - 2;
    long double before = 0.0L, ratio_before = 0.0L, now = 1.0L;  // monic polynomials at the origin
    for (int j = 1; j <= last; ++j) {
        const auto i = static_cast<std::size_t>(j - 1);
        const long double next = (p.origin - p.centre[i]) * now - p.coupling[i] * before;
        const long double ratio = now / next;
        const auto slope = static_cast<double>(ratio / p.scale);
        const auto older = static_cast<double>(-p.coupling[i] * ratio * ratio_before);
        const Term slope_before{j == 1 ? 0 : 1 + (j - 1) % 2, slope};
        Stage stage{{{0, 1.0}}, {slope_before}, rock2_state_slot(j), 1 + j % 2};
        if (j == 2) stage.states = {{rock2_state_slot(1), 1.0 - older}, {0, older}};
        if (j > 2) stage.states = {{rock2_state_slot(j - 1), 1.0 - older}, {rock2_state_slot(j - 2), older}};
        plan.stages.push_back(stage);
        ratio_before = ratio;
        before = now;
        now = next;
    }
}

}  // namespace

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
    add_recurrence(plan, p);
    const long double d = p.origin - p.zero_real, size = d * d + p.zero_imaginary * p.zero_imaginary;
    const long double sigma = d / (p.scale * size), tau = 1.0L / (p.scale * p.scale * size);
    const int u = rock2_state_slot(stages - 2), f = 1 + (stages - 2) % 2;
    const auto step = static_cast<double>(sigma), correction = static_cast<double>(sigma - tau / sigma);
    plan.stages.push_back({{{u, 1.0}}, {{f, step}}, 4, 3});
    plan.result = {{{4, 1.0}}, {{3, step - correction}, {f, correction}}};
    plan.error = Combination{{}, {{3, -correction}, {f, correction}}};
    return plan;
}

}  // namespace cvtflow::engine
