/// Extrapolation methods as plans: the sequences of sub-steps are unrolled, the extrapolated result is one set of weights.
/// Source: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, II.9. Results T_j of n_j sub-steps are combined by
/// Lagrange's formula at step zero: T = Σ_j T_j Π_{i≠j} n_j^q / (n_j^q - n_i^q), q = 1 for Euler's method, 2 for the midpoint rule,
/// whose error has even powers only. Error estimate: the difference to the result without the coarsest sequence.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "bench/method/product_names.hpp"
#include "engine/method/stage_plan.hpp"

namespace cvtflow::bench {

namespace {

using Row = std::vector<double>;

/// Lagrange's weights of the sequences first, first + 1, …; 0 for earlier ones.
Row sequence_weights(const std::vector<int>& sub_steps, std::size_t first, int power) {
    Row weights(sub_steps.size(), 0.0);
    for (std::size_t j = first; j < sub_steps.size(); ++j) {
        weights[j] = 1.0;
        const double term = std::pow(sub_steps[j], power);
        for (std::size_t i = first; i < sub_steps.size(); ++i) {
            if (i != j) weights[j] *= term / (term - std::pow(sub_steps[i], power));
        }
    }
    return weights;
}

/// The tableau as it grows: rows of stages 1, 2, … and for each sequence the row of its result.
struct Unrolling {
    std::vector<Row> rows;
    std::vector<Row> results;

    /// Copy of a row with `factor` for the slope of the newest stage.
    [[nodiscard]] static Row with(const Row& row, std::size_t stage, double factor) {
        Row longer(stage + 1, 0.0);
        std::copy(row.begin(), row.end(), longer.begin());
        longer[stage] += factor;
        return longer;
    }
};

/// n Euler steps.
void add_euler(Unrolling& tableau, int n) {
    Row row = Unrolling::with({}, 0, 1.0 / n);
    for (int step = 1; step < n; ++step) {
        tableau.rows.push_back(row);
        row = Unrolling::with(row, tableau.rows.size(), 1.0 / n);
    }
    tableau.results.push_back(std::move(row));
}

/// One Euler step, then n - 1 steps of the midpoint rule; n even, no smoothing at the end.
void add_midpoint(Unrolling& tableau, int n) {
    Row before;
    Row row = Unrolling::with({}, 0, 1.0 / n);
    for (int step = 1; step < n; ++step) {
        tableau.rows.push_back(row);
        before = Unrolling::with(before, tableau.rows.size(), 2.0 / n);
        std::swap(before, row);
    }
    tableau.results.push_back(std::move(row));
}

/// Σ weights_j (result of sequence j).
Row weighted(const Unrolling& tableau, const Row& weights) {
    Row sum(tableau.rows.size() + 1, 0.0);
    for (std::size_t j = 0; j < weights.size(); ++j) {
        for (std::size_t stage = 0; stage < tableau.results[j].size(); ++stage) sum[stage] += weights[j] * tableau.results[j][stage];
    }
    return sum;
}

}  // namespace

/// Explicit Euler with 1, 2, …, order sub-steps.
StagePlan extrapolated_euler(int order) {
    Unrolling tableau;
    std::vector<int> sub_steps;
    for (int n = 1; n <= order; ++n) {
        sub_steps.push_back(n);
        add_euler(tableau, n);
    }
    return butcher_plan("euler-x" + std::to_string(order), "Euler's method extrapolated to order " + std::to_string(order),
                        "Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, II.9", tableau.rows,
                        weighted(tableau, sequence_weights(sub_steps, 0, 1)), weighted(tableau, sequence_weights(sub_steps, 1, 1)));
}

/// Gragg, Bulirsch and Stoer with 2, 4, …, order sub-steps; order even.
StagePlan gragg_bulirsch_stoer(int order) {
    Unrolling tableau;
    std::vector<int> sub_steps;
    for (int n = 2; n <= order; n += 2) {
        sub_steps.push_back(n);
        add_midpoint(tableau, n);
    }
    return butcher_plan("gbs" + std::to_string(order), "midpoint rule extrapolated to order " + std::to_string(order),
                        "Gragg, SIAM J. Numer. Anal. 2 (1965) 384-403; Bulirsch and Stoer, Numer. Math. 8 (1966) 1-13", tableau.rows,
                        weighted(tableau, sequence_weights(sub_steps, 0, 2)), weighted(tableau, sequence_weights(sub_steps, 1, 2)));
}

}  // namespace cvtflow::bench
