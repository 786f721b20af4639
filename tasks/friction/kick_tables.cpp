#include "tasks/friction/kick_tables.hpp"

#include "engine/method/chebyshev.hpp"
#include "engine/method/rkc.hpp"
#include "engine/method/tableau.hpp"

namespace cvtflow::tasks {

namespace {

// How much damping pays was tried on the baseline: less leaves friction forces behind, more costs stages.
constexpr double chebyshev_damping = 1.5, rkc_damping = 10.0;

KickTable table(Kick kind, int stages) {
    const bool first_order = kind == Kick::chebyshev;
    const engine::StagePlan plan =
        first_order ? engine::chebyshev(stages, chebyshev_damping) : engine::without_last_evaluation(engine::rkc(stages, rkc_damping));
    const engine::Tableau tableau = engine::unroll(plan);
    double centre = 0.0;
    for (std::size_t k = 0; k < tableau.weights.size(); ++k) centre += tableau.weights[k] * tableau.times[k];
    return {engine::CompiledPlan(plan), tableau.weights, centre, first_order ? engine::chebyshev_reach(stages, chebyshev_damping) : engine::rkc_reach(stages, rkc_damping)};
}

}  // namespace

KickTables::KickTables(Kick kind) {
    for (int stages = 2; stages <= engine::most_rkc_stages; stages += stages < 24 ? 1 : stages / 12) tables_.push_back(table(kind, stages));
}

const KickTable* KickTables::reaching(double z) const noexcept {
    for (const KickTable& table : tables_) {
        if (z <= table.reach) return &table;
    }
    return nullptr;
}

}  // namespace cvtflow::tasks
