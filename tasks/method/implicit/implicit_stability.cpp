#include "tasks/method/implicit/implicit_stability.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <vector>

namespace cvtflow::tasks {

namespace {

using Complex = std::complex<double>;

/// One step of u' = λ u, h = 1.
struct LinearStep {
    Complex z;
    int disturbed = -1;    ///< the stage whose state is off by 1
    double largest = 0.0;  ///< state of a stage, afterwards

    [[nodiscard]] Complex from(const LinearPlan& plan, Complex start);
};

Complex LinearStep::from(const LinearPlan& plan, Complex start) {
    std::vector<Complex> increments;
    const auto sum = [&](const std::vector<engine::Term>& terms) {
        Complex total = 0.0;
        for (const engine::Term& term : terms) total += term.factor * increments[static_cast<std::size_t>(term.slot)];
        return total;
    };
    for (const LinearStage& stage : plan.stages) {
        const bool off = static_cast<int>(increments.size()) == disturbed;
        const Complex state = start + sum(stage.states) + (off ? 1.0 : 0.0);
        largest = std::max(largest, std::abs(state));
        increments.push_back(stage.gamma * (z * state + sum(stage.right)) / (1.0 - stage.gamma * z));
    }
    return start + sum(plan.result);
}

[[nodiscard]] StageFigures stage_figures(const LinearPlan& plan, double decay) {
    LinearStep plain{-decay};
    StageFigures figures;
    figures.left = std::abs(plain.from(plan, 1.0));
    figures.growth = plain.largest;
    for (int stage = 0; stage < static_cast<int>(plan.stages.size()); ++stage)
        figures.gain = std::max(figures.gain, std::abs(LinearStep{-decay, stage}.from(plan, 0.0)));
    return figures;
}

}  // namespace

ProgramStability linear_stability(const LinearPlan& plan) {
    return {TestEquation::linear, [plan](double x, double y) { return std::abs(LinearStep{Complex(x, y)}.from(plan, 1.0)); },
            [plan](double decay) { return stage_figures(plan, decay); }, std::numeric_limits<double>::infinity()};
}

ProgramStability trapezoidal_stability() {
    const auto factor = [](Complex z) { return (1.0 + 0.5 * z) / (1.0 - 0.5 * z); };
    // What an iteration leaves of the residual is damped as much as the implicit half.
    const auto figures = [factor](double decay) { return StageFigures{1.0, 1.0 / (1.0 + 0.5 * decay), std::abs(factor(-decay))}; };
    return {TestEquation::linear,
            [factor](double x, double y) {
                return std::abs(factor({x, y}));
            },
            figures, std::numeric_limits<double>::infinity()};
}

}  // namespace cvtflow::tasks
