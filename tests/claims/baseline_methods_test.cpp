/// Claims about methods on the baseline at full detail, against tight rk4. Stabilised ones: what was published about DUMKA3, and what
/// fitted polynomials add. The leapfrog with friction inside the step, against RK4 at 12.5 ns. Implicit ones with steps of 2 µs: how
/// often Newton's method converges, and what methods lose that see one tangent of the friction per step. As commands:
///     cvtflow-lab compare baseline rk4@50ns dumka3-p5@2us fitted@2us …
///     cvtflow-lab compare baseline rk4@50ns dumka3-p5@2us leapfrog-rkc@1us leapfrog-rkc@2us leapfrog-chebyshev@2us

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "bench/method/implicit/catalogue.hpp"
#include "bench/method/implicit/linear_plan.hpp"
#include "bench/study/error_measure.hpp"
#include "bench/study/run_watch.hpp"
#include "engine/method/dumka3.hpp"
#include "tests/claims/method_trial_fixture.hpp"
#include "tests/claims/operating_point_fixture.hpp"

namespace cvtflow::claims {
namespace {

const engine::Cancellation uncancelled;

std::vector<std::string> stepped(const std::string& method, const std::string& step) {
    return {"run.method=" + method, "run.step=" + step};
}

/// 120 us from a settled state, tips free to enter and leave, against RK4 at 12.5 ns.
bench::ErrorMeasure measure_of(const std::string& scene, const bench::MeasureSettings& settings = {}) {
    return {ready_scene(scene, {"run.schedule=serial"}), settings, uncancelled};
}

const bench::ErrorMeasure& baseline() {
    static const bench::ErrorMeasure measure = measure_of("baseline");
    return measure;
}

bench::TrajectoryErrors errors(const bench::ErrorMeasure& measure, const std::string& method, const std::string& step) {
    const bench::TrajectoryErrors found = measure.errors(measure.run(stepped(method, step))).overall;
    testing::Test::RecordProperty(method + "@" + step, std::to_string(found.axial_force));
    return found;
}

double axial_error(const std::string& method, const std::string& step) { return errors(baseline(), method, step).axial_force; }

/// Times of methods with their steps over that of the last one: alternating runs of the baseline, the fastest of three.
std::vector<double> times_over_last(const std::vector<std::vector<std::string>>& methods) {
    std::vector<double> fastest(methods.size(), std::numeric_limits<double>::infinity());
    for (int round = 0; round < 3; ++round)
        for (std::size_t k = 0; k < methods.size(); ++k) fastest[k] = std::min(fastest[k], baseline().run(methods[k]).wall_per_second());
    for (std::size_t k = 0; k < methods.size(); ++k) {
        fastest[k] /= fastest.back();
        testing::Test::RecordProperty(methods[k].front() + "_over_" + methods.back().front(), std::to_string(fastest[k]));
    }
    return fastest;
}

TEST(NightlyStabilised, TheRunHasTransitions) { EXPECT_GT(baseline().reference().counters.detected, 0); }

TEST(NightlyStabilised, PolynomialFiveOfDumka3IsGoodAtTwoMicrosecondsAndNineIsNot) {
    EXPECT_LT(axial_error("dumka3-p5", "2us"), 1e-4);
    EXPECT_GT(axial_error("dumka3-p9", "2us"), 1e-3);
    EXPECT_GT(axial_error("dumka3-p9", "1us"), 1e-3);
}

TEST(NightlyStabilised, NoPolynomialOfDumka3IsGoodAtFourMicroseconds) {
    for (int polynomial = 0; polynomial < engine::dumka3_polynomials; ++polynomial)
        EXPECT_GT(axial_error("dumka3-p" + std::to_string(polynomial), "4us"), 1e-3) << polynomial;
}

/// Published: 5.9 times (with another step control and on another machine).
TEST(NightlyStabilised, PolynomialFiveOfDumka3IsFiveTimesFasterThanRk4) {
    EXPECT_GE(times_over_last({stepped("rk4", "50ns"), stepped("dumka3-p5", "2us")})[0], 5.0);
}

/// Twice as long: six transitions.
const bench::ErrorMeasure& longer() {
    static const bench::ErrorMeasure measure = measure_of("baseline", {240e-6, 12e-6, stepped("rk4", "12.5ns"), 1});
    return measure;
}

/// Fewest evaluations per simulated second among steps whose axial error is at most 1e-3, at most 1e-4; infinite if there is none.
struct Cheapest {
    double rough = std::numeric_limits<double>::infinity();
    double fine = std::numeric_limits<double>::infinity();
};

Cheapest cheapest(const std::string& family, const std::vector<std::string>& methods) {
    Cheapest fewest;
    for (const std::string& method : methods) {
        for (const char* step : {"0.5us", "1us", "1.5us", "2us", "3us", "4us"}) {
            const bench::Trajectory run = longer().run(stepped(method, step));
            const double error = longer().errors(run).overall.axial_force;
            if (error <= 1e-3) fewest.rough = std::min(fewest.rough, run.evaluations_per_second());
            if (error <= 1e-4) fewest.fine = std::min(fewest.fine, run.evaluations_per_second());
        }
    }
    testing::Test::RecordProperty(family + "_at_1e-3", std::to_string(fewest.rough));
    testing::Test::RecordProperty(family + "_at_1e-4", std::to_string(fewest.fine));
    return fewest;
}

/// Each family with what suits it: the published polynomials, and stages by the spectrum for the others. At 1e-3 nothing is cheaper than
/// fitted polynomials. At 1e-4 they are level with DUMKA3-P4 (measured 1.58e7 against 1.46e7), and plain RKC at a microsecond is cheaper
/// than both (1.15e7): its stages do not reach beyond the step.
TEST(NightlyStabilised, FittedPolynomialsNeedTheFewestEvaluationsForAThousandth) {
    const Cheapest fitted = cheapest("fitted", {"fitted"});
    const Cheapest dumka3 = cheapest("dumka3", {"dumka3-p4", "dumka3-p5", "dumka3-p6", "dumka3-p7", "dumka3-p8"});
    const Cheapest rkc = cheapest("rkc", {"rkc", "rkc-s20-e20"});
    const Cheapest serk2 = cheapest("serk2", {"serk2-s10", "serk2-s20"});
    for (const Cheapest& rival : {dumka3, rkc, serk2}) EXPECT_LT(fitted.rough, rival.rough);
    EXPECT_LT(fitted.fine, 1.2 * dumka3.fine);
}

/// One force evaluation per step, 14 where DUMKA3-P5 takes 27 of 2 us.
TEST(FrictionLeapfrogClaim, AtTwoMicrosecondsItIsAsExactAsDumka3WithOneEvaluationPerStep) {
    for (const std::string method : {"leapfrog-rkc", "leapfrog-chebyshev"}) {
        const bench::Trajectory run = baseline().run(stepped(method, "2us"));
        const bench::TrajectoryErrors found = baseline().errors(run).overall;
        EXPECT_LT(found.axial_force, 2e-4) << method;
        EXPECT_LT(found.tension, 1e-4) << method;
        EXPECT_LT(found.slip, 1e-3) << method;
        EXPECT_LE(run.counters.evaluations, run.counters.steps + run.counters.truncated) << method;
    }
}

/// Order 2: errors fall at least by 2^1.6 when the step is halved; transitions and kinks of the law take some of it.
TEST(FrictionLeapfrogClaim, ItsErrorFallsLikeTheSquareOfTheStep) {
    const double coarse = errors(baseline(), "leapfrog-rkc", "2us").axial_force,
                 fine = errors(baseline(), "leapfrog-rkc", "500ns").axial_force;
    EXPECT_LT(std::log2(coarse / fine) / 2.0, 2.4);
    EXPECT_GT(std::log2(coarse / fine) / 2.0, 1.6);
}

/// Errors that are documented for one scene hold on another.
TEST(NightlyFrictionLeapfrog, KeepsItsErrorsOnLowOverdriveAndTheLoadRamp) {
    for (const std::string scene : {"low", "overdrive", "load_ramp"}) {
        const bench::ErrorMeasure measure = measure_of(scene);
        for (const char* method : {"leapfrog-rkc", "leapfrog-chebyshev"}) {  // the second is what scenes use that name no method
            const bench::TrajectoryErrors found = errors(measure, method, "2us");
            EXPECT_LT(found.axial_force, 1e-3) << scene << ' ' << method;
            EXPECT_LT(found.tension, 1e-3) << scene << ' ' << method;
        }
    }
}

TEST(NightlyFrictionLeapfrog, IsFiveTimesFasterThanDumka3P5AndThirtyTimesFasterThanRk4) {
    const auto times = times_over_last({stepped("rk4", "50ns"), stepped("dumka3-p5", "2us"), stepped("leapfrog-chebyshev", "2us")});
    EXPECT_GE(times[0], 30.0);
    EXPECT_GE(times[1], 5.0);
}

class NightlyImplicit : public testing::Test {
protected:
    static constexpr double step = 2e-6, duration = 100e-6;

    static const tasks::FrozenStart& start() {
        static const tasks::FrozenStart settled = bench::frozen_start(tasks::Simulation(scene()));
        return settled;
    }
    static bench::TrialEnd end(const std::string& method, double h = step) {
        return bench::try_method(scene().parameters, start(), method, h, duration);
    }
    static double axial_error(const bench::TrialEnd& end) { return bench::relative_error(end.axial_force, reference().axial_force); }

private:
    static const tasks::Scene& scene() {
        static const tasks::Scene baseline = tasks::read_scene(CVTFLOW_SOURCE_DIR "/scenes/baseline.toml");
        return baseline;
    }
    static const bench::TrialEnd& reference() {
        static const bench::TrialEnd tight = end("rk4", 12.5e-9);
        return tight;
    }
};

TEST_F(NightlyImplicit, NewtonFromRestWithBacktrackingConverges) {
    // Survey: 2 to 5 iterations, no step unconverged; the published finding that Newton fails is that of the next test.
    const bench::TrialEnd trial = end("trapezoidal-analytic");
    ASSERT_FALSE(trial.fault);
    EXPECT_EQ(trial.newton->unconverged, 0);
    EXPECT_LT(static_cast<double>(trial.newton->iterations), 6.0 * static_cast<double>(trial.newton->steps));
    EXPECT_LT(axial_error(trial), 2e-4);
}

TEST_F(NightlyImplicit, PlainNewtonFromTheExplicitStepFailsInManySteps) {
    const bench::TrialEnd trial = end("trapezoidal-plain");
    ASSERT_FALSE(trial.fault);
    EXPECT_GT(3 * trial.newton->unconverged, trial.newton->steps);
    EXPECT_GT(axial_error(trial), 1e-2);
}

TEST_F(NightlyImplicit, EveryWayToTheMatrixEndsAtTheSameError) {
    const double exact = axial_error(end("trapezoidal-analytic"));
    for (const bench::NewtonVariant& variant : bench::newton_variants()) {
        if (!variant.options.backtracking) continue;
        const bench::TrialEnd trial = end(variant.name);
        ASSERT_FALSE(trial.fault) << variant.name;
        EXPECT_LE(trial.newton->unconverged, trial.newton->steps / 20) << variant.name;
        EXPECT_NEAR(axial_error(trial), exact, 0.1 * exact) << variant.name;
    }
}

TEST_F(NightlyImplicit, LinearlyImplicitMethodsLoseOnSaturatingFriction) {
    // With the same step, orders 2 to 4, exact Jacobians: a hundred times the error of the trapezoidal rule, whose friction is solved for.
    const double solved = axial_error(end("trapezoidal-analytic"));
    for (const bench::LinearPlan& plan : bench::linear_plans()) {
        const bench::TrialEnd trial = end(plan.name);
        if (!trial.fault) {
            EXPECT_GT(axial_error(trial), 100.0 * solved) << plan.name;
        }
    }
}

}  // namespace
}  // namespace cvtflow::claims
