#pragma once
/// A plan laid out flat for the step loop: all terms in one array, stage times beside them. Nothing is allocated after compile(). And the
/// one kernel of every method: a linear combination of slots over a range of the state vector.

#include <span>

#include "engine/method/stage_plan.hpp"

namespace cvtflow::engine {

/// One row of a plan, as the kernels read it: a stage, the result or the error estimate. Refers into its CompiledPlan.
struct PlanStep {
    std::span<const Term> states;
    std::span<const Term> slopes;
    int keep = -1;      ///< state slot that stores the combination, or -1
    int slope = -1;     ///< slope slot that receives f, or -1 (result, error)
    double time = 0.0;  ///< c: the combination belongs to t + c h (0 for the error estimate) [1]
};

class CompiledPlan {
public:
    /// @param plan a sound one: bench/method/analysis/order.hpp states what that means
    explicit CompiledPlan(const StagePlan& plan);

    [[nodiscard]] int stages() const noexcept { return static_cast<int>(rows_.size()) - (has_error_ ? 2 : 1); }
    [[nodiscard]] int state_slots() const noexcept { return state_slots_; }
    [[nodiscard]] int slope_slots() const noexcept { return slope_slots_; }
    [[nodiscard]] bool has_error() const noexcept { return has_error_; }
    /// Whether the last stage is evaluated at the result, term by term, so that its slope is the next step's slope 0.
    [[nodiscard]] bool last_is_result() const noexcept { return last_is_result_; }

    /// @param stage 0 … stages() - 1
    [[nodiscard]] PlanStep stage(int stage) const noexcept { return step(stage); }
    [[nodiscard]] PlanStep result() const noexcept { return step(stages()); }
    /// Requires has_error().
    [[nodiscard]] PlanStep error() const noexcept { return step(stages() + 1); }

    /// The plan with chained states unrolled, as of a Butcher tableau: each row less y, over h times the slopes of the stages. Stages,
    /// result and, if there is one, the error estimate. For analysis and tables, not in the step loop.
    [[nodiscard]] std::vector<std::vector<double>> unrolled() const;

private:
    struct Row {
        int begin;   ///< first state term
        int middle;  ///< first slope term
        int end;
        int keep;
        int slope;
        double time;  ///< PlanStep::time
    };

    [[nodiscard]] PlanStep step(int row) const noexcept;
    [[nodiscard]] double time_of(int begin, int middle, int end, const std::vector<double>& state_times) const;
    void add(const std::vector<Term>& states, const std::vector<Term>& slopes, int keep, int slope, std::vector<double>& state_times);

    std::vector<Term> terms_;
    std::vector<Row> rows_;
    int state_slots_;
    int slope_slots_;
    bool has_error_;
    bool last_is_result_;
};

/// Slots of a step: arrays of pointers to whole state vectors.
struct SlotView {
    const double* const* states;  ///< [state slot] → y [state]
    const double* const* slopes;  ///< [slope slot] → y' [state/s]
};

/// out[i - begin] = Σ factor states[slot][i] + Σ (h factor) slopes[slot][i] for i in [begin, end).
/// Terms are added per element from left to right, states first: results are bitwise the same however a range is split.
/// @param out end - begin numbers; overlaps no slot that the step reads
/// No terms at all: zeros. Never fails, allocates nothing.
void combine(const PlanStep& step, double h, const SlotView& slots, int begin, int end, double* out) noexcept;

}  // namespace cvtflow::engine
