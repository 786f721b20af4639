/// Predicted and measured largest stable steps, of eigenvalues and of a frozen state. As a command: cvtflow-lab stability leapfrog-rkc …
/// --scene baseline

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "bench/method/analysis/eigenvalues.hpp"
#include "bench/method/analysis/order.hpp"
#include "bench/method/analysis/stability.hpp"
#include "bench/method/implicit/catalogue.hpp"
#include "bench/method/laboratory_methods.hpp"
#include "bench/method/stability/predicted_step.hpp"
#include "bench/study/spectrum.hpp"
#include "bench/study/stability/frozen_step.hpp"
#include "bench/study/stability/stable_step.hpp"
#include "engine/method/catalogue.hpp"
#include "tasks/method/method.hpp"
#include "tasks/run/run.hpp"
#include "tasks/run/simulation.hpp"
#include "tests/lab/study/brief_fixture.hpp"
#include "tests/temporary_file_fixture.hpp"

namespace cvtflow::bench {

using namespace tasks;

namespace {

using Values = std::vector<std::complex<double>>;

/// A scene and its state, linearised.
struct Place {
    Scene scene;
    FrozenStart start;
    model::Variator variator;
    LinearChain chain;

    explicit Place(const Scene& of)
        : scene(of), start(frozen_start(Simulation(of))), variator(of.parameters), chain(variator, of.parameters, start) {}
};

[[nodiscard]] Scene ready(const std::string& name, const std::vector<std::string>& settings = {}) {
    Scene scene = read_scene(CVTFLOW_SOURCE_DIR "/scenes/" + name + ".toml");
    set_values(scene, std::vector<std::string>{"run.schedule=serial"});
    set_values(scene, settings);
    return scene;
}

/// Scene `tiny`, settled for its 10 ms, once per process.
[[nodiscard]] Scene steady_tiny() {
    static const Scene steady = [] {
        Scene scene = ready("tiny");
        static const cvtflow::tests::TemporaryFile state("largest_step");
        settle_scene(scene, state.path(), {});
        set_values(scene, std::vector<std::string>{"start.state=" + state.path()});
        return scene;
    }();
    return steady;
}

/// Where prediction misses by more, measured over predicted: rock2 on tiny 0.58 (it chooses among tables by the step, so that stable and
/// unstable steps alternate).
const std::set<std::pair<std::string, std::string>> known_misses{{"tiny", "rock2"}};

/// Requires agreement within five hundredths.
void expect_agreement(const Place& place, const std::string& method) {
    const StepLimit predicted = predicted_step_limit(place.chain, method);
    const MeasuredLimit measured = measured_step_limit(place.scene, method, place.start, predicted.step);
    testing::Test::RecordProperty(place.scene.name + " " + method,
                                  text_of(predicted) + ", measured " + std::to_string(1e6 * measured.step) + " us");
    if (std::isinf(predicted.step)) {
        EXPECT_TRUE(std::isinf(measured.step)) << method << ": " << measured.step;
    } else if (known_misses.contains({place.scene.name, method})) {  // remove corrected ones from the list
        EXPECT_GT(std::abs(measured.step / predicted.step - 1.0), 0.05) << place.scene.name << " " << method << ": " << text_of(predicted);
    } else {
        EXPECT_NEAR(measured.step / predicted.step, 1.0, 0.05) << place.scene.name << " " << method << ": " << text_of(predicted);
    }
}

/// The state is a settled one: while contacts change what they do within a step, disturbances grow by that. After 1 ms dumka3 and
/// leapfrog-rkc measured 0.79 and 0.89 of the prediction, by real multipliers of 1.5 to 4.4 that are others in each step; dumka3, of longer
/// steps, 0.72 after 2 ms too. After 10 ms both agree within 0.2 %.
TEST(LargestStep, IsMeasuredAsPredictedOnTheSmallestScene) {
    const Place tiny(steady_tiny());
    for (const char* method : {"rk4", "euler", "dumka3-p3", "rkc-s10", "dumka3", "leapfrog-rkc", "leapfrog-chebyshev", "leapfrog-sweep"})
        expect_agreement(tiny, method);
}

TEST(LargestStep, IsMeasuredAsPredictedOnTheBaseline) {
    const Place baseline(ready("baseline"));
    expect_agreement(baseline, "leapfrog-chebyshev");
    expect_agreement(baseline, "rk4");
}

/// Runs of `control` over 20 ms close their balance to 0.03 % with 1.95 us, to 0.11 to 0.16 % with 2 to 2.1 us; with 2.15 us they miss it
/// by 0.8 % and are unreliable, with 2.2 us by 3.9 %, with 2.4 us by a factor of seven.
TEST(LargestStep, OfALeapfrogIsBetweenThoseWithWhichRunsAreRightAndWrong) {
    const Place control(ready("control"));
    const StepLimit limit = predicted_step_limit(control.chain, "leapfrog-chebyshev");
    EXPECT_LT(limit.step, 2.15e-6);
    EXPECT_GT(limit.step, 1.95e-6);
    EXPECT_EQ(limit.by, StepLimiter::oscillation);
    EXPECT_GT(limit.step * limit.oscillation, 1.0);
    EXPECT_LT(limit.step * limit.oscillation, 2.0);
}

/// v' = -c/m v, taken at velocities extrapolated over half a step: stable for h c/m < 1.
TEST(LargestStep, KnowsDampingThatALeapfrogTakesExplicitly) {
    const Place damped(ready("control", {"pulley.cylinder_damping=6e6 N*s/m", "pulley.sheave_mass=0.5 kg"}));
    const StepLimit limit = predicted_step_limit(damped.chain, "leapfrog-chebyshev");
    EXPECT_LT(limit.step, 1.0e-6);
    EXPECT_EQ(limit.by, StepLimiter::decay);
    expect_agreement(damped, "leapfrog-chebyshev");
}

TEST(LargestStep, IsWhereTheGrowthOfAStepPassesOne) {
    const Place tiny(steady_tiny());
    const double limit = predicted_step_limit(tiny.chain, "leapfrog-rkc").step;
    EXPECT_LE(predicted_growth(tiny.chain, "leapfrog-rkc", 0.97 * limit), 1.0 + growth_factor_tolerance);
    EXPECT_GT(predicted_growth(tiny.chain, "leapfrog-rkc", 1.03 * limit), 1.0 + growth_factor_tolerance);
}

TEST(LargestStep, ReportsThatLightSheavesSetIt) {
    const Place light(ready("control", {"pulley.sheave_mass=0.3 kg"})), usual(ready("control"));
    const StepLimit limit = predicted_step_limit(light.chain, "leapfrog-chebyshev");
    EXPECT_LT(limit.step, 0.9 * predicted_step_limit(usual.chain, "leapfrog-chebyshev").step);
    EXPECT_GT(limit.in_pulleys, 0.05);
    EXPECT_NE(text_of(limit).find("in shafts and sheaves"), std::string::npos) << text_of(limit);
    expect_agreement(light, "leapfrog-chebyshev");
}

TEST(LargestStep, OfTheTrapezoidalRuleHasNoLimit) {
    const Place tiny(steady_tiny());
    EXPECT_TRUE(std::isinf(predicted_step_limit(tiny.chain, "trapezoidal-full").step));
    EXPECT_EQ(predicted_step_limit(tiny.chain, "trapezoidal-full").by, StepLimiter::nothing);
    EXPECT_THROW((void)predicted_step_limit(tiny.chain, "rk5"), std::invalid_argument);
}

/// W-methods, and Newton's method with a matrix that is kept, take friction as their Jacobian has it; a contact that comes to its kink
/// within the step then grows for a while. So it does in the long steps of fitted. Linear stability does not speak of that (measured: 1.3
/// to 4.9 us).
[[nodiscard]] bool limited_by_kinks(const std::string& method) {
    const MethodProgram* program = find_program(method);
    if (program == nullptr) return false;
    for (const NewtonVariant& variant : newton_variants()) {
        const bool fresh = variant.options.matrix == NewtonMatrix::every_iteration || variant.options.matrix == NewtonMatrix::once_per_step;
        if (method == variant.name) return !fresh || !variant.options.backtracking;
    }
    return program->name == "fitted" ||
           (analysis_of(*program).stability != nullptr && analysis_of(*program).stability().equation == TestEquation::linear);
}

void expect_all(const Place& place) {
    for (const std::string& method : method_names()) {
        if (method != "leapfrog-rigid" && !limited_by_kinks(method)) expect_agreement(place, method);  // the places have pin halves
    }
}

TEST(NightlyLargestStep, IsMeasuredAsPredictedForAllMethodsOnTheBaseline) { expect_all(Place(ready("baseline"))); }
TEST(NightlyLargestStep, IsMeasuredAsPredictedForAllMethodsUnderControl) { expect_all(Place(ready("control"))); }
TEST(NightlyLargestStep, IsMeasuredAsPredictedForAllMethodsOnTheSmallestScene) { expect_all(Place(steady_tiny())); }

TEST(StableStep, IsTheReachOfTheRegionOverASingleEigenvalue) {
    for (const char* name : {"rk4", "heun", "dopri54", "dumka3-p3", "dumka3-p5", "rkc-s10"}) {
        const engine::StagePlan& plan = *engine::find_method(name);
        // The growth that is tolerated makes it a little longer; |R| rises by much more than 1e-4 per 0.1 %.
        const StableStep real = largest_stable_step(plan, Values{-1e7});
        EXPECT_NEAR(real.step * 1e7 / bench::real_stability(plan), 1.0, 1e-3) << name;
        EXPECT_EQ(real.limiting, std::complex<double>(-1e7));
    }
    const StableStep spring = largest_stable_step(*engine::find_method("rk4"), Values{{0.0, -1e6}, {0.0, 1e6}});
    EXPECT_NEAR(spring.step * 1e6, std::sqrt(8.0), 1e-3);
    EXPECT_EQ(spring.limiting, std::complex<double>(0.0, 1e6));
}

TEST(StableStep, IsLimitedByTheEigenvalueThatLeavesFirst) {
    // rk4 reaches 2.785 on the real axis and 2.828 on the imaginary one.
    const StableStep decay = largest_stable_step(*engine::find_method("rk4"), Values{-1e6, {0.0, 0.9e6}, {0.0, -0.9e6}, -5e5, 0.0});
    EXPECT_EQ(decay.limiting, std::complex<double>(-1e6));
    const StableStep spring = largest_stable_step(*engine::find_method("rk4"), Values{-1e6, {0.0, 1.1e6}, {0.0, -1.1e6}});
    EXPECT_EQ(spring.limiting, std::complex<double>(0.0, 1.1e6));
}

TEST(StableStep, OfEulersMethodOnADampedOscillationIsTwiceDampingOverSquare) {
    // |1 + h λ| ≤ 1 for h ≤ -2 Re λ/|λ|²; frequencies so low that 100 1/s of growth would be tolerated at much longer steps are not tested.
    const std::complex<double> value(-2e4, 1e6);
    const double step = largest_stable_step(*engine::find_method("euler"), Values{value}).step;
    EXPECT_NEAR(step / (2.0 * 2e4 / std::norm(value)), 1.0, 0.01);
}

TEST(StableStep, ForgivesWhatGrowsByItself) {
    const engine::StagePlan& rk4 = *engine::find_method("rk4");
    EXPECT_NEAR(largest_stable_step(rk4, Values{-1e6, 5e3}).step, largest_stable_step(rk4, Values{-1e6}).step, 1e-12);
}

TEST(StableStep, WithoutEigenvaluesIsNotDefined) {
    EXPECT_THROW((void)largest_stable_step(*engine::find_method("rk4"), Values{}), std::invalid_argument);
    EXPECT_THROW((void)largest_stable_step(*engine::find_method("rk4"), Values{0.0}), std::invalid_argument);
}

TEST(StableStep, StabilityFunctionReadyForManyCallsIsTheSame) {
    const engine::StagePlan& plan = *engine::find_method("dumka3-p4");
    const auto factor = stability_function(plan);
    for (const std::complex<double> z : {std::complex<double>(-100.0), {-3.0, 2.0}, {0.0, 1.0}})
        EXPECT_EQ(factor(z), stability_function(plan, z));
}

TEST(FrozenStep, ErrorsOfOneStepGrowWithOrderPlusOne) {
    const model::Variator variator(brief_scene().parameters);
    const std::vector<double> steps{160e-9, 80e-9};
    for (const engine::StagePlan& plan : engine::methods()) {
        // Beyond order 4 a step of 80 ns is exact to rounding; stabilised methods are for longer steps.
        if (plan.stages.size() > 8 || bench::order_of(plan) > 4) continue;
        const std::vector<LocalError> errors = local_errors(variator, plan, brief_start(), steps);
        const double slope = std::log2(errors[0].velocities / errors[1].velocities);
        EXPECT_NEAR(slope, bench::order_of(plan) + 1, 0.35) << plan.name;
    }
}

TEST(FrozenStep, TheReferenceAgreesWithItself) {
    const model::Variator variator(brief_scene().parameters);
    const std::vector<double> steps{12.5e-9};  // the reference takes one step, too
    const LocalError none = local_errors(variator, *engine::find_method("rk4"), brief_start(), steps, 1).front();
    EXPECT_EQ(none.positions, 0.0);
    EXPECT_EQ(none.velocities, 0.0);
    EXPECT_EQ(none.axial_force, 0.0);
    EXPECT_EQ(none.tension, 0.0);
}

TEST(FrozenStep, ManyStepsAreAsManySingleOnes) {
    const model::Variator variator(brief_scene().parameters);
    FrozenStepper stepper(variator, *engine::find_method("heun"), brief_start().phases);
    std::vector<double> at_once = brief_start().state, one_by_one = brief_start().state;
    stepper.advance(0.0, 20e-9, 3, at_once);
    for (int number = 0; number < 3; ++number) stepper.advance(number * 20e-9, 20e-9, 1, one_by_one);
    EXPECT_EQ(at_once, one_by_one);
}

TEST(FrozenStep, BeginsWithTheProbedPhases) {
    Scene ring = read_scene(CVTFLOW_SOURCE_DIR "/scenes/free_ring.toml");
    const Simulation simulation(ring);
    const FrozenStart free = frozen_start(simulation);
    EXPECT_THAT(free.phases, testing::Each(model::Phase::free));
    EXPECT_THAT(brief_start().phases, testing::Contains(model::Phase::touching));
}

TEST(MeasuredStep, IsWhatTheSpectrumPredictsWithinFivePercent) {
    const model::Variator variator(brief_scene().parameters);
    const FrozenStart& start = brief_start();
    const bench::Eigenvalues all = spectrum(variator, start.time, start.state, start.phases);
    double growth = 0.0;  // barely settled, something still buckles
    for (const auto& value : all) growth = std::max(growth, value.real());
    for (const char* name : {"rk4", "heun", "dumka3-p2"}) {
        const engine::StagePlan& plan = *engine::find_method(name);
        const double predicted = largest_stable_step(plan, all).step;
        const MeasuredStep measured = measured_stable_step(variator, plan, start, predicted, growth);
        EXPECT_NEAR(measured.limit() / predicted, 1.0, 0.05) << name;
        EXPECT_LT(measured.stable, measured.unstable);
        EXPECT_GT(measured.evaluations, 0);
    }
}

TEST(MeasuredStep, ReportsWhenTheLimitIsNotWhereItIsExpected) {
    const model::Variator variator(brief_scene().parameters);
    const engine::StagePlan& rk4 = *engine::find_method("rk4");
    const MeasuredStep beyond = measured_stable_step(variator, rk4, brief_start(), 1e-9);
    EXPECT_EQ(beyond.unstable, 0.0);
    EXPECT_DOUBLE_EQ(beyond.limit(), 1.6e-9);
    const MeasuredStep below = measured_stable_step(variator, rk4, brief_start(), 1e-5);
    EXPECT_EQ(below.stable, 0.0);
}

TEST(MeasuredStep, AHeldStateStandsStillUntilItIsDisturbed) {
    const model::Variator variator(brief_scene().parameters);
    const FrozenStart& start = brief_start();
    FrozenStepper stepper(variator, *engine::find_method("rk4"), start.phases);
    stepper.hold(start.time, start.state);
    std::vector<double> state = start.state;
    stepper.advance(start.time, 1e-8, 10, state);
    EXPECT_EQ(state, start.state);
}

}  // namespace
}  // namespace cvtflow::bench
