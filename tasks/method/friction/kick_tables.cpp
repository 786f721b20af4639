#include "tasks/method/friction/kick_tables.hpp"

#include <utility>

#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

namespace {

constexpr int most_stages = 400;
/// Damping of the tables, by trial on the baseline: less leaves residual friction forces, more costs stages.
constexpr double damping = 1.5;

/// T_j(w0), T_j'(w0) for j = 0 … stages.
struct ChebyshevValues {
    std::vector<double> value{1.0}, first{0.0};
    double w0;

    explicit ChebyshevValues(int stages) : w0(1.0 + damping / (static_cast<double>(stages) * stages)) {
        value.push_back(w0);
        first.push_back(1.0);
        for (std::size_t j = 2; j <= at(stages); ++j) {
            value.push_back(2.0 * w0 * value[j - 1] - value[j - 2]);
            first.push_back(2.0 * value[j - 1] + 2.0 * w0 * first[j - 1] - first[j - 2]);
        }
    }
};

/// R(z) = T_s(w0 + w1 z)/T_s(w0): |R| ≤ 1/cosh(sqrt(2 ε)), about, inside the interval, with ε the damping. Behind those of the start,
/// three slots of velocities and two of slopes take turns.
engine::StagePlan chebyshev(int stages) {
    const ChebyshevValues t(stages);
    const double w1 = t.value.back() / t.first.back();
    const auto state_slot = [](int j) { return j == 0 ? 0 : 1 + (j - 1) % 3; };
    const auto slope_slot = [](int j) { return j == 0 ? 0 : 1 + (j - 1) % 2; };
    const auto state = [&](int j) -> engine::Combination {
        if (j == 0) return {{{0, 1.0}}, {}};
        if (j == 1) return {{{0, 1.0}}, {{0, w1 / t.w0}}};
        const std::size_t i = at(j);
        return {{{state_slot(j - 1), 2.0 * t.w0 * t.value[i - 1] / t.value[i]}, {state_slot(j - 2), -t.value[i - 2] / t.value[i]}},
                {{slope_slot(j - 1), 2.0 * w1 * t.value[i - 1] / t.value[i]}}};
    };
    engine::StagePlan plan;
    plan.name = "chebyshev-s" + std::to_string(stages);
    plan.state_slots = kick_state_slots;
    plan.slope_slots = kick_slope_slots;
    for (int j = 0; j < stages; ++j) {
        const engine::Combination c = state(j);
        plan.stages.push_back({c.states, c.slopes, j == 0 ? -1 : state_slot(j), slope_slot(j)});
    }
    plan.result = state(stages);
    return plan;
}

double chebyshev_reach(int stages) {
    const ChebyshevValues t(stages);
    return (t.w0 + 1.0) * t.first.back() / t.value.back();
}

/// Whether rows after the second use the slope of stage 0.
bool keeps_first_slope(const engine::CompiledPlan& plan) {
    bool keeps = false;
    for (int row = 1; row <= plan.stages(); ++row) {
        const engine::PlanStep next = row < plan.stages() ? plan.stage(row) : plan.result();
        for (const engine::Term& term : next.slopes) keeps = keeps || term.slot != plan.stage(row - 1).slope;
    }
    return keeps;
}

KickTable table_of(const Kick& kick, int stages) {
    const engine::CompiledPlan plan(kick.plan(stages));
    std::vector<double> weights = std::move(plan.unrolled()[at(plan.stages())]);
    double centre = 0.0;
    for (int k = 0; k < plan.stages(); ++k) centre += weights[at(k)] * plan.stage(k).time;
    return {plan, std::move(weights), centre, kick.reach(stages), keeps_first_slope(plan)};
}

}  // namespace

const Kick chebyshev_kick{chebyshev, chebyshev_reach};

KickTables::KickTables(const Kick& kick) {
    for (int stages = 2; stages <= most_stages; stages += stages < 24 ? 1 : stages / 12) tables_.push_back(table_of(kick, stages));
}

const KickTable* KickTables::reaching(double z) const noexcept {
    for (const KickTable& table : tables_) {
        if (z <= table.reach) return &table;
    }
    return nullptr;
}

}  // namespace cvtflow::tasks
