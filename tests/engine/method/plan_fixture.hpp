#pragma once
/// Plans and problems that several tests of methods share.

#include <functional>
#include <vector>

#include "engine/method/stage_plan.hpp"

namespace cvtflow::engine::test {

using State = std::vector<double>;

/// y' = slope(t, y) with a known solution.
struct Problem {
    std::function<State(double, const State&)> slope;
    std::function<State(double)> solution;
    double end;
};

/// Kepler's problem, eccentricity 0.2: autonomous, nonlinear, four unknowns.
[[nodiscard]] Problem kepler();
/// Problem of Dormand and Prince (1978) with factors of t: non-autonomous, nonlinear, four unknowns.
[[nodiscard]] Problem driven();

/// Integrates with `steps` equal steps; sizes as the problem.
[[nodiscard]] State integrate(const StagePlan& plan, const Problem& problem, int steps);
/// The same, but two steps are cut at two fifths, as at a transition: the state there is that of the cubic through both ends, and the next
/// step ends where the cut one would have ended. @param steps a multiple of 4
[[nodiscard]] State integrate_with_cuts(const StagePlan& plan, const Problem& problem, int steps);

using Integration = State (*)(const StagePlan& plan, const Problem& problem, int steps);
/// Order measured by halving the step, at the finest step whose error is still clear of rounding.
/// @param clear errors below are taken for rounding
[[nodiscard]] double measured_order(const StagePlan& plan, const Problem& problem, double clear, Integration integration = integrate);

/// Two Euler steps of h/2 in one plan, chained by a kept state: c = (0, 1/2), b = (1/2, 1/2), order 1.
[[nodiscard]] StagePlan two_half_euler_steps();
/// DUMKA3 with its degrees 3 (P0) and 6 (P1), stage by stage as the blocks run, with the error estimate's evaluation at the end.
[[nodiscard]] StagePlan dumka3_degree_3();
[[nodiscard]] StagePlan dumka3_degree_6();

}  // namespace cvtflow::engine::test
