#pragma once
/// How Newton's method finds its matrix, and what became of it.

#include <string>

#include "bench/method/product_names.hpp"

namespace cvtflow::bench {

/// Where the matrix of an iteration comes from.
enum class NewtonMatrix {
    every_iteration,  ///< Jacobian anew in each iteration
    once_per_step,    ///< at the start of each step
    frozen,           ///< kept over steps until it no longer converges
    broyden,          ///< kept over steps, with Broyden's rank-one updates of its inverse
    schubert,         ///< kept over steps, with Broyden's updates within the sparsity (Schubert 1970) and a new factorisation each
};

[[nodiscard]] constexpr bool keeps_over_steps(NewtonMatrix matrix) noexcept { return matrix >= NewtonMatrix::frozen; }

/// Where the iteration starts.
enum class NewtonStart {
    rest,   ///< velocities of the step's start
    euler,  ///< explicit Euler: the friction of a contact that should stick may throw it across
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
    long steps = 0;  ///< solved for, retaken ones included
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

}  // namespace cvtflow::bench
