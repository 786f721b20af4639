/// Steps by error, reused slopes, methods that follow the spectrum: on the smallest scene.

#include <gmock/gmock.h>

#include <string>
#include <tuple>

#include "engine/executor/catalogue.hpp"
#include "tasks/method/method.hpp"
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
                                                 {"fitted-l20-w1-s9", 10, 1}}) {
        if (test::known_methods({method}).empty()) continue;
        const ControlledOutcome run = controlled_outcome(settled_tiny(with(method, "50ns")));
        ASSERT_FALSE(run.fault) << method;
        EXPECT_EQ(Method(method).evaluations_per_step(), stages - reused) << method;
        EXPECT_GE(run.counters.evaluations, (stages - reused) * run.counters.steps + reused + 2 * run.counters.truncated * reused)
            << method;
        EXPECT_LE(run.counters.evaluations, (stages - reused) * run.counters.steps + reused + 2 * run.counters.truncated + 4) << method;
    }
}

TEST(ErrorControl, EndsStepsAtOutputsAndStaysBelowTheTolerance) {
    const ControlledOutcome run =
        controlled_outcome(settled_tiny(with("dopri54", "10us", {"run.step_control=error", "run.tolerance=1e-3"})));
    ASSERT_FALSE(run.fault) << run.fault.message();
    EXPECT_GT(run.counters.rejected, 0) << "the first step is far too long; largest error " << run.errors.largest << " in "
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
    EXPECT_EQ(message_of([] { return settled_tiny(with("rk4", "50ns", {"run.step_control=error"})); }),
              "--set run.step_control=error: run.step_control: 'rk4' has no error estimate; only \"fixed\" steps are possible "
              "(cvtflow list methods --all)");
}

TEST(ErrorControl, EndsWhenNoStepIsShortEnough) {
    // Heun's estimate is of second order: a ten-millionth of this step leaves more than that.
    const ControlledOutcome run = controlled_outcome(settled_tiny(
        with("heun", "1ms",
             {"run.step_control=error", "run.tolerance=1e-12", "run.until=1ms", "run.output_interval=1ms", "run.state_interval=1ms"})));
    EXPECT_EQ(run.fault.kind, FaultKind::step_size);
    EXPECT_THAT(run.fault.message(), testing::HasSubstr("to meet run.tolerance"));
}

TEST(SpectralMethods, TakeStepsByError) {
    for (const std::string& method : test::known_methods({"dumka3", "rkc", "fitted"})) {
        const ControlledOutcome run =
            controlled_outcome(settled_tiny(with(method, "5us", {"run.step_control=error", "run.tolerance=0.1"})));
        EXPECT_FALSE(run.fault) << method << ": " << run.fault.message();
        EXPECT_LE(run.errors.largest, 0.1) << method;
    }
}

/// Tables and programs, steps fixed or by error, on executors and segments: one hash per method.
void expect_bits_on_every_executor(const std::vector<std::string>& methods) {
    for (const std::string& method : methods) {
        if (!objection_to(method, settled_tiny({}).parameters).empty()) continue;  // rigid pins, which are one segment
        std::vector<std::string> settings =
            with(method, "20ns", {"run.until=100ns", "run.output_interval=100ns", "run.state_interval=100ns"});
        if (Method(method).estimates_error()) settings.push_back("run.step_control=error");
        const Scene scene = settled_tiny(settings);
        const ControlledOutcome serial = controlled_outcome(scene);
        ASSERT_FALSE(serial.fault) << method << ": " << serial.fault.message();
        for (const engine::ExecutorRow& row : engine::executors()) {
            if (row.name.starts_with("omp")) continue;  // a contended OpenMP team takes minutes
            if (engine::test::thread_sanitizer && row.parallel && row.name != "barrier")
                continue;  // it sees into neither oneTBB nor OpenMP
            for (const Assembly assembly : test::assemblies()) {
                const Schedule schedule{std::string(row.name), {assembly}, 5, row.parallel ? 2 : 1};
                EXPECT_EQ(controlled_outcome(scene, schedule).hash, serial.hash) << method << ' ' << schedule.text();
            }
        }
    }
}

TEST(AMethod, GivesTheSameBitsOnEveryExecutor) {
    expect_bits_on_every_executor(cvtflow::test::sample(method_names(), cvtflow::test::depth(2, 5), "executors"));
}
TEST(NightlyEveryMethod, GivesTheSameBitsOnEveryExecutor) { expect_bits_on_every_executor(method_names()); }

}  // namespace
}  // namespace cvtflow::tasks
