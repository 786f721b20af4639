#pragma once
/// The trapezoidal rule, solved by Newton's method in velocities alone: options, equations of a step, and the step.

#include <span>
#include <string>
#include <vector>

#include "bench/method/implicit/implicit_method.hpp"
#include "bench/method/product_names.hpp"

namespace cvtflow::bench {

// How Newton's method finds its matrix, and what became of it.

/// Source of an iteration's matrix.
enum class NewtonMatrix {
    every_iteration,  ///< new Jacobian in each iteration
    once_per_step,    ///< new Jacobian at the start of each step
    frozen,           ///< kept over steps until it no longer converges
    broyden,          ///< kept over steps, with Broyden's rank-one updates of its inverse
    schubert,         ///< kept over steps, with Broyden's updates within the sparsity (Schubert 1970) and a new factorisation each
};

[[nodiscard]] constexpr bool keeps_over_steps(NewtonMatrix matrix) noexcept { return matrix >= NewtonMatrix::frozen; }

/// Start of the iteration.
enum class NewtonStart {
    rest,   ///< velocities of the step's start
    euler,  ///< explicit Euler: the friction of a contact that should stick may overshoot
};

struct NewtonOptions {
    NewtonMatrix matrix = NewtonMatrix::every_iteration;
    bool exact = true;  ///< derivatives by the model, not by differences
    NewtonStart start = NewtonStart::rest;
    bool backtracking = true;  ///< halve the step until the residual falls
    int max_iterations = 25;
    double tolerance = 1e-7;  ///< residual as the speed of one link that had all of its energy [m/s]
};

/// Counters of the solves so far. All monotone.
struct NewtonStatistics {
    long steps = 0;  ///< steps solved for, retaken ones included
    long iterations = 0;
    long most = 0;  ///< iterations of the worst step, converged or not
    long jacobians = 0;
    long factorisations = 0;
    long solves = 0;
    long backtracks = 0;   ///< halvings
    long refreshed = 0;    ///< steps that needed a Jacobian beyond the variant's rule
    long unconverged = 0;  ///< steps that used the best iterate
    double worst = 0.0;    ///< largest accepted residual [m/s]
};

/// One line: "2.31 iterations per step (most 7), …".
[[nodiscard]] std::string text(const NewtonStatistics& statistics);

/// Broyden's update of an inverse in product form: B⁻¹ = (I + u_k s_kᵀ) … (I + u_0 s_0ᵀ) B_0⁻¹, where the caller provides B_0⁻¹.
/// (C. G. Broyden 1965; product form as in Kelley, Iterative Methods, 1995.) Sums run from the first unknown to the last.
class Broyden {
public:
    /// @param unknowns length of the vectors   @param most updates kept
    Broyden(int unknowns, int most);

    void clear() noexcept { count_ = 0; }
    [[nodiscard]] bool full() const noexcept { return count_ == most_; }
    [[nodiscard]] int count() const noexcept { return count_; }

    /// x ← B⁻¹ B_0 x. @param x [m/s]   @param from first update to apply
    void apply(double* x, int from = 0) const noexcept;
    /// Adds the update of a step s = λ d that turned the residual r into r⁺:  u = (s - w)/(s·w), w = B⁻¹ (r⁺ - r). Ignored if s·w vanishes
    /// or no room is left.
    void add(const double* s, const double* w) noexcept;

    void visit(engine::Archive& archive);

private:
    int unknowns_, most_, count_ = 0;
    std::vector<double> steps_, updates_;  ///< [most][unknowns]
};

/// The equations of a step of the trapezoidal rule:  v⁺ = v + h/2 (a + a⁺), q⁺ = q + h/2 (v + v⁺).
///
/// Iterates keep q⁺ = q + h/2 (v + v⁺) exactly, so the residual  r = v⁺ - v - h/2 (a + a⁺)  has velocities only. The derived class solves.
class TrapezoidalRule : public ImplicitMethod {
public:
    static constexpr int state_slots = 4;  ///< start, iterate, increment, trial
    static constexpr int slope_slots = 3;  ///< slopes of the controller, the trial and the start

    void phases_changed() noexcept override { start_slope_ = end_slope_ = false; }  // a kept Jacobian may still serve

    void prepare(int segment) noexcept override;         ///< start of the iteration after predict(), else the residual
    void finish(int first, int last) noexcept override;  ///< increment of the state from that of the velocities

protected:
    static constexpr int trial_slope = 1, start_slope = 2;  ///< slots of slopes

    TrapezoidalRule(Workspace& workspace, NewtonStart start);

    [[nodiscard]] double theta() const noexcept { return 0.5 * w_.step.h; }
    [[nodiscard]] bool knows_start_slope() noexcept;
    [[nodiscard]] int evaluate_start() noexcept;
    [[nodiscard]] int predict() noexcept;
    void start_tail() noexcept;                                ///< called after the cycle of predict()
    [[nodiscard]] int evaluate_trial(double lambda) noexcept;  ///< lambda [1]; 0: the iterate again
    [[nodiscard]] double residual_norm() noexcept;             ///< norm of the trial's residual, after the prepare cycle [m/s]
    void finish_tail() noexcept;                               ///< called after the solve cycle
    void take_iterate() noexcept;

    int iterate_ = 1, trial_ = 3;   ///< state slots; slot 2 holds the increment
    bool end_slope_ = false;        ///< slope slot 1 holds the end of the last step
    std::vector<double> residual_;  ///< [unknowns] residual of the trial

private:
    void start_link(int link) noexcept;
    void residual_of_link(int link) noexcept;
    [[nodiscard]] double residual_of_tail() noexcept;

    const NewtonStart start_;
    const double link_mass_;  ///< [kg]
    engine::Term terms_[2]{};
    double time_of_start_ = 0.0;    ///< [s]
    bool start_slope_ = false;      ///< slope slot 2 holds the start of the last step
    bool predicting_ = false;       ///< a prepare cycle makes the start of the iteration, not a residual
    std::vector<double> energies_;  ///< [links] energies of the residual
};

/// Steps of the trapezoidal rule, solved by Newton's method in velocities alone.
///
///     predict ─► evaluate ─► residual ─► [jacobian ─► factor] ─► solve ─► evaluate ─► residual ─► …
///
/// Friction laws have kinks: the iteration starts from the velocities of the step's start, and steps are halved until the residual falls
/// in energy. A step that does not converge uses the best iterate and is counted.
class TrapezoidalMethod final : public TrapezoidalRule {
public:
    TrapezoidalMethod(Workspace& workspace, const NewtonOptions& options);

    [[nodiscard]] CycleSequence step() override;
    void restart() noexcept override;
    /// Slope at the end of the last step; with a matrix that is kept over steps, its Jacobian and updates.
    void visit(engine::Archive& archive) override;

    void update(int segment) noexcept override;

    [[nodiscard]] NewtonStatistics statistics() const noexcept;
    [[nodiscard]] std::string report() const override;

private:
    /// Change of the matrix before an iteration.
    enum class Matrix { stays, new_jacobian, update, factorise };

    [[nodiscard]] bool falls(double norm) const noexcept;  ///< norm [m/s]
    [[nodiscard]] bool shorten() noexcept;
    void accept_trial(double norm) noexcept;  ///< norm [m/s]
    [[nodiscard]] Matrix next_matrix() noexcept;
    [[nodiscard]] int new_jacobian() noexcept;
    [[nodiscard]] int begin_update() noexcept;
    void finish_solve() noexcept;
    [[nodiscard]] Fault give_up() noexcept;
    void finish_step() noexcept;
    void broyden_direction() noexcept;
    [[nodiscard]] double border_factor(int row, double seen) noexcept;  ///< seen [m/s]
    void update_border_rows(int link, int shaft) noexcept;
    void update_corner() noexcept;

    const NewtonOptions options_;
    NewtonStatistics statistics_;
    Broyden broyden_;
    bool has_jacobian_ = false;
    bool renew_ = false;      ///< the iterate is evaluated once more for a new Jacobian
    bool first_ = true;       ///< the trial is the start of the iteration
    bool direction_ = false;  ///< step_ belongs to the present matrix
    bool refreshed_ = false;  ///< a Jacobian beyond the rule in this step
    int iterations_ = 0, since_jacobian_ = 0;
    double norm_ = 0.0, lambda_ = 1.0,
           contraction_ = 0.0;             ///< residual norm [m/s]; share of the Newton step taken; rate of convergence
    std::vector<double> residual_before_;  ///< [velocities] residual of the iterate before [m/s]
    std::vector<double> step_;             ///< [velocities] Newton direction [m/s]
    std::vector<double> change_;           ///< [velocities] step taken [m/s]
    double squares_[3]{};                  ///< squares of the change: links on shaft 0, on shaft 1, border [m²/s²]
};

}  // namespace cvtflow::bench
