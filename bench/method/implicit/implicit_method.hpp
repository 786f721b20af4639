#pragma once
/// Parts that all methods that solve with the whole state share: the Jacobian, the matrix of a stage, and the cycles that evaluate,
/// factorise and solve in parallel.
///
///     jacobian    [batch] ─► corner                                     columns by differences, or exact derivatives link by link
///     factor      eliminate[chunk] ─► join                              I - θ D - θ² K at the base point
///     prepare     [segment]                                             right-hand side of the solve, by the method
///     solve       forward[chunk] ─► join ─► backward[chunk]             velocities; the method then finishes the links of the chunk
///
/// Chunks belong to the matrix and batches to the Jacobian, not to segments or threads: results do not depend on either.

#include <optional>
#include <span>
#include <vector>

#include "bench/method/implicit/implicit_matrix.hpp"
#include "bench/method/jacobian/jacobian.hpp"
#include "bench/method/product_names.hpp"
#include "tasks/step/step_graph.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::bench {

/// Cycles of the method.
enum ImplicitCycle : int { prepare_cycle = method_cycles, jacobian_cycle, factor_cycle, solve_cycle, update_cycle };

class ImplicitMethod : public StepMethod {
public:
    explicit ImplicitMethod(Workspace& workspace);

    void add_tasks(engine::TaskGraph& graph) override;
    /// A transition repeats the step: stiff accelerations make no good interpolants.
    [[nodiscard]] AtTransition at_transition() const noexcept override { return AtTransition::repeat; }

    // Bodies of the cycles.
    virtual void prepare(int segment) noexcept = 0;
    virtual void finish(int first, int last) noexcept = 0;  ///< links [first, last) of a chunk
    virtual void update(int segment) noexcept { (void)segment; }
    void jacobian_batch(int batch) noexcept;
    void jacobian_corner() noexcept;
    void eliminate(int chunk) noexcept;
    void join() noexcept;
    void forward(int chunk) noexcept { matrix_.forward(chunk, right_side_.data()); }
    void join_solution() noexcept { matrix_.join_solution(right_side_.data()); }
    void backward(int chunk) noexcept;

protected:
    /// Evaluate cycle at Σ factor states[slot], at time + c h, into slope slot `slope`; kept in state slot `keep` if ≥ 0.
    [[nodiscard]] int evaluate(std::span<const engine::Term> states, double c, int slope, int keep = -1) noexcept;
    /// Jacobian cycle at a state that has just been evaluated. c [1]
    [[nodiscard]] int take_jacobian(double c, int state_slot, int slope_slot) noexcept;
    /// Factor cycle for I - θ D - θ² K. theta [s]
    [[nodiscard]] int factorise(double theta) noexcept;
    /// Jacobian, θ and contacts of the last factorisation; reading factorises again, to the same bits.
    void visit_factors(engine::Archive& archive);

    [[nodiscard]] double* state(int slot) const noexcept { return w_.states[static_cast<std::size_t>(slot)]; }
    /// Link's part of a right-hand side or solution.
    [[nodiscard]] double* velocities(std::vector<double>& of, int link) const noexcept { return of.data() + link * size_; }
    [[nodiscard]] double* border(std::vector<double>& of) const noexcept { return of.data() + w_.layout().links * size_; }

    Workspace& w_;
    const int size_, half_, border_size_;  ///< coordinates of a link, of the pulleys; the latter with control
    const int q_tail_;                     ///< first pulley coordinate in the state
    bench::AccelerationJacobian jacobian_;
    ImplicitMatrix matrix_;
    std::vector<std::optional<int>> shafts_;     ///< [links] ContactMap::shaft() at the last factorisation
    std::vector<double> right_side_, solution_;  ///< [matrix_.unknowns()]
    long jacobians_ = 0, factorisations_ = 0, solves_ = 0;
    double theta_ = 0.0;           ///< θ of the matrix [s]
    bool exact_ = false;           ///< Jacobian by the model's derivatives, not by differences
    bool finish_in_tasks_ = true;  ///< finish() is called by the backward tasks

private:
    ColouredJacobian differences_;
    bench::ExactJacobian derivatives_;
    BasePoint base_;
};

/// The step's velocities are not finite.
[[nodiscard]] inline Fault not_finite(const StepInput& step) noexcept { return {FaultKind::non_finite, step.time + step.h, {}, 0.0, 0.0}; }

}  // namespace cvtflow::bench
