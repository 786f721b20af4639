/// Steps by error, reused slopes, methods that follow the spectrum: on the smallest scene.

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

#include "bench/study/run_watch.hpp"
#include "bench/study/spectrum.hpp"
#include "bench/study/stability/frozen_step.hpp"
#include "bench/study/tradeoff/error_measure.hpp"
#include "engine/executor/catalogue.hpp"
#include "engine/method/catalogue.hpp"
#include "tasks/method/method.hpp"
#include "tasks/method/spectral_bound.hpp"
#include "tasks/run/simulation.hpp"
#include "tests/engine/executor/executor_fixture.hpp"
#include "tests/sample_fixture.hpp"
#include "tests/tasks/tiny_fixture.hpp"

namespace cvtflow::tasks {
namespace {

using test::settled_tiny;

const engine::Cancellation not_cancelled;

struct ControlledOutcome {
    std::uint64_t hash;
    Counters counters;
    LocalErrorStatistics errors;
    Fault fault;
};

ControlledOutcome controlled_outcome(const Scene& scene, const Schedule& schedule = {}) {
    Simulation simulation(scene, schedule);
    SilentObserver silent;
    const Fault fault = simulation.advance({.until = simulation.time() + scene.run.until}, silent, not_cancelled);
    return {simulation.hash(), simulation.counters(), simulation.part().local_errors(), fault};
}

std::vector<std::string> with(const std::string& method, const std::string& step, std::vector<std::string> more = {}) {
    more.push_back("run.method=" + method);
    more.push_back("run.step=" + step);
    return more;
}

/// A transition costs the slope at the end of the step that it cuts, and the first slope after it.
TEST(ReusedSlopes, SaveAnEvaluationInEveryStepThatIsNotCut) {
    for (const auto& [method, stages, reused] : {std::tuple{"rk4", 4, 0},
                                                 {"dopri54", 7, 1},
                                                 {"dumka3-p1", 7, 1},
                                                 {"rkc-s5", 6, 1},
                                                 {"serk2-s10", 11, 1},
                                                 {"fitted-l20-w1-s9", 10, 1},
                                                 {"rock2-s6", 6, 0}}) {
        const ControlledOutcome run = controlled_outcome(settled_tiny(with(method, "50ns")));
        ASSERT_FALSE(run.fault) << method;
        EXPECT_EQ(Method(method).evaluations_per_step(), stages - reused) << method;
        EXPECT_GE(run.counters.evaluations, (stages - reused) * run.counters.steps + reused + 2 * run.counters.truncated * reused)
            << method;
        EXPECT_LE(run.counters.evaluations, (stages - reused) * run.counters.steps + reused + 2 * run.counters.truncated + 4) << method;
    }
}

/// Against steps that evaluate every stage, with the phases held. Times of stages differ in the last digit.
TEST(ReusedSlopes, AreThoseThatWouldBeEvaluated) {
    Simulation simulation(settled_tiny(with("dumka3-p1", "50ns", {"run.output_interval=1us", "run.state_interval=1us"})));
    SilentObserver silent;
    FrozenStart start = bench::frozen_start(simulation);
    ASSERT_FALSE(simulation.advance({.until = simulation.time() + 1e-6, .new_part = true}, silent, not_cancelled));
    for (int window = 0; simulation.counters().truncated > 0 && window < 40; ++window) {  // until one has no transition
        start = bench::frozen_start(simulation);
        ASSERT_FALSE(simulation.advance({.until = simulation.time() + 1e-6, .new_part = true}, silent, not_cancelled));
    }
    ASSERT_EQ(simulation.counters().truncated, 0);
    ASSERT_EQ(simulation.counters().steps, 20);
    bench::FrozenStepper stepper(simulation.workspace().variator, *engine::find_method("dumka3-p1"), start.phases);
    stepper.advance(start.time, 5e-8, 20, start.state);
    for (std::size_t k = 0; k < start.state.size(); ++k)
        EXPECT_NEAR(simulation.workspace().state()[k], start.state[k], 1e-10 * std::abs(start.state[k]) + 1e-12) << k;
}

TEST(ErrorControl, TighterTolerancesAreMoreExact) {
    bench::MeasureSettings settings;
    settings.duration = 24e-6;
    const bench::ErrorMeasure measure(settled_tiny(), settings, not_cancelled);
    for (const char* method : {"dopri54", "dumka3-p3", "rkc-s10"}) {
        double last = 1e300;
        for (const char* tolerance : {"1", "1e-2", "1e-4"}) {
            const bench::Trajectory run =
                measure.run(with(method, "1us", {"run.step_control=error", std::string("run.tolerance=") + tolerance}));
            ASSERT_FALSE(run.fault) << method << ": " << run.fault.message();
            const double error = measure.errors(run).overall.axial_force;
            EXPECT_LT(error, last) << method << ' ' << tolerance;
            last = error;
        }
        EXPECT_LT(last, 1e-4) << method;
    }
}

TEST(ErrorControl, EndsStepsAtOutputsAndStaysBelowTheTolerance) {
    const ControlledOutcome run =
        controlled_outcome(settled_tiny(with("dopri54", "10us", {"run.step_control=error", "run.tolerance=1e-3"})));
    ASSERT_FALSE(run.fault) << run.fault.message();
    EXPECT_GT(run.counters.rejected, 0) << "the first step is bench::far too long; largest error " << run.errors.largest << " in "
                                        << run.counters.steps;
    EXPECT_LE(run.errors.largest, 1e-3);
    EXPECT_GT(run.errors.mean(), 0.0);
    EXPECT_EQ(run.errors.steps, run.counters.steps);
}

TEST(ErrorControl, ReportsTheErrorOfFixedStepsWithoutChangingThem) {
    const ControlledOutcome fixed = controlled_outcome(settled_tiny(with("dopri54", "50ns")));
    const ControlledOutcome reported = controlled_outcome(settled_tiny(with("dopri54", "50ns", {"run.step_control=report"})));
    EXPECT_EQ(reported.hash, fixed.hash);
    EXPECT_EQ(reported.counters, fixed.counters);
    EXPECT_EQ(fixed.errors.steps, 0);
    EXPECT_EQ(reported.errors.steps, reported.counters.steps);
    EXPECT_GT(reported.errors.largest, 0.0);
}

TEST(ErrorControl, IsRefusedToMethodsWithoutAnEstimate) {
    try {
        (void)settled_tiny(with("rk4", "50ns", {"run.step_control=error"}));
        FAIL() << "accepted";
    } catch (const SceneError& error) {
        EXPECT_STREQ(error.what(),
                     "--set run.step_control=error: run.step_control: 'rk4' has no error estimate; only \"fixed\" steps are possible "
                     "(cvtflow list methods --all)");
    }
}

TEST(ErrorControl, EndsWhenNoStepIsShortEnough) {
    // RKC's estimate is a difference of states: rounding alone is more than that.
    const ControlledOutcome run =
        controlled_outcome(settled_tiny(with("rkc-s10", "1us", {"run.step_control=error", "run.tolerance=1e-12"})));
    EXPECT_EQ(run.fault.kind, FaultKind::step_size);
    EXPECT_THAT(run.fault.message(), testing::HasSubstr("to meet run.tolerance"));
}

/// The dense spectrum of the same state. Power iteration comes from below.
TEST(SpectralBound, IsTheExtentOfTheSpectrum) {
    const Simulation simulation(settled_tiny());
    const FrozenStart start = bench::frozen_start(simulation);
    SpectralBound bound(simulation.workspace().variator);
    const int evaluations = bound.estimate(start.time, start.state.data(), start.phases.data());
    EXPECT_LE(evaluations, 301);
    double real = 0.0, imaginary = 0.0;
    for (const auto& value : bench::spectrum(simulation.workspace().variator, start.time, start.state, start.phases)) {
        real = std::max(real, -value.real());
        imaginary = std::max(imaginary, std::abs(value.imag()));
    }
    RecordProperty("real", std::to_string(bound.real() / real));
    RecordProperty("imaginary", std::to_string(bound.imaginary() / imaginary));
    EXPECT_GT(bound.real(), 0.85 * real);
    EXPECT_LT(bound.real(), 1.1 * real);
    EXPECT_GT(bound.imaginary(), 0.8 * imaginary);
    EXPECT_LT(bound.imaginary(), 1.5 * imaginary);
    EXPECT_LE(bound.estimate(start.time, start.state.data(), start.phases.data()), 31) << "a warm start is cheap";
}

TEST(SpectralMethods, StayStableAtStepsFarBeyondThoseOfRk4) {
    bench::MeasureSettings settings;
    settings.duration = 24e-6;
    const bench::ErrorMeasure measure(settled_tiny(), settings, not_cancelled);
    for (const char* method : {"dumka3", "rkc", "rock2", "fitted"}) {
        const bench::Trajectory run = measure.run(with(method, "500ns"));
        ASSERT_FALSE(run.fault) << method << ": " << run.fault.message();
        EXPECT_LT(measure.errors(run).overall.tension, 1e-2) << method;
    }
}

TEST(SpectralMethods, TakeStepsByError) {
    for (const char* method : {"dumka3", "rkc", "rock2", "fitted"}) {
        const ControlledOutcome run =
            controlled_outcome(settled_tiny(with(method, "5us", {"run.step_control=error", "run.tolerance=0.1"})));
        EXPECT_FALSE(run.fault) << method << ": " << run.fault.message();
        EXPECT_LE(run.errors.largest, 0.1) << method;
    }
}

bool estimates_error(const std::string& method) {
    try {
        const Simulation simulation(settled_tiny(with(method, "20ns", {"run.step_control=report"})));
        return true;
    } catch (const SceneError&) {  // said with all other problems of a scene
        return false;
    }
}

/// Tables and programs, steps fixed or by error, on executors and segments: one hash per method.
void expect_bits_on_every_executor(const std::vector<std::string>& methods) {
    for (const std::string& method : methods) {
        if (!objection_to(method, settled_tiny({}).parameters).empty()) continue;  // rigid pins, which are one segment
        std::vector<std::string> settings =
            with(method, "20ns", {"run.until=100ns", "run.output_interval=100ns", "run.state_interval=100ns"});
        if (estimates_error(method)) settings.push_back("run.step_control=error");
        const Scene scene = settled_tiny(settings);
        const ControlledOutcome serial = controlled_outcome(scene);
        ASSERT_FALSE(serial.fault) << method << ": " << serial.fault.message();
        for (const engine::ExecutorRow& row : engine::executors()) {
            if (row.name.starts_with("omp")) continue;  // a contended OpenMP team takes minutes
            if (engine::test::thread_sanitizer && row.parallel && row.name != "barrier")
                continue;  // it sees into neither oneTBB nor OpenMP
            for (const Assembly assembly : {Assembly::fused, Assembly::staged}) {
                const Schedule schedule{std::string(row.name), {assembly}, 5, row.parallel ? 2 : 1};
                EXPECT_EQ(controlled_outcome(scene, schedule).hash, serial.hash) << method << ' ' << schedule.text();
            }
        }
    }
}

TEST(AMethod, GivesTheSameBitsOnEveryExecutor) { expect_bits_on_every_executor(cvtflow::test::sample(method_names(), 5, "executors")); }
TEST(NightlyEveryMethod, GivesTheSameBitsOnEveryExecutor) { expect_bits_on_every_executor(method_names()); }

}  // namespace
}  // namespace cvtflow::tasks
