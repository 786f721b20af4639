#include "tasks/method/friction/kick_tables.hpp"

#include <utility>

#include "engine/method/chebyshev.hpp"
#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

namespace {

constexpr int most_stages = 400;
/// How much damping pays was tried on the baseline: less leaves friction forces behind, more costs stages [1].
constexpr double damping = 1.5;

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

const Kick chebyshev_kick{[](int stages) { return engine::chebyshev(stages, damping); },
                          [](int stages) { return engine::chebyshev_reach(stages, damping); }};

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
