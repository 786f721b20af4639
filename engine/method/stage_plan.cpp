#include "engine/method/stage_plan.hpp"

#include <cstddef>
#include <stdexcept>
#include <utility>

namespace cvtflow::engine {

namespace {

std::vector<Term> nonzero(const std::vector<double>& row) {
    std::vector<Term> terms;
    for (std::size_t j = 0; j < row.size(); ++j) {
        if (row[j] != 0.0) terms.push_back({static_cast<int>(j), row[j]});
    }
    return terms;
}

}  // namespace

StagePlan butcher_plan(std::string name, std::string description, std::string source, const std::vector<std::vector<double>>& rows,
                       const std::vector<double>& weights, const std::vector<double>& embedded) {
    const std::size_t stages = rows.size() + 1;
    if (weights.size() != stages || (!embedded.empty() && embedded.size() != stages)) {
        throw std::invalid_argument(name + ": a tableau of " + std::to_string(stages) + " stages needs as many weights");
    }
    StagePlan plan{
        std::move(name), std::move(description), std::move(source), 1, static_cast<int>(stages), {{{{0, 1.0}}, {}, -1, 0}}, {}, {}};
    for (std::size_t i = 1; i < stages; ++i) {
        if (rows[i - 1].size() > i)
            throw std::invalid_argument(plan.name + ": stage " + std::to_string(i) + ": the tableau is not explicit");
        plan.stages.push_back({{{0, 1.0}}, nonzero(rows[i - 1]), -1, static_cast<int>(i)});
    }
    plan.result = {{{0, 1.0}}, nonzero(weights)};
    if (embedded.empty()) return plan;
    std::vector<double> difference = weights;
    for (std::size_t i = 0; i < stages; ++i) difference[i] -= embedded[i];
    plan.error = Combination{{}, nonzero(difference)};
    return plan;
}

}  // namespace cvtflow::engine
