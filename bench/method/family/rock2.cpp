/// ROCK2: stages on the three-term recurrence of a near-optimal stability polynomial, then a finish of two stages that carries its pair of
/// complex zeros: w(z) = 1 + 2 sigma z + tau z².
/// Source: Abdulle, Medovikov, Numer. Math. 90 (2001) 1-18. The polynomials are computed here, not taken from the published program.

#include <string>

#include "bench/method/family/near_optimal.hpp"
#include "bench/method/product_names.hpp"
#include "engine/method/stage_plan.hpp"

namespace cvtflow::bench {

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

}  // namespace cvtflow::bench
