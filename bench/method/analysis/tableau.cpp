#include "bench/method/analysis/tableau.hpp"

#include <cstddef>
#include <utility>

#include "bench/method/analysis/plan_check.hpp"
#include "bench/method/product_names.hpp"
#include "engine/method/compiled_plan.hpp"

namespace cvtflow::bench {

Tableau unroll(const StagePlan& plan) {
    validate(plan);
    const CompiledPlan compiled(plan);
    const auto stages = static_cast<std::size_t>(compiled.stages());
    std::vector<std::vector<double>> rows = compiled.unrolled();
    Tableau tableau{compiled.stages(), {}, {}, {}, {}};
    for (std::size_t i = 0; i < stages; ++i) {
        tableau.times.push_back(compiled.stage(static_cast<int>(i)).time);
        tableau.matrix.insert(tableau.matrix.end(), rows[i].begin(), rows[i].end());
    }
    tableau.weights = std::move(rows[stages]);
    if (!compiled.has_error()) return tableau;
    tableau.embedded = tableau.weights;
    for (std::size_t j = 0; j < stages; ++j) tableau.embedded[j] -= rows[stages + 1][j];
    return tableau;
}

}  // namespace cvtflow::bench
