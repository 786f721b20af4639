#include "engine/method/tableau.hpp"

#include <cstddef>

#include "engine/method/compiled_plan.hpp"

namespace cvtflow::engine {

namespace {

using Row = std::vector<double>;

/// Contents of slots while a plan is executed symbolically: a state is y plus h times a row over the stages' slopes.
struct Unrolled {
    std::vector<Row> states;         ///< [state slot][stage]
    std::vector<std::size_t> owner;  ///< [slope slot] → stage that wrote it last

    [[nodiscard]] Row combine(const PlanStep& step, std::size_t stages) const {
        Row row(stages, 0.0);
        for (const Term& term : step.states) {
            const Row& from = states[static_cast<std::size_t>(term.slot)];
            for (std::size_t j = 0; j < stages; ++j) row[j] += term.factor * from[j];
        }
        for (const Term& term : step.slopes) row[owner[static_cast<std::size_t>(term.slot)]] += term.factor;
        return row;
    }
};

}  // namespace

Tableau unroll(const StagePlan& plan) {
    const CompiledPlan compiled(plan);
    const auto stages = static_cast<std::size_t>(compiled.stages());
    Unrolled slots{std::vector<Row>(static_cast<std::size_t>(plan.state_slots), Row(stages, 0.0)),
                   std::vector<std::size_t>(static_cast<std::size_t>(plan.slope_slots), 0)};
    Tableau tableau{compiled.stages(), {}, {}, {}, {}};
    for (std::size_t i = 0; i < stages; ++i) {
        const PlanStep step = compiled.stage(static_cast<int>(i));
        Row row = slots.combine(step, stages);
        tableau.times.push_back(step.time);
        tableau.matrix.insert(tableau.matrix.end(), row.begin(), row.end());
        slots.owner[static_cast<std::size_t>(step.slope)] = i;
        if (step.keep >= 0) slots.states[static_cast<std::size_t>(step.keep)] = std::move(row);
    }
    tableau.weights = slots.combine(compiled.result(), stages);
    if (!compiled.has_error()) return tableau;
    tableau.embedded = tableau.weights;
    const Row difference = slots.combine(compiled.error(), stages);
    for (std::size_t j = 0; j < stages; ++j) tableau.embedded[j] -= difference[j];
    return tableau;
}

}  // namespace cvtflow::engine
