/// Rigid pins in a host: one thread, the same bits.

#include "host_fixture.hpp"

namespace cvtflow::host {
namespace {

TEST(HostRigidPins, GiveTheSameBitsForEveryWayOfRunningAndContinued) {
    const Scene scene = tiny({"detail.pins=rigid", "detail.order=2", "run.method=leapfrog-rigid", "run.step=1 us"});
    Simulation whole(scene), pieces(scene, Threads::private_arena(2)), restored(scene);
    whole.advance_to(2e-5);
    for (int k = -30; k <= 2; ++k) pieces.advance_to(1e-5 * k);
    EXPECT_EQ(pieces.hash(), whole.hash());
    EXPECT_NE(whole.channel("tight_tension")[0], 0.0);
    restored.set_state(whole.state());
    whole.advance_to(5e-5);
    restored.advance_to(5e-5);
    EXPECT_EQ(restored.hash(), whole.hash());
}

TEST(HostRigidPins, ReportEveryTransitionOfTheirTips) {
    Simulation simulation(tiny({"detail.pins=rigid", "detail.order=2", "run.method=leapfrog-rigid", "run.step=1 us"}));
    long transitions = 0;
    simulation.advance_to(0.0);
    simulation.on_transition([&](Simulation& at, const Transition& t) {
        EXPECT_LE(t.time, at.time());
        EXPECT_EQ(t.from + t.to, 1) << "free or touching";
        ++transitions;
    });
    simulation.advance_to(1e-3);
    EXPECT_EQ(transitions, simulation.counters().transitions);
    EXPECT_GT(transitions, 0);
}

}  // namespace
}  // namespace cvtflow::host
