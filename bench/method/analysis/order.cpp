#include "bench/method/analysis/order.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bench/method/product_names.hpp"
#include "engine/method/compiled_plan.hpp"

namespace cvtflow::bench {

namespace {

/// Walks through a plan in order of execution and remembers which slots hold something.
class Validator {
public:
    explicit Validator(const StagePlan& plan)
        : plan_(plan),
          states_(static_cast<std::size_t>(std::max(plan.state_slots, 1)), false),
          slopes_(static_cast<std::size_t>(std::max(plan.slope_slots, 1)), false) {
        states_[0] = true;
    }

    void run() {
        where_ = "plan";
        if (plan_.state_slots < 1 || plan_.slope_slots < 1) fail("needs at least one state slot and one slope slot");
        if (plan_.stages.empty()) fail("has no stage");
        for (std::size_t i = 0; i < plan_.stages.size(); ++i) {
            where_ = "stage " + std::to_string(i);
            if (i == 0) first_stage(plan_.stages[0]);
            stage(plan_.stages[i], i == 0);
        }
        where_ = "result";
        reads(plan_.result.states, plan_.result.slopes, 1.0);
        where_ = "error estimate";
        if (plan_.error) reads(plan_.error->states, plan_.error->slopes, 0.0);
    }

private:
    [[noreturn]] void fail(const std::string& what) const { throw std::invalid_argument(plan_.name + ": " + where_ + ": " + what); }

    void first_stage(const Stage& stage) const {
        if (stage != Stage{{{0, 1.0}}, {}, -1, 0}) fail("must be f(t, y): states {{0, 1}}, no slopes, nothing kept, slope slot 0");
    }

    void stage(const Stage& stage, bool first) {
        reads(stage.states, stage.slopes, 1.0);
        if (!first && stage.slope == 0) fail("writes slope slot 0, which holds f(t, y) for the whole step");
        if (stage.keep == 0) fail("writes state slot 0, which holds y for the whole step");
        writes(states_, stage.keep, stage.states, "state", true);
        writes(slopes_, stage.slope, stage.slopes, "slope", false);
    }

    void reads(const std::vector<Term>& states, const std::vector<Term>& slopes, double expected) const {
        check_written(states_, states, "state");
        check_written(slopes_, slopes, "slope");
        double sum = 0.0;
        for (const Term& term : states) sum += term.factor;
        if (!(std::abs(sum - expected) <= 1e-12)) fail(fmt::format("state factors sum to {:.6f} instead of {:.6f}", sum, expected));
    }

    void check_written(const std::vector<bool>& written, const std::vector<Term>& terms, const std::string& kind) const {
        for (const Term& term : terms) {
            check_range(written, term.slot, kind);
            if (!std::isfinite(term.factor)) fail("factor of " + kind + " slot " + std::to_string(term.slot) + " is not finite");
            if (!written[static_cast<std::size_t>(term.slot)])
                fail("reads " + kind + " slot " + std::to_string(term.slot) + " before it is written");
        }
    }

    void check_range(const std::vector<bool>& written, int slot, const std::string& kind) const {
        if (slot >= 0 && static_cast<std::size_t>(slot) < written.size()) return;
        fail(kind + " slot " + std::to_string(slot) + " is outside 0…" + std::to_string(written.size() - 1));
    }

    void writes(std::vector<bool>& written, int slot, const std::vector<Term>& read, const std::string& kind, bool optional) const {
        if (optional && slot == -1) return;
        check_range(written, slot, kind);
        const bool also_read = std::any_of(read.begin(), read.end(), [&](const Term& term) { return term.slot == slot; });
        if (also_read) fail("writes " + kind + " slot " + std::to_string(slot) + " and reads it: neighbouring segments would race");
        written[static_cast<std::size_t>(slot)] = true;
    }

    const StagePlan& plan_;
    std::vector<bool> states_;
    std::vector<bool> slopes_;
    std::string where_;
};

}  // namespace

void validate(const StagePlan& plan) { Validator(plan).run(); }

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
