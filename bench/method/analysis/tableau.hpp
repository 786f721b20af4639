#pragma once
/// The Butcher tableau that a plan is equivalent to, with chained states unrolled. For analysis; the step loop never uses it.

#include <cstddef>
#include <vector>

#include "engine/method/stage_plan.hpp"

namespace cvtflow::bench {

struct Tableau {
    int stages = 0;
    std::vector<double> times;     ///< c, propagated through the slots   [stages]
    std::vector<double> matrix;    ///< A, row by row                     [stages × stages]
    std::vector<double> weights;   ///< b                                 [stages]
    std::vector<double> embedded;  ///< b̂ = b - weights of the error estimate, empty without one

    [[nodiscard]] double entry(int row, int column) const {
        return matrix[static_cast<std::size_t>(row) * weights.size() + static_cast<std::size_t>(column)];
    }
};

/// @throws std::invalid_argument as validate()
[[nodiscard]] Tableau unroll(const engine::StagePlan& plan);

}  // namespace cvtflow::bench
