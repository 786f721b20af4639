/// A host's cycle allocates nothing once each of its calls has been made.

#include <cstdio>
#include <functional>
#include <map>

#include "../engine/allocation_fixture.hpp"
#include "host_fixture.hpp"

namespace cvtflow::host {
namespace {

constexpr int warm_cycles = 100, counted_cycles = 100;

/// Calls of a host's cycle.
struct Call {
    const char* name;
    std::function<void(Simulation&)> make;
    bool steps = false;
};

const std::vector<Call>& calls() {
    static const std::string longest = "shaft_1/chain_torque";
    static const std::vector<Call> all{
        {"set_input, input", [](Simulation& s) { s.set_input(Input::clamping_driving, s.input(Input::clamping_driving) + 1.0); }},
        {"advance_to", [](Simulation& s) { s.advance_to(s.time() + 1e-5); }, true},
        {"step", [](Simulation& s) { s.step(); }, true},
        {"channel(name)", [](Simulation& s) { static_cast<void>(s.channel("ratio")), static_cast<void>(s.channel(longest)); }},
        {"channel(index), all",
         [](Simulation& s) {
             for (std::size_t index = 0; index < s.channels(); ++index) static_cast<void>(s.channel(index));
         }},
        {"channel_info", [](Simulation& s) { static_cast<void>(s.channel_info(0)); }},
        {"counters, energy, hash",
         [](Simulation& s) { static_cast<void>(s.counters()), static_cast<void>(s.energy()), static_cast<void>(s.hash()); }},
        {"unknowns, time, step_length", [](Simulation& s) { static_cast<void>(s.unknowns()), static_cast<void>(s.step_length()); }},
    };
    return all;
}

/// Cycles of all calls, of which the first may allocate: outputs, transitions and estimates of the step all have been met by then.
/// @param own_threads  steps wake them through oneTBB, which allocates: counted alone
void expect_none(const std::string& what, Simulation simulation, bool own_threads = false) {
    std::map<std::string, long> counts;
    for (int cycle = 0; cycle < warm_cycles + counted_cycles; ++cycle) {
        for (const Call& call : calls()) {
            const long before = engine::test::allocation_count();
            call.make(simulation);
            if (cycle >= warm_cycles) counts[call.name] += engine::test::allocation_count() - before;
        }
    }
    for (const Call& call : calls()) {
        std::printf("%-28s %-30s %6.2f allocations\n", what.c_str(), call.name, static_cast<double>(counts[call.name]) / counted_cycles);
        if (own_threads && call.steps) continue;
        EXPECT_EQ(counts[call.name], 0) << what << ": " << call.name;
    }
}

Scene at_level(const std::string& level, const std::string& method = "auto") {
    return Scene::ready("tiny")
        .with({"start.settling_time=0.3 ms", "start.ramp_time=0.3 ms"})
        .with({"run.method=" + method})
        .with_detail(level);
}

class Allocations : public testing::Test {
protected:
    void SetUp() override {
        if (engine::test::allocation_count() < 0) GTEST_SKIP() << "a sanitizer owns malloc";
    }
};

TEST_F(Allocations, AreNotMadeInACycleOfAHost) {
    for (const char* level : {"rigid", "fine", "full"}) expect_none(level, Simulation(at_level(level), Threads::caller()));
    expect_none("fine, rk4", Simulation(at_level("fine", "rk4"), Threads::caller()));
    expect_none("fine, two threads", Simulation(at_level("fine"), Threads::private_arena(2)), true);
}

TEST_F(Allocations, AreNotMadeForCallbacks) {
    Simulation simulation(at_level("fine"), Threads::caller());
    long outputs = 0, transitions = 0, more = 0;
    long* const counts[] = {&outputs, &transitions, &more};  // a capture too large for what std::function holds in itself
    simulation.on_output(2e-5, [=](Simulation&) { *counts[0] += 1 + 0 * *counts[2]; });
    simulation.on_transition([=](Simulation&, const Transition&) { *counts[1] += 1 + 0 * *counts[2]; });
    expect_none("fine, callbacks", std::move(simulation));
    EXPECT_GT(outputs, 50);
    EXPECT_GT(transitions, 50);
}

}  // namespace
}  // namespace cvtflow::host
