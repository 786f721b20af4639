#include "engine/method/chebyshev.hpp"

#include <stdexcept>

namespace cvtflow::engine {

namespace {

/// T_j(w0), T_j'(w0) for j = 0 … stages.
struct Polynomials {
    std::vector<double> value{1.0}, first{0.0};
    double w0;

    Polynomials(int stages, double damping) : w0(1.0 + damping / (static_cast<double>(stages) * stages)) {
        value.push_back(w0);
        first.push_back(1.0);
        for (std::size_t j = 2; j <= static_cast<std::size_t>(stages); ++j) {
            value.push_back(2.0 * w0 * value[j - 1] - value[j - 2]);
            first.push_back(2.0 * value[j - 1] + 2.0 * w0 * first[j - 1] - first[j - 2]);
        }
    }
};

[[nodiscard]] int state_slot(int j) { return j == 0 ? 0 : 1 + (j - 1) % 3; }
[[nodiscard]] int slope_slot(int j) { return j == 0 ? 0 : 1 + (j - 1) % 2; }

}  // namespace

StagePlan chebyshev(int stages, double damping) {
    if (stages < 2 || damping < 0.0) throw std::invalid_argument("Chebyshev methods have 2 stages or more and no negative damping");
    const Polynomials t(stages, damping);
    const double w1 = t.value.back() / t.first.back();
    const auto state = [&](int j) -> Combination {
        if (j == 0) return {{{0, 1.0}}, {}};
        if (j == 1) return {{{0, 1.0}}, {{0, w1 / t.w0}}};
        const auto i = static_cast<std::size_t>(j);
        return {{{state_slot(j - 1), 2.0 * t.w0 * t.value[i - 1] / t.value[i]}, {state_slot(j - 2), -t.value[i - 2] / t.value[i]}},
                {{slope_slot(j - 1), 2.0 * w1 * t.value[i - 1] / t.value[i]}}};
    };
    StagePlan plan;
    plan.name = "chebyshev-s" + std::to_string(stages);
    plan.description = "Chebyshev, order 1, strongly damped";
    plan.source = "van der Houwen, Sommeijer, Z. Angew. Math. Mech. 60 (1980) 479-485";
    plan.state_slots = 4;
    plan.slope_slots = 3;
    for (int j = 0; j < stages; ++j) {
        const Combination c = state(j);
        plan.stages.push_back({c.states, c.slopes, j == 0 ? -1 : state_slot(j), slope_slot(j)});
    }
    plan.result = state(stages);
    return plan;
}

double chebyshev_reach(int stages, double damping) {
    const Polynomials t(stages, damping);
    return (t.w0 + 1.0) * t.first.back() / t.value.back();
}

}  // namespace cvtflow::engine
