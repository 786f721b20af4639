#pragma once
/// Tables for the friction of a step, from few stages to many, and which of them a step needs.

#include <vector>

#include "engine/method/compiled_plan.hpp"

namespace cvtflow::tasks {

/// Which family of tables.
enum class Kick {
    chebyshev,   ///< order 1, strongly damped: what friction holds is at rest after one step
    rkc,         ///< order 2, damped more than usual
};

/// One table with what a kick needs to know of it.
struct KickTable {
    engine::CompiledPlan plan;
    std::vector<double> weights;   ///< of its stages in the result
    double centre;                 ///< Σ weight × time of the stages: where a slope that is linear in time has its mean
    double reach;                  ///< |h λ| on the real axis up to which it is stable

    /// A slope at a stage's time, in units of the difference between its last two values: without an impulse, and half a rise at the end of the
    /// step. @param rise how much it changes over the step, in the same units
    [[nodiscard]] double lean(double time, double rise) const noexcept { return 0.5 * rise * (time - centre) / (1.0 - centre); }
};

class KickTables {
public:
    explicit KickTables(Kick kind);

    /// The cheapest table that reaches z = h |λ|; nullptr if none does.
    [[nodiscard]] const KickTable* reaching(double z) const noexcept;
    [[nodiscard]] double longest_reach() const noexcept { return tables_.back().reach; }

private:
    std::vector<KickTable> tables_;   ///< ascending
};

/// State and slope slots that any table of either family uses.
inline constexpr int kick_state_slots = 4, kick_slope_slots = 3;

}  // namespace cvtflow::tasks
