/// Predicted and measured largest stable steps. As a command: cvtflow-lab stability leapfrog-rkc … --scene baseline

#include "bench/method/laboratory_methods.hpp"
#include "bench/method/stability/predicted_step.hpp"
#include "bench/method/stability/step_search.hpp"
#include "bench/study/stability/measured_step.hpp"
#include "tasks/run/simulation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "bench/method/implicit/catalogue.hpp"
#include "bench/study/run_watch.hpp"
#include "tasks/method/method.hpp"
#include "tasks/run/run.hpp"
#include "tests/tasks/settled_tiny_fixture.hpp"
#include "tests/temporary_file_fixture.hpp"

namespace cvtflow::bench {

using namespace tasks;
using tasks::test::settled_tiny;

namespace {

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

TEST(LargestStep, IsMeasuredAsPredictedOnTheSmallestScene) {
    const Place tiny(settled_tiny());
    for (const char* method : {"rk4", "euler", "dumka3-p3", "rkc-s10", "dumka3", "leapfrog-rkc", "leapfrog-chebyshev", "leapfrog-sweep"})
        expect_agreement(tiny, method);
}

TEST(LargestStep, IsMeasuredAsPredictedOnTheBaseline) {
    const Place baseline(ready("baseline"));
    expect_agreement(baseline, "leapfrog-chebyshev");
    expect_agreement(baseline, "rk4");
}

TEST(LargestStep, OfALeapfrogIsBelowTwoMicrosecondsWhereItsRunsWentWrong) {
    const Place control(ready("control"));
    const StepLimit limit = predicted_step_limit(control.chain, "leapfrog-chebyshev");
    EXPECT_LT(limit.step, 2e-6);
    EXPECT_GT(limit.step, 1.8e-6);  // with which these runs are right
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
    const Place tiny(settled_tiny());
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
    const Place tiny(settled_tiny());
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
TEST(NightlyLargestStep, IsMeasuredAsPredictedForAllMethodsAtMediumDetail) { expect_all(Place(ready("control"))); }
/// Settled as in the scene, for 10 ms. (At 1 ms, as in the short test, tips still come to the sheaves, and contacts pass their
/// kink within a measured step.)
TEST(NightlyLargestStep, IsMeasuredAsPredictedForAllMethodsOnTheSmallestScene) {
    Scene tiny = ready("tiny");
    const cvtflow::tests::TemporaryFile state("largest_step");
    const std::string& file = state.path();
    settle_scene(tiny, file, {});
    set_values(tiny, std::vector<std::string>{"start.state=" + file});
    expect_all(Place(tiny));
}

}  // namespace
}  // namespace cvtflow::bench
