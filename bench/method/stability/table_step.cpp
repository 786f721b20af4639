/// One-step methods: tables of stages, and those that solve for the whole state.

#include <algorithm>

#include "bench/method/product_names.hpp"
#include "bench/method/stability/step_map.hpp"
#include "engine/method/compiled_plan.hpp"

namespace cvtflow::bench {

namespace {

/// (h v, h² a) of (q, h v).
void slope_of(const LinearChain& chain, double h, const double* from, double* slope) {
    const int n = chain.coordinates(), m = chain.velocities();
    std::copy_n(from + n, n, slope);
    std::fill_n(slope + n, m, 0.0);
    chain.add_elastic(h * h, from, slope + n);
    chain.add_damping(h, from + n, slope + n);
    chain.add_friction(h, from + n, slope + n);
}

class TableStep final : public StepMap {
public:
    TableStep(const LinearChain& chain, const engine::CompiledPlan& plan) : chain_(chain), plan_(plan), stage_(at(size())) {
        for (int slot = 0; slot < plan_.state_slots(); ++slot) states_.emplace_back(at(size()));
        for (int slot = 0; slot < plan_.slope_slots(); ++slot) slopes_.emplace_back(at(size()));
        for (auto& slot : states_) state_slots_.push_back(slot.data());
        for (auto& slot : slopes_) slope_slots_.push_back(slot.data());
    }
    bool prepare(double h) override {
        h_ = h;
        return true;
    }
    int size() const noexcept override { return chain_.coordinates() + chain_.velocities(); }
    void step(const double* from, double* to) override {
        const engine::SlotView view{state_slots_.data(), slope_slots_.data()};
        std::copy_n(from, size(), states_[0].begin());
        for (int stage = 0; stage < plan_.stages(); ++stage) {
            const engine::PlanStep row = plan_.stage(stage);
            engine::combine(row, 1.0, view, 0, size(), stage_.data());
            if (row.keep >= 0) std::copy(stage_.begin(), stage_.end(), states_[at(row.keep)].begin());
            slope_of(chain_, h_, stage_.data(), slopes_[at(row.slope)].data());
        }
        engine::combine(plan_.result(), 1.0, view, 0, size(), to);
    }

private:
    const LinearChain& chain_;
    const engine::CompiledPlan plan_;
    double h_ = 0.0;
    std::vector<std::vector<double>> states_, slopes_;
    std::vector<double*> state_slots_, slope_slots_;
    std::vector<double> stage_;
};

/// u of (1 - γ z) u = γ (z y + r), z = h J.
class LinearlyImplicit final : public StepMap {
public:
    LinearlyImplicit(const LinearChain& chain, LinearPlan plan)
        : chain_(chain), plan_(std::move(plan)), state_(at(size())), right_(at(size())) {
        increments_.assign(plan_.stages.size(), std::vector<double>(at(size())));
    }
    bool prepare(double h) override {
        h_ = h;
        solvers_.clear();
        for (std::size_t stage = 0; stage < plan_.stages.size(); ++stage) {
            const double gamma = plan_.stages[stage].gamma;
            const bool same = stage > 0 && gamma == plan_.stages[stage - 1].gamma;
            solvers_.push_back(same ? solvers_.back() : std::shared_ptr<LinearSolver>(chain_.whole_solver(gamma * h)));
        }
        return true;
    }
    int size() const noexcept override { return chain_.coordinates() + chain_.velocities(); }
    void step(const double* from, double* to) override {
        for (std::size_t stage = 0; stage < plan_.stages.size(); ++stage) {
            const LinearStage& row = plan_.stages[stage];
            std::copy_n(from, size(), state_.begin());
            add(row.states, state_.data());
            slope_of(chain_, h_, state_.data(), right_.data());
            add(row.right, right_.data());
            solve(stage, row.gamma, increments_[stage].data());
        }
        std::copy_n(from, size(), to);
        add(plan_.result, to);
    }

private:
    void add(const std::vector<engine::Term>& terms, double* out) const {
        for (const engine::Term& term : terms) {
            for (int k = 0; k < size(); ++k) out[k] += term.factor * increments_[at(term.slot)][at(k)];
        }
    }
    /// Coordinates eliminated: u_q = γ (r_q + u_v).
    void solve(std::size_t stage, double gamma, double* u) const {
        const int n = chain_.coordinates(), m = chain_.velocities();
        std::vector<double> right(right_.begin() + n, right_.end());
        for (double& number : right) number *= gamma;
        chain_.add_elastic(gamma * gamma * h_ * h_, right_.data(), right.data());
        solvers_[stage]->solve(right.data(), u + n);
        for (int k = 0; k < n; ++k) u[k] = gamma * (right_[at(k)] + u[n + k]);
        (void)m;
    }

    const LinearChain& chain_;
    const LinearPlan plan_;
    double h_ = 0.0;
    std::vector<std::shared_ptr<LinearSolver>> solvers_;
    std::vector<std::vector<double>> increments_;
    std::vector<double> state_, right_;
};

}  // namespace

std::unique_ptr<StepMap> table_step(const LinearChain& chain, const engine::CompiledPlan& plan) {
    return std::make_unique<TableStep>(chain, plan);
}

std::unique_ptr<StepMap> implicit_step(const LinearChain& chain, const LinearPlan& plan) {
    return std::make_unique<LinearlyImplicit>(chain, plan);
}

/// (1 - z/2) u = z y: a linearly implicit step of one stage, u = 2 (1 - z/2)⁻¹ z/2 y.
std::unique_ptr<StepMap> trapezoidal_step(const LinearChain& chain) {
    return implicit_step(chain, {"trapezoidal", "", "", 2, {{0.5, {}, {}}}, {{0, 2.0}}});
}

}  // namespace cvtflow::bench
