#include "bench/method/analysis/stability.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "engine/method/compiled_plan.hpp"

namespace cvtflow::bench {

namespace {

using Complex = std::complex<double>;

/// Executes a plan on y' = z y with h = 1; keeps its slots between calls.
class LinearProblem {
public:
    explicit LinearProblem(const StagePlan& plan)
        : plan_(plan), states_(static_cast<std::size_t>(plan.state_slots)), slopes_(static_cast<std::size_t>(plan.slope_slots)) {}

    [[nodiscard]] Complex factor(Complex z) { return run(z, 1.0, -1); }

    /// Factor of an error of one stage at the end of the step.
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

/// |factor| of a plan at neighbouring points of a ray, side by side: the same operations as LinearProblem, for each point.
class RayProblem {
public:
    static constexpr int points = 8;
    using Lanes = Eigen::Array<double, points, 1>;  ///< one number per point

    RayProblem(const StagePlan& plan, Complex direction)
        : plan_(plan),
          direction_(direction),
          states_(static_cast<std::size_t>(plan.state_slots)),
          slopes_(static_cast<std::size_t>(plan.slope_slots)) {}

    [[nodiscard]] int stages() const { return plan_.stages(); }

    /// @param r distances from 0 along the ray [1]   @return |factor| there
    [[nodiscard]] Lanes magnitudes(const Lanes& r) {
        const Pair z{r * direction_.real(), r * direction_.imag()};
        states_[0] = {Lanes::Ones(), Lanes::Zero()};
        for (int i = 0; i < plan_.stages(); ++i) {
            const PlanStep step = plan_.stage(i);
            const Pair y = combine(step);
            if (step.keep >= 0) states_[static_cast<std::size_t>(step.keep)] = y;
            slopes_[static_cast<std::size_t>(step.slope)] = {z.real * y.real - z.imag * y.imag, z.real * y.imag + z.imag * y.real};
        }
        const Pair result = combine(plan_.result());
        Lanes magnitudes;
        for (int k = 0; k < points; ++k) magnitudes[k] = std::abs(Complex(result.real[k], result.imag[k]));
        return magnitudes;
    }

private:
    struct Pair {
        Lanes real, imag;
    };

    [[nodiscard]] Pair combine(const PlanStep& step) const {
        Pair sum{Lanes::Zero(), Lanes::Zero()};
        for (const Term& term : step.states) add(term.factor, states_[static_cast<std::size_t>(term.slot)], sum);
        for (const Term& term : step.slopes) add(term.factor, slopes_[static_cast<std::size_t>(term.slot)], sum);
        return sum;
    }
    static void add(double factor, const Pair& value, Pair& sum) {
        sum.real += factor * value.real;
        sum.imag += factor * value.imag;
    }

    CompiledPlan plan_;
    Complex direction_;
    std::vector<Pair> states_, slopes_;
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
    RayProblem problem(plan, direction);
    const double stages = problem.stages();
    const double limit = std::min(2.0 * stages * stages + 10.0, enough);
    const double stride = std::max(0.01, stages / 4000.0);
    double inside = 0.0, outside = stride;
    for (bool found = false; !found;) {
        RayProblem::Lanes r;
        r[0] = outside;
        for (int k = 1; k < RayProblem::points; ++k) r[k] = r[k - 1] + stride;
        const RayProblem::Lanes magnitudes = problem.magnitudes(r);
        for (int k = 0; k < RayProblem::points && !found; ++k) {
            if (inside > limit) return inside;
            found = !(magnitudes[k] <= 1.0 + tolerance);
            (found ? outside : inside) = r[k];
        }
        if (!found) outside = r[RayProblem::points - 1] + stride;
    }
    LinearProblem halved(plan);
    for (int halving = 0; halving < 40; ++halving) {
        const double middle = 0.5 * (inside + outside);
        (std::abs(halved.factor(middle * direction)) <= 1.0 + tolerance ? inside : outside) = middle;
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

}  // namespace cvtflow::bench
