#pragma once
/// Runs as tests of a feature need them: settled and at a time, and continued from a state between.

#include <gtest/gtest.h>

#include "tasks/run/simulation.hpp"

namespace cvtflow::tasks {

/// Settles a simulation that has not settled, and advances it to `until` [s]. Expects no fault. @param observer  after settling
inline void settle_and_go(Simulation& simulation, double until, RunObserver& observer) {
    SilentObserver silent;
    const engine::Cancellation never;
    Fault fault;
    if (simulation.needs_settling()) fault = simulation.advance({.until = 0.0}, silent, never);
    if (!fault) fault = simulation.advance({.until = until}, observer, never);
    EXPECT_FALSE(fault) << fault.message();
}
inline void settle_and_go(Simulation& simulation, double until) {
    SilentObserver silent;
    settle_and_go(simulation, until, silent);
}

/// A scene at a time, without interruption, and continued by another simulation from the first one's integration state at `middle`: expects
/// the same states, energies, temperatures and memories, bit for bit. @param middle, until [s]   @return the state in the middle
inline IntegrationState expect_continued(const Scene& scene, double middle, double until) {
    Simulation whole(scene), other(scene);
    settle_and_go(whole, middle);
    IntegrationState state = whole.integration_state();
    settle_and_go(whole, until);
    other.restore(state);
    settle_and_go(other, until);
    EXPECT_EQ(other.hash(), whole.hash());
    EXPECT_TRUE(other.integration_state() == whole.integration_state());
    return state;
}

}  // namespace cvtflow::tasks
