#pragma once
/// Runs as tests of a feature need them: to a goal, settled and at a time, continued from a state between; and what they watch.

#include <gtest/gtest.h>

#include <functional>
#include <utility>

#include "tasks/run/simulation.hpp"
#include "tests/tasks/tiny_fixture.hpp"

namespace cvtflow::tasks {

/// Advances a simulation without an observer, and without an end by others.
inline Fault go(Simulation& simulation, const Goal& goal) {
    SilentObserver silent;
    return simulation.advance(goal, silent, engine::Cancellation());
}

/// Settles a simulation that has not settled, and advances it to `until` [s]. Expects no fault. @param observer  after settling
inline void settle_and_go(Simulation& simulation, double until, RunObserver& observer) {
    Fault fault;
    if (simulation.needs_settling()) fault = go(simulation, {.until = 0.0});
    if (!fault) fault = simulation.advance({.until = until}, observer, engine::Cancellation());
    EXPECT_FALSE(fault) << fault.message();
}
inline void settle_and_go(Simulation& simulation, double until) {
    SilentObserver silent;
    settle_and_go(simulation, until, silent);
}

/// Hash of a run of a scene that settles first. @param until [s]
inline std::uint64_t hash_at(const Scene& scene, double until) {
    Simulation simulation(scene);
    settle_and_go(simulation, until);
    return simulation.hash();
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

/// Calls a function at every output, and one at every transition.
class Outputs final : public RunObserver {
public:
    using Output = std::function<void(double time, const Workspace& workspace, const Counters& counters)>;
    using Transition = std::function<void(const TransitionRecord& record)>;

    explicit Outputs(Output output, Transition transition = {}) : output_(std::move(output)), transition_(std::move(transition)) {}
    void output(double time, const Workspace& workspace, const Counters& counters) override {
        if (output_) output_(time, workspace, counters);
    }
    void transition(const TransitionRecord& record) override {
        if (transition_) transition_(record);
    }

private:
    Output output_;
    Transition transition_;
};

/// Calls a function with an observation of every output.
inline Outputs observed_outputs(const Simulation& simulation, std::function<void(double time, const model::Observation& now)> function) {
    auto observer = std::make_shared<model::Observer>(simulation.workspace().variator);
    return Outputs([observer, function = std::move(function)](double time, const Workspace& workspace, const Counters&) {
        function(time, workspace.observed_by(*observer, time));
    });
}

inline const double* pulleys_of(const Simulation& of) { return of.workspace().state() + of.workspace().layout().pulley_begin(); }

}  // namespace cvtflow::tasks
