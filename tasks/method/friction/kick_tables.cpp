#include "tasks/method/friction/kick_tables.hpp"

#include <stdexcept>

#include "engine/method/family/chebyshev.hpp"
#include "engine/method/family/rkc.hpp"
#include "engine/method/table/tableau.hpp"

namespace cvtflow::tasks {

namespace {

// How much damping pays was tried on the baseline: less leaves friction forces behind, more costs stages.
constexpr double chebyshev_damping = 1.5, rkc_damping = 10.0;

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

KickTable table(Kick kind, int stages) {
    const bool first_order = kind == Kick::chebyshev;
    const engine::StagePlan plan =
        first_order ? engine::chebyshev(stages, chebyshev_damping) : engine::without_last_evaluation(engine::rkc(stages, rkc_damping));
    const engine::Tableau tableau = engine::unroll(plan);
    double centre = 0.0;
    for (std::size_t k = 0; k < tableau.weights.size(); ++k) centre += tableau.weights[k] * tableau.times[k];
    const engine::CompiledPlan compiled(plan);
    return {compiled, tableau.weights, centre,
            first_order ? engine::chebyshev_reach(stages, chebyshev_damping) : engine::rkc_reach(stages, rkc_damping),
            keeps_first_slope(compiled)};
}

}  // namespace

KickTables::KickTables(Kick kind) {
    for (int stages = 2; stages <= engine::max_rkc_stages; stages += stages < 24 ? 1 : stages / 12) tables_.push_back(table(kind, stages));
}

const KickTable* KickTables::reaching(double z) const noexcept {
    for (const KickTable& table : tables_) {
        if (z <= table.reach) return &table;
    }
    return nullptr;
}

}  // namespace cvtflow::tasks
