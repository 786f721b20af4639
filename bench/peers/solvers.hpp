#pragma once
/// Solvers of others on one stretch of a scene: an initial value problem for any solver, y' = f(t, y) with phases held, and ∂f/∂y; and
/// SUNDIALS on it. No type of SUNDIALS leaves this folder.

#include <string>
#include <vector>

#include "bench/method/jacobian/jacobian.hpp"
#include "bench/study/error_measure.hpp"
#include "model/observe/observation.hpp"
#include "tasks/scene/scene.hpp"
#include "tasks/step/integration_state.hpp"

namespace cvtflow::bench {

/// A square matrix by columns, with the places of a pattern that never changes.
struct SparsePattern {
    std::vector<int> begin, row;  ///< [unknowns + 1], [entries] ascending within a column
};

class Problem {
public:
    /// Problem from `start` over `duration`, in which no tip changes its phase, with an output every `interval`. [s]
    Problem(const tasks::Scene& scene, tasks::FrozenStart start, double duration, double interval);

    [[nodiscard]] int size() const noexcept { return variator_.layout().size(); }
    [[nodiscard]] const tasks::FrozenStart& start() const noexcept { return start_; }
    [[nodiscard]] double interval() const noexcept { return interval_; }
    [[nodiscard]] int outputs() const noexcept { return outputs_; }

    /// t [s], state [unknowns], slope [unknowns]
    void slope(double t, const double* state, double* slope) noexcept;
    [[nodiscard]] const SparsePattern& pattern() const noexcept { return pattern_; }
    /// ∂f/∂y in the order of the pattern. The rows of the ledger are left out: nothing depends on them.
    void jacobian(double t, const double* state, double* values) noexcept;

    /// Whether an unknown is the rate of a coordinate: its slope is an acceleration.
    [[nodiscard]] bool is_rate(int unknown) const noexcept;
    /// A typical size of each unknown, for absolute tolerances: coordinates 1e-6, their rates 1e-2, all else 1.
    [[nodiscard]] std::vector<double> sizes() const;

    /// Adds an output to a trajectory. t [s], state [unknowns]
    void observe(double t, const double* state, Trajectory& trajectory);

    [[nodiscard]] long evaluations() const noexcept { return evaluations_; }
    void forget_evaluations() noexcept { evaluations_ = 0; }

private:
    /// Calls visit(row, column, value) for every entry, always in the same order.
    template <class Visit>
    void visit_entries(Visit&& visit) const;
    void make_pattern();

    model::Variator variator_;
    tasks::FrozenStart start_;
    double interval_;
    int outputs_;
    model::EvaluationScratch scratch_;
    model::Observer observer_;
    bench::ExactJacobian exact_;
    bench::AccelerationJacobian blocks_;
    SparsePattern pattern_;
    std::vector<int> place_;  ///< [visited entry] → pattern
    long evaluations_ = 0;
};

struct PeerRun {
    std::string fault;  ///< empty: it came to the end
    double seconds = 0.0;
    long steps = 0, evaluations = 0, jacobians = 0;
    Trajectory trajectory;
};

struct Peer {
    std::string name, description;
    /// @param tolerance relative one; absolute ones are it times the unknowns' sizes [1]
    PeerRun (*run)(Problem& problem, double tolerance);
};

[[nodiscard]] const std::vector<Peer>& peers();
/// "6.4.1"
[[nodiscard]] std::string sundials_version();

}  // namespace cvtflow::bench
