#pragma once
/// Analysis of a table of stages: whether it can be executed, the tableau that it is equivalent to, and its order.

#include <cstddef>
#include <string>
#include <vector>

#include "bench/method/product_names.hpp"
#include "engine/method/stage_plan.hpp"

namespace cvtflow::bench {

// Whether a table of stages can be executed. The product's are constant, and a test checks them; those of the laboratory are checked where
// their order is derived.

/// Rejects a plan that cannot be executed, or whose result would depend on how the state is cut into segments:
/// slots out of range, sums of state factors other than 1 (error: 0) by more than 1e-12, slots read before they are written, slots written
/// in the stage that reads them (a neighbour's halo is combined from the old contents at the same time), and writes to the two slots 0.
/// @throws std::invalid_argument naming plan and stage
void validate(const engine::StagePlan& plan);

// The Butcher tableau that a plan is equivalent to, with chained states unrolled. For analysis; the step loop never uses it.

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

// The order of a method, from Butcher's rooted-tree conditions: b·g(τ) = 1/γ(τ) for every rooted tree τ with up to p nodes.
// Source: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, II.2.

inline constexpr int highest_order = 8;

/// A rooted tree as the multiset of its subtrees, given by their place in the list that contains it.
struct RootedTree {
    int nodes;
    double density;             ///< γ = nodes Π γ(children) [1]
    std::vector<int> children;  ///< ascending
};

/// All rooted trees with up to `nodes` nodes, ascending by nodes: 1, 1, 2, 4, 9, 20, 48, 115 … of them.
[[nodiscard]] std::vector<RootedTree> rooted_trees(int nodes);

/// max |c - A 1|: zero up to rounding, or an autonomous and a non-autonomous problem would be solved differently.
[[nodiscard]] double time_defect(const Tableau& tableau);

/// Whether the last stage is evaluated at the result, so that its slope is the next step's slope 0.
[[nodiscard]] bool last_stage_is_result(const Tableau& tableau, double tolerance = 1e-12);

/// Highest p ≤ highest_order such that all conditions up to p hold within the tolerance; 0 for an inconsistent method.
/// The stage times must be consistent too, or the order would hold for autonomous problems only: then 0. tolerance [1]
[[nodiscard]] int order_of(const Tableau& tableau, const std::vector<double>& weights, double tolerance = 1e-10);

/// Order of the result. tolerance [1]
[[nodiscard]] int order_of(const StagePlan& plan, double tolerance = 1e-10);
/// Order of the embedded solution (result minus error estimate); 0 without an error estimate. tolerance [1]
[[nodiscard]] int embedded_order_of(const StagePlan& plan, double tolerance = 1e-10);

/// 5, or 5(4) with an embedded solution; "3 to 3e-06" if the conditions of the last order have that defect.
[[nodiscard]] std::string order_text(const StagePlan& plan);

}  // namespace cvtflow::bench
