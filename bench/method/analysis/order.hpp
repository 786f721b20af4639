#pragma once
/// The order of a method, from Butcher's rooted-tree conditions: b·g(τ) = 1/γ(τ) for every rooted tree τ with up to p nodes.
/// Source: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, II.2.

#include <string>
#include <vector>

#include "bench/method/analysis/tableau.hpp"
#include "bench/method/product_names.hpp"

namespace cvtflow::bench {

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
