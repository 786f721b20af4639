#include "bench/method/analysis/order.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace cvtflow::bench {

namespace {

/// Appends every tree whose children have `left` nodes in all, beginning with `children` and continuing with trees from `first` on.
void grow(std::vector<RootedTree>& trees, std::vector<int>& children, int first, int left, int nodes) {
    if (left == 0) {
        double density = nodes;
        for (const int child : children) density *= trees[static_cast<std::size_t>(child)].density;
        trees.push_back({nodes, density, children});
        return;
    }
    for (int child = first; child < static_cast<int>(trees.size()); ++child) {
        const int size = trees[static_cast<std::size_t>(child)].nodes;
        if (size > left || size >= nodes) break;
        children.push_back(child);
        grow(trees, children, child, left - size, nodes);
        children.pop_back();
    }
}

std::vector<double> multiply(const Tableau& tableau, const std::vector<double>& x) {
    std::vector<double> product(x.size(), 0.0);
    for (int i = 0; i < tableau.stages; ++i) {
        for (int j = 0; j < i; ++j) product[static_cast<std::size_t>(i)] += tableau.entry(i, j) * x[static_cast<std::size_t>(j)];
    }
    return product;
}

/// g(τ)_i = Π over children of (A g(child))_i, from the products already known.
std::vector<double> elementary(const RootedTree& tree, const std::vector<std::vector<double>>& products, std::size_t stages) {
    std::vector<double> g(stages, 1.0);
    for (const int child : tree.children) {
        for (std::size_t i = 0; i < stages; ++i) g[i] *= products[static_cast<std::size_t>(child)][i];
    }
    return g;
}

}  // namespace

std::vector<RootedTree> rooted_trees(int nodes) {
    std::vector<RootedTree> trees;
    for (int n = 1; n <= nodes; ++n) {
        std::vector<int> children;
        grow(trees, children, 0, n - 1, n);
    }
    return trees;
}

double time_defect(const Tableau& tableau) {
    double worst = 0.0;
    for (int i = 0; i < tableau.stages; ++i) {
        double sum = 0.0;
        for (int j = 0; j < tableau.stages; ++j) sum += tableau.entry(i, j);
        worst = std::max(worst, std::abs(sum - tableau.times[static_cast<std::size_t>(i)]));
    }
    return worst;
}

bool last_stage_is_result(const Tableau& tableau, double tolerance) {
    for (int j = 0; j < tableau.stages; ++j) {
        const double difference = tableau.entry(tableau.stages - 1, j) - tableau.weights[static_cast<std::size_t>(j)];
        if (!(std::abs(difference) <= tolerance)) return false;
    }
    return tableau.stages > 1;
}

int order_of(const Tableau& tableau, const std::vector<double>& weights, double tolerance) {
    if (!(time_defect(tableau) <= tolerance)) return 0;
    const std::size_t stages = weights.size();
    std::vector<std::vector<double>> products;
    for (const RootedTree& tree : rooted_trees(highest_order)) {
        const std::vector<double> g = elementary(tree, products, stages);
        double sum = 0.0;
        for (std::size_t i = 0; i < stages; ++i) sum += weights[i] * g[i];
        if (!(std::abs(sum - 1.0 / tree.density) <= tolerance)) return tree.nodes - 1;
        if (tree.nodes < highest_order) products.push_back(multiply(tableau, g));
    }
    return highest_order;
}

int order_of(const StagePlan& plan, double tolerance) {
    const Tableau tableau = unroll(plan);
    return order_of(tableau, tableau.weights, tolerance);
}

int embedded_order_of(const StagePlan& plan, double tolerance) {
    const Tableau tableau = unroll(plan);
    return tableau.embedded.empty() ? 0 : order_of(tableau, tableau.embedded, tolerance);
}

namespace {

/// Largest defect of an order condition that counts as met.
constexpr double nearly_met = 1e-4;

}  // namespace

std::string order_text(const StagePlan& plan) {
    const int order = order_of(plan), almost = order_of(plan, nearly_met), embedded = embedded_order_of(plan);
    std::string text = fmt::format("{}", order);
    if (almost > order) {
        double defect = nearly_met;
        while (order_of(plan, defect) == almost) defect /= 2.0;
        text = fmt::format("{} to {:.0e}", almost, defect);
    }
    return embedded > 0 ? fmt::format("{}({})", text, embedded) : text;
}

}  // namespace cvtflow::bench
