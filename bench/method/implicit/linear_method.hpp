#pragma once
/// A step of a linearly implicit method: one Jacobian at the step's start, then per stage an evaluation and a linear solve.
///
///     evaluate ─► [jacobian] ─► factor ─► prepare ─► solve ─► evaluate ─► prepare ─► solve ─► …
///
/// Coordinates are eliminated: with the right-hand side (r_q, r_v), u_v solves (I - θ D - θ² K) u_v = r_v + θ K r_q, and u_q = r_q + θ u_v.
/// The ledger is a quadrature: no column of J depends on it, and J leaves out its rows, which a W-method may do.

#include "bench/method/implicit/implicit_method.hpp"
#include "bench/method/implicit/linear_plan.hpp"
#include "bench/method/product_names.hpp"

namespace cvtflow::bench {

class LinearMethod final : public ImplicitMethod {
public:
    LinearMethod(Workspace& workspace, const LinearPlan& plan);
    /// State slots of a workspace for this plan: the start and one increment per stage. One slope slot beside the controller's.
    [[nodiscard]] static int state_slots(const LinearPlan& plan) noexcept { return static_cast<int>(plan.stages.size()) + 1; }

    [[nodiscard]] CycleSequence step() override;
    void restart() noexcept override { has_jacobian_ = false; }
    [[nodiscard]] std::string report() const override;

    void prepare(int segment) noexcept override;
    void finish(int first, int last) noexcept override;

private:
    static constexpr int stage_slope = 1;

    void finish_stage() noexcept;
    void coordinates_right(int begin, int size, double* out) const noexcept;  ///< out [coordinates]
    void prepare_link(int link) noexcept;
    void prepare_tail() noexcept;
    [[nodiscard]] double theta() const noexcept;

    const LinearPlan plan_;
    const LinearTimes times_;
    std::vector<std::vector<engine::Term>> states_, rights_;  ///< [stage] sums in state slots
    std::vector<engine::Term> result_;
    std::size_t stage_ = 0;
    bool has_jacobian_ = false;
    double time_of_jacobian_ = 0.0;  ///< [s]
    std::vector<double> right_q_;    ///< r_q, link by link, then pulleys [coordinates]
    std::vector<double> reactions_;  ///< [links][border]: K r_q of the pulleys' rows
};

}  // namespace cvtflow::bench
