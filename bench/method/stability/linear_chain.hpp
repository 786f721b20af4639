#pragma once
/// The equations of motion, linearised at a state with its phases held, in the parts that methods treat differently:
///
///     a = K q + C v + F v        K: forces by coordinates;  C: damping by velocities;  F: friction by velocities
///
/// Unknowns: q of all links, one after the other, and of the pulleys; v in the same order, then the control integral, if any (its
/// "acceleration" is its rate). Exact derivatives, in sparse matrices.

#include <memory>
#include <vector>

#include "bench/method/product_names.hpp"
#include "model/variator/variator.hpp"
#include "tasks/step/integration_state.hpp"

namespace cvtflow::bench {

/// Solves (1 - shift v-part - shift² q-part) x = right for a fixed shift.
class LinearSolver {
public:
    virtual ~LinearSolver() = default;
    virtual void solve(const double* right, double* x) const = 0;  ///< right [unknowns], x [unknowns]

protected:
    LinearSolver() = default;
    LinearSolver(const LinearSolver&) = default;
    LinearSolver& operator=(const LinearSolver&) = default;
};

class LinearChain {
public:
    /// `variator` has these parameters and must outlive this.
    LinearChain(const model::Variator& variator, const model::Parameters& parameters, const FrozenStart& start);
    ~LinearChain();

    /// Unknowns q and v, and those v that belong to links (they come first).
    [[nodiscard]] int coordinates() const noexcept { return coordinates_; }
    [[nodiscard]] int velocities() const noexcept { return velocities_; }
    [[nodiscard]] int link_velocities() const noexcept { return link_velocities_; }

    // out += factor × part × x. q: [coordinates()], v and out: [velocities()].
    void add_elastic(double factor, const double* q, double* out) const;   ///< factor [1], q [coordinates], out [accelerations]
    void add_damping(double factor, const double* v, double* out) const;   ///< factor [1], v [velocities], out [accelerations]
    void add_friction(double factor, const double* v, double* out) const;  ///< factor [1], v [velocities], out [accelerations]
    /// Friction of the links by links' velocities alone: [link_velocities()].
    void add_link_friction(double factor, const double* v, double* out) const;
    /// Part of K by friction, whose normal forces change. factor [1], q [coordinates], out [accelerations]
    void add_sliding(double factor, const double* q, double* out) const;
    /// The rest of K. factor [1], q [coordinates], out [accelerations]
    void add_frictionless(double factor, const double* q, double* out) const;
    /// Friction by the velocities of pulleys, given as those of all. factor [1], v [velocities], out [accelerations]
    void add_surface_friction(double factor, const double* v, double* out) const;
    /// Friction by links' velocities on pulleys. factor [1], v [velocities], out [accelerations]
    void add_reaction(double factor, const double* v, double* out) const;

    /// Solver of the whole: (1 - shift (C + F) - shift² K). shift [s]
    [[nodiscard]] std::unique_ptr<LinearSolver> whole_solver(double shift) const;
    /// Solver of the links' friction: (1 - shift F). shift [s]
    /// @param held whether links are held over a step of `shift`
    [[nodiscard]] std::unique_ptr<LinearSolver> friction_solver(double shift, bool held) const;
    /// out += factor M⁻¹ K v of held links (model::HeldLinks). v, out: velocities of links
    void add_held(double factor, const double* v, double* out) const;

    /// Largest eigenvalue of links' friction if all contacts stuck; found at the first request [1/s].
    [[nodiscard]] double stiffest_friction() const;
    [[nodiscard]] const model::Variator& variator() const noexcept { return variator_; }
    [[nodiscard]] const FrozenStart& start() const noexcept { return start_; }

private:
    struct Parts;

    const model::Variator& variator_;
    const model::Parameters parameters_;
    const FrozenStart start_;
    int coordinates_, velocities_, link_velocities_;
    std::unique_ptr<Parts> parts_;
};

}  // namespace cvtflow::bench
