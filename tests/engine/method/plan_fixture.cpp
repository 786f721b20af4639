#include "plan_fixture.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "engine/event/interpolant.hpp"
#include "engine/method/compiled_plan.hpp"

namespace cvtflow::engine::test {

namespace {

State kepler_solution(double t) {
    constexpr double e = 0.2;
    double anomaly = t;
    for (int i = 0; i < 50; ++i) anomaly -= (anomaly - e * std::sin(anomaly) - t) / (1.0 - e * std::cos(anomaly));
    const double b = std::sqrt(1.0 - e * e);
    const double rate = 1.0 / (1.0 - e * std::cos(anomaly));
    return {std::cos(anomaly) - e, b * std::sin(anomaly), -std::sin(anomaly) * rate, b * std::cos(anomaly) * rate};
}

State kepler_slope(double, const State& y) {
    const double r3 = std::pow(y[0] * y[0] + y[1] * y[1], 1.5);
    return {y[2], y[3], -y[0] / r3, -y[1] / r3};
}

State driven_slope(double t, const State& y) {
    return {2.0 * t * std::pow(y[1], 0.2) * y[3], 10.0 * t * std::exp(5.0 * (y[2] - 1.0)) * y[3], 2.0 * t * y[3],
            -2.0 * t * std::log(y[0])};
}

State driven_solution(double t) {
    const double s = std::sin(t * t);
    return {std::exp(s), std::exp(5.0 * s), s + 1.0, std::cos(t * t)};
}

/// One step; states and slopes are the slots, states[0] holds y.
void advance(const CompiledPlan& plan, const Problem& problem, double t, double h, std::vector<State>& states, std::vector<State>& slopes) {
    const int size = static_cast<int>(states[0].size());
    std::vector<const double*> y;
    std::vector<const double*> k;
    for (const State& slot : states) y.push_back(slot.data());
    for (const State& slot : slopes) k.push_back(slot.data());
    State stage(states[0].size());
    for (int i = 0; i < plan.stages(); ++i) {
        const PlanStep step = plan.stage(i);
        combine(step, h, {y.data(), k.data()}, 0, size, stage.data());
        if (step.keep >= 0) std::copy(stage.begin(), stage.end(), states[static_cast<std::size_t>(step.keep)].begin());
        const State slope = problem.slope(t + step.time * h, stage);
        std::copy(slope.begin(), slope.end(), slopes[static_cast<std::size_t>(step.slope)].begin());
    }
    combine(plan.result(), h, {y.data(), k.data()}, 0, size, stage.data());
    std::copy(stage.begin(), stage.end(), states[0].begin());
}

double error_of(const StagePlan& plan, const Problem& problem, int steps, Integration integration) {
    const State y = integration(plan, problem, steps);
    const State exact = problem.solution(problem.end);
    double sum = 0.0;
    for (std::size_t i = 0; i < y.size(); ++i) sum += (y[i] - exact[i]) * (y[i] - exact[i]);
    return std::sqrt(sum);
}

const Stage first_stage{{{0, 1.0}}, {}, -1, 0};

}  // namespace

Problem kepler() { return {kepler_slope, kepler_solution, 2.0}; }

Problem driven() { return {driven_slope, driven_solution, 1.2}; }

State integrate(const StagePlan& plan, const Problem& problem, int steps) {
    const CompiledPlan compiled(plan);
    std::vector<State> states(static_cast<std::size_t>(plan.state_slots), problem.solution(0.0));
    std::vector<State> slopes(static_cast<std::size_t>(plan.slope_slots), State(states[0].size()));
    const double h = problem.end / steps;
    for (int step = 0; step < steps; ++step) advance(compiled, problem, step * h, h, states, slopes);
    return states[0];
}

State integrate_with_cuts(const StagePlan& plan, const Problem& problem, int steps) {
    const CompiledPlan compiled(plan);
    std::vector<State> states(static_cast<std::size_t>(plan.state_slots), problem.solution(0.0));
    std::vector<State> slopes(static_cast<std::size_t>(plan.slope_slots), State(states[0].size()));
    const double h = problem.end / steps, share = 0.4;
    for (int step = 0; step < steps; ++step) {
        const double t = step * h;
        if (step != steps / 4 && step != 3 * steps / 4) {
            advance(compiled, problem, t, h, states, slopes);
            continue;
        }
        const State start = states[0], first = problem.slope(t, start);
        advance(compiled, problem, t, h, states, slopes);
        const State end = states[0], last = problem.slope(t + h, end);
        const Interpolant cubic{start.data(), first.data(), end.data(), last.data(), h};
        cubic.evaluate(share, 0, static_cast<int>(start.size()), states[0].data());
        advance(compiled, problem, t + share * h, (1.0 - share) * h, states, slopes);
    }
    return states[0];
}

double measured_order(const StagePlan& plan, const Problem& problem, double clear, Integration integration) {
    double order = 0.0;
    double coarse = error_of(plan, problem, 4, integration);
    for (int steps = 8; steps <= 8192; steps *= 2) {
        const double fine = error_of(plan, problem, steps, integration);
        if (fine < clear) break;
        order = std::log2(coarse / fine);
        coarse = fine;
    }
    return order;
}

StagePlan two_half_euler_steps() {
    return {"two half Euler steps", "", "", 2, 2, {first_stage, {{{0, 1.0}}, {{0, 0.5}}, 1, 1}}, {{{1, 1.0}}, {{1, 0.5}}}, {}};
}

StagePlan dumka3_degree_3() {
    const double a21 = 0.924574112262462, a31 = 0.085748762860431, a32 = 0.28771294386877, a43 = 0.6265382932708;
    const double c3 = a31 + a32, c4 = c3 + a43;
    return {"dumka3-p0",
            "",
            "",
            3,
            4,
            {first_stage,
             {{{0, 1.0}}, {{0, a21}}, -1, 1},           // g2
             {{{0, 1.0}}, {{0, a31}, {1, a32}}, 1, 2},  // g3
             {{{1, 1.0}}, {{2, a43}}, 2, 3}},           // y(t + h)
            {{{2, 1.0}}, {}},
            Combination{{}, {{1, 0.5 * c3}, {3, -0.5 * c3}, {2, 0.5 * (c4 - a21)}, {0, -0.5 * (c4 - a21)}}}};
}

StagePlan dumka3_degree_6() {
    const double e1 = 0.1042566436020026, e2 = 0.3892933924117778, e3 = 0.1231817161250036;
    const double a21 = -0.4314789924333955, a31 = 0.4933498959876315, a32 = -0.2911642035969445, a43 = 0.1810825554705292;
    return {"dumka3-p1",
            "",
            "",
            3,
            4,
            {first_stage,
             {{{0, 1.0}}, {{0, e1}}, 1, 1},
             {{{1, 1.0}}, {{1, e2}}, 2, 2},
             {{{2, 1.0}}, {{2, e3}}, 1, 1},  // last block begins: f0 in slope slot 1
             {{{1, 1.0}}, {{1, a21}}, -1, 2},
             {{{1, 1.0}}, {{1, a31}, {2, a32}}, 2, 3}},
            {{{2, 1.0}}, {{3, a43}}},
            {}};
}

}  // namespace cvtflow::engine::test
