/// The methods that solve with the whole state, on the tiny scene.

#include <gmock/gmock.h>

#include <cmath>

#include "bench/method/implicit/catalogue.hpp"
#include "bench/study/error_measure.hpp"
#include "jacobian_fixture.hpp"
#include "tests/claims/method_trial_fixture.hpp"
#include "tests/engine/allocation_fixture.hpp"
#include "tests/engine/graph/graph_fixture.hpp"
#include "tests/tasks/run/settled_run_fixture.hpp"

namespace cvtflow::bench {
namespace {

using testing::HasSubstr;

/// The tiny scene from its geometric start, settled by the method itself for so short that tips come and go.
Scene implicit_scene(const std::string& method, const std::vector<std::string>& extra = {}) {
    Scene scene = read_scene(CVTFLOW_SOURCE_DIR "/scenes/tiny.toml");
    std::vector<std::string> values{"start.settling_time=8us", "start.ramp_time=4us", "run.step=1us", "run.output_interval=4us",
                                    "run.method=" + method};
    values.insert(values.end(), extra.begin(), extra.end());
    set_values(scene, values);
    return scene;
}

TEST(ImplicitMethods, AllWaysToNewtonsMatrixLeadToTheSameSolution) {
    const Settled settled;
    const auto end = [&](const char* method) {
        return bench::try_method(settled.parameters(), settled.start(), method, 500e-9, 2e-6).state;
    };
    const std::vector<double> exact = end("trapezoidal-analytic");
    for (const NewtonVariant& variant : newton_variants()) {
        if (!variant.options.backtracking) continue;
        // Residuals of 1e-7 m/s, in velocities of 3 m/s.
        EXPECT_LT(relative_error(end(variant.name), exact), 1e-7) << variant.name;
    }
}

TEST(ImplicitMethods, NewtonConvergesWithEveryMatrix) {
    const Settled settled;
    for (const NewtonVariant& variant : newton_variants()) {
        if (!variant.options.backtracking) continue;
        const bench::TrialEnd end = bench::try_method(settled.parameters(), settled.start(), variant.name, 1e-6, 20e-6);
        ASSERT_FALSE(end.fault) << variant.name;
        EXPECT_EQ(end.newton->unconverged, 0) << variant.name;
        EXPECT_GE(end.newton->steps, 20);
        EXPECT_LE(static_cast<double>(end.newton->iterations), 12.0 * static_cast<double>(end.newton->steps))
            << variant.name << ": " << end.report;
    }
}

TEST(ImplicitMethods, AreStableWhereExplicitOnesAreNot) {
    const Settled settled;
    for (const char* method : {"rk4", "dopri54"})
        EXPECT_TRUE(bench::try_method(settled.parameters(), settled.start(), method, 10e-6, 200e-6).fault) << method;
    EXPECT_FALSE(bench::try_method(settled.parameters(), settled.start(), "trapezoidal-analytic", 10e-6, 200e-6).fault);
}

/// Here a tip is due that has kept its phase long enough by the end of the whole step, but not by the end of the one that is taken again:
/// cut for it without changing it, and cut again, steps of 1e-14 s continued for ever.
TEST(ImplicitMethods, EveryCutChangesATipAlsoWhereTheStepIsTakenAgain) {
    for (const char* method : {"trapezoidal-analytic", "trapezoidal-full", "trapezoidal-frozen", "trapezoidal-schubert"}) {
        SCOPED_TRACE(method);
        Simulation simulation(implicit_scene(method, {"detail.stick_slip=true", "start.settling_time=50us", "start.ramp_time=50us",
                                                      "run.step=1.4285714285714286us", "run.output_interval=10us"}));
        EXPECT_FALSE(simulation.integrator().method().bytes().has_value()) << "not counted, and the summary states it";
        long transitions = 0;
        Outputs seen({}, [&](const TransitionRecord&) { ++transitions; });
        const engine::Cancellation never;
        ASSERT_FALSE(simulation.advance({.until = 0.0, .steps = 3000}, seen, never));
        const Counters& c = simulation.counters();
        EXPECT_EQ(c.steps - c.truncated, 35);
        EXPECT_GT(c.truncated, 10);
        EXPECT_LE(c.truncated, c.detected);
        EXPECT_EQ(c.detected, transitions);
    }
}

TEST(EveryImplicitMethod, DeclaresAGraphWithoutRaces) {
    for (const MethodProgram& program : implicit_programs()) {
        const Scene scene = implicit_scene(program.name);
        for (const int segments : {1, 5, 24}) {
            for (const Assembly assembly : {Assembly::fused, Assembly::staged}) {
                const Simulation simulation(scene, {"serial", {assembly}, segments, 1});
                EXPECT_TRUE(engine::race_check(simulation.integrator().runner().graph()).empty()) << program.name << ", " << segments;
            }
        }
    }
}

TEST(EveryImplicitMethod, AllocatesNothingInTheStepLoop) {
    if (engine::test::allocation_count() < 0) GTEST_SKIP() << "a sanitizer owns malloc";
    for (const MethodProgram& program : implicit_programs()) {
        Simulation simulation(implicit_scene(program.name), Schedule{});
        long between = 0, before = -1;
        Outputs counter([&](double, const Workspace&, const Counters&) {
            if (before >= 0) between += engine::test::allocation_count() - before;
            before = engine::test::allocation_count();
        });
        const engine::Cancellation never;
        EXPECT_FALSE(simulation.advance({.until = 0.0}, counter, never)) << program.name;
        EXPECT_EQ(between, 0) << program.name;
    }
}

TEST(ImplicitMethods, RunAFreeRingAndRigidPulleysToo) {
    for (const char* method : {"trapezoidal-analytic", "trapezoidal-schubert", "ros34pw2"}) {
        Scene ring = read_scene(CVTFLOW_SOURCE_DIR "/scenes/free_ring.toml");
        set_values(ring, std::vector<std::string>{std::string("run.method=") + method, "run.step=1us", "run.output_interval=4us"});
        for (const Scene& scene : {ring, implicit_scene(method, {"detail.pulleys=rigid"})}) {
            Simulation simulation(scene, Schedule{});
            SilentObserver silent;
            const engine::Cancellation never;
            EXPECT_FALSE(simulation.advance({.until = 8e-6}, silent, never)) << method;
        }
    }
}

TEST(NewtonStatistics, SayWhatHappened) {
    EXPECT_EQ(
        text(NewtonStatistics{.steps = 4, .iterations = 10, .most = 3, .jacobians = 5, .factorisations = 6, .solves = 10, .backtracks = 2}),
        "2.50 iterations per step (max 3), 5 Jacobians, 6 factorisations, 2 halvings");
    EXPECT_EQ(text(NewtonStatistics{.steps = 4,
                                    .iterations = 10,
                                    .most = 3,
                                    .jacobians = 5,
                                    .factorisations = 6,
                                    .solves = 10,
                                    .backtracks = 2,
                                    .refreshed = 1,
                                    .unconverged = 2,
                                    .worst = 0.0123}),
              "2.50 iterations per step (max 3), 5 Jacobians, 6 factorisations, 2 halvings; 1 of 4 steps required a new Jacobian; 2 "
              "of 4 steps did not converge and used the best iterate (residual up to 0.012 m/s)");
}

}  // namespace
}  // namespace cvtflow::bench
