#include "tasks/method/friction/kick_tables.hpp"

#include <stdexcept>

#include "engine/method/chebyshev.hpp"
#include "engine/method/tableau.hpp"

namespace cvtflow::tasks {

namespace {

constexpr int most_stages = 400;
/// How much damping pays was tried on the baseline: less leaves friction forces behind, more costs stages [1].
constexpr double damping = 1.5;

/// Whether rows after the second use the slope of stage 0.
/// @throws std::logic_error if the plan is not chained
bool keeps_first_slope(const engine::CompiledPlan& plan) {
    bool keeps = false;
    for (int row = 1; row <= plan.stages(); ++row) {
        const engine::PlanStep next = row < plan.stages() ? plan.stage(row) : plan.result();
        if (row < plan.stages() && next.keep < 0) throw std::logic_error("a stage of a chained table keeps its velocities");
        for (const engine::Term& term : next.slopes) {
            if (term.slot == plan.stage(row - 1).slope) continue;
            if (term.slot != 0) throw std::logic_error("a row of a chained table uses the slopes of the stage before it and of stage 0");
            keeps = true;
        }
    }
    return keeps;
}

KickTable table_of(const Kick& kick, int stages) {
    const engine::StagePlan plan = kick.plan(stages);
    const engine::Tableau tableau = engine::unroll(plan);
    double centre = 0.0;
    for (std::size_t k = 0; k < tableau.weights.size(); ++k) centre += tableau.weights[k] * tableau.times[k];
    const engine::CompiledPlan compiled(plan);
    return {compiled, tableau.weights, centre, kick.reach(stages), keeps_first_slope(compiled)};
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
