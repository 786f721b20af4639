#include "engine/method/analysis/stability.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "engine/method/compiled_plan.hpp"

namespace cvtflow::engine {

namespace {

using Complex = std::complex<double>;

/// Executes a plan on y' = z y with h = 1; keeps its slots between calls.
class LinearProblem {
public:
    explicit LinearProblem(const StagePlan& plan)
        : plan_(plan), states_(static_cast<std::size_t>(plan.state_slots)), slopes_(static_cast<std::size_t>(plan.slope_slots)) {}

    [[nodiscard]] Complex factor(Complex z) { return run(z, 1.0, -1); }

    /// What a unit error made in one stage has become at the step's end.
    [[nodiscard]] Complex error_factor(Complex z, int stage) { return run(z, 0.0, stage); }

    /// Largest |Y| of all stages in the last run.
    [[nodiscard]] double largest() const { return largest_; }

    [[nodiscard]] int stages() const { return plan_.stages(); }

private:
    [[nodiscard]] Complex run(Complex z, double start, int disturbed) {
        states_[0] = start;
        largest_ = 0.0;
        for (int i = 0; i < plan_.stages(); ++i) {
            const PlanStep step = plan_.stage(i);
            const Complex y = combine(step) + (i == disturbed ? 1.0 : 0.0);
            largest_ = std::max(largest_, std::abs(y.real()) + std::abs(y.imag()));
            if (step.keep >= 0) states_[static_cast<std::size_t>(step.keep)] = y;
            // Written out: operator* of std::complex checks for infinities and is several times slower.
            slopes_[static_cast<std::size_t>(step.slope)] = {z.real() * y.real() - z.imag() * y.imag(),
                                                             z.real() * y.imag() + z.imag() * y.real()};
        }
        return combine(plan_.result());
    }

    [[nodiscard]] Complex combine(const PlanStep& step) const {
        Complex sum = 0.0;
        for (const Term& term : step.states) sum += term.factor * states_[static_cast<std::size_t>(term.slot)];
        for (const Term& term : step.slopes) sum += term.factor * slopes_[static_cast<std::size_t>(term.slot)];
        return sum;
    }

    CompiledPlan plan_;
    std::vector<Complex> states_;
    std::vector<Complex> slopes_;
    double largest_ = 0.0;
};

constexpr int samples = 2000;

/// Largest value of a function on [-length, 0], sampled as densely towards both ends as Chebyshev's points.
template <class Function>
double largest_on(double length, Function function) {
    double largest = 0.0;
    for (int i = 0; i <= samples; ++i)
        largest = std::max(largest, function(0.5 * length * (std::cos(std::numbers::pi * i / samples) - 1.0)));
    return largest;
}

}  // namespace

std::complex<double> stability_function(const StagePlan& plan, std::complex<double> z) { return LinearProblem(plan).factor(z); }

std::function<std::complex<double>(std::complex<double>)> stability_function(const StagePlan& plan) {
    return [problem = LinearProblem(plan)](Complex z) mutable { return problem.factor(z); };
}

double stability_reach(const StagePlan& plan, std::complex<double> direction, double tolerance, double enough) {
    LinearProblem problem(plan);
    const auto stable = [&](double r) { return std::abs(problem.factor(r * direction)) <= 1.0 + tolerance; };
    const double stages = problem.stages();
    const double limit = std::min(2.0 * stages * stages + 10.0, enough);
    const double stride = std::max(0.01, stages / 4000.0);
    double inside = 0.0;
    double outside = stride;
    while (stable(outside)) {
        inside = outside;
        outside += stride;
        if (inside > limit) return inside;
    }
    for (int halving = 0; halving < 40; ++halving) {
        const double middle = 0.5 * (inside + outside);
        (stable(middle) ? inside : outside) = middle;
    }
    return inside;
}

double real_stability(const StagePlan& plan, double tolerance) { return stability_reach(plan, -1.0, tolerance); }

double imaginary_stability(const StagePlan& plan, double tolerance) { return stability_reach(plan, {0.0, 1.0}, tolerance); }

double stage_growth(const StagePlan& plan, double length) {
    LinearProblem problem(plan);
    return largest_on(length, [&](double z) {
        (void)problem.factor(z);
        return problem.largest();
    });
}

double perturbation_gain(const StagePlan& plan, double length) {
    LinearProblem problem(plan);
    return largest_on(length, [&](double z) {
        double gain = 0.0;
        for (int stage = 1; stage < problem.stages(); ++stage) gain = std::max(gain, std::abs(problem.error_factor(z, stage)));
        return gain;
    });
}

}  // namespace cvtflow::engine
