/// Time goes forward by steps and back by states.

#include <gmock/gmock.h>

#include "host_fixture.hpp"

namespace cvtflow::host {
namespace {

TEST(HostTime, GoesBackByAStateAndNotByAStep) {
    Simulation simulation(tiny());
    simulation.advance_to(-2.9e-4);
    const State there = simulation.state();
    simulation.advance_to(-2.6e-4);
    const std::uint64_t hash = simulation.hash();
    EXPECT_EQ(code_of([&] { simulation.advance_to(-2.9e-4); }), ErrorCode::argument);
    EXPECT_THAT(error_of([&] { simulation.advance_to(-2.9e-4); }), testing::HasSubstr("to go back, set a state"));
    EXPECT_EQ(simulation.hash(), hash);
    simulation.set_state(there);
    simulation.advance_to(-2.6e-4);
    EXPECT_EQ(simulation.hash(), hash);
}

/// Outputs may be far apart: a request between the last two was obeyed by doing nothing.
TEST(HostTime, GoesBackByNoStepWhateverTheOutputs) {
    for (const std::string interval : {"10 us", "1 ms"}) {
        Simulation simulation(tiny({"run.output_interval=" + interval, "run.state_interval=" + interval}));
        simulation.advance_to(-1e-4);
        for (const double back : {1e-6, 5e-6, 1e-4}) {
            EXPECT_EQ(code_of([&] { simulation.advance_to(-1e-4 - back); }), ErrorCode::argument) << interval << ", " << back;
        }
        simulation.advance_to(-1e-4);                  // again
        simulation.advance_to(-1e-4 * (1.0 - 1e-15));  // rounded otherwise
        EXPECT_NEAR(simulation.time(), -1e-4, 1e-12);
        for (int k = 0; k < 30; ++k) simulation.step();
        EXPECT_EQ(code_of([&] { simulation.advance_to(-1e-4); }), ErrorCode::argument) << interval;  // steps have been taken
        simulation.advance_to(simulation.time());
    }
}

/// The last step may have ended behind the time asked for, and so behind the next one.
TEST(HostTime, MayBeAskedForInPartsOfAStep) {
    Simulation simulation(tiny({"run.step=1 us"}));
    for (int k = -3000; k < -2990; ++k) simulation.advance_to(1e-7 * k);
    EXPECT_EQ(simulation.counters().steps, 1);
}

TEST(HostTime, KnowsTheLargestStableStepOfProgramsToo) {
    Simulation leapfrog(tiny({"run.method=leapfrog-chebyshev"})), dumka3(tiny({"run.method=dumka3"}));
    for (Simulation* simulation : {&leapfrog, &dumka3}) simulation->advance_to(-2.9e-4);
    EXPECT_GT(leapfrog.largest_stable_step(), 1e-6);
    EXPECT_LT(leapfrog.largest_stable_step(), 2.0 / (2.0 * 3.14159 * 1e5));
    EXPECT_TRUE(std::isinf(dumka3.largest_stable_step())) << "it has a polynomial for every step";
    EXPECT_EQ(leapfrog.method(), "leapfrog-chebyshev");
    EXPECT_EQ(Simulation(tiny({"run.method=auto"})).method(), "leapfrog-sweep");
}

}  // namespace
}  // namespace cvtflow::host
