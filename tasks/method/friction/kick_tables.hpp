#pragma once
/// Tables for the friction of a step, from few stages to many, and which of them a step needs.

#include <vector>

#include "engine/method/compiled_plan.hpp"

namespace cvtflow::tasks {

/// A family of tables. Each row of a table combines velocities that are kept, the slope of the stage before it, and maybe that of stage 0,
/// which is not checked.
struct Kick {
    engine::StagePlan (*plan)(int stages);
    double (*reach)(int stages);  ///< |h λ| on the real axis up to which it is stable [1]
};

/// Chebyshev methods of order 1, strongly damped: what friction holds is at rest after one step.
/// Source: van der Houwen, Sommeijer, On the internal stability of explicit, m-stage Runge-Kutta methods for large m-values,
/// Z. Angew. Math. Mech. 60 (1980) 479-485.
extern const Kick chebyshev_kick;

/// One stage with the row that follows it: a stage, or the result.
struct KickRow {
    engine::PlanStep here, next;
    double weight = 0.0;  ///< weight of the stage in the result
    bool keeps_slope = false;
};

/// One table with what a kick needs to know of it.
struct KickTable {
    engine::CompiledPlan plan;
    std::vector<double> weights;  ///< weights of the stages in the result
    double centre;                ///< Σ weight × time of the stages: where a slope that is linear in time has its mean
    double reach;                 ///< |h λ| on the real axis up to which it is stable [1]
    bool keeps_first_slope;       ///< whether rows after the second use the slope of stage 0

    /// A slope at a stage's time, in units of the difference between its last two values: without an impulse, and half a rise at the end of
    /// the step. @param rise how much it changes over the step, in the same units
    [[nodiscard]] double extrapolation(double time, double rise) const noexcept { return 0.5 * rise * (time - centre) / (1.0 - centre); }
    [[nodiscard]] KickRow row(int stage) const noexcept {
        return {plan.stage(stage), stage + 1 < plan.stages() ? plan.stage(stage + 1) : plan.result(),
                weights[static_cast<std::size_t>(stage)], stage == 0 && keeps_first_slope};
    }
};

/// Tables of 2 to 400 stages.
class KickTables {
public:
    explicit KickTables(const Kick& kick);

    /// The cheapest table that reaches z = h |λ|; nullptr if none does. z [1]
    [[nodiscard]] const KickTable* reaching(double z) const noexcept;
    [[nodiscard]] double longest_reach() const noexcept { return tables_.back().reach; }

private:
    std::vector<KickTable> tables_;  ///< ascending
};

/// State and slope slots that any plan of a family uses.
inline constexpr int kick_state_slots = 4, kick_slope_slots = 3;

}  // namespace cvtflow::tasks
