/// A host's cycle allocates nothing once each of its calls has been made.

#include <cstdio>
#include <functional>
#include <map>

#include "../engine/allocation_fixture.hpp"
#include "host_fixture.hpp"

namespace cvtflow::host {
namespace {

/// Calls of a host's cycle.
struct Call {
    const char* name;
    std::function<void(Simulation&)> make;
};

const std::vector<Call>& calls() {
    static const std::size_t ratio = 0;
    static const std::vector<Call> all{
        {"set_input", [](Simulation& s) { s.set_input(Input::clamping_driving, s.input(Input::clamping_driving) + 1.0); }},
        {"input", [](Simulation& s) { static_cast<void>(s.input(Input::load_torque)); }},
        {"advance_to", [](Simulation& s) { s.advance_to(s.time() + 1e-5); }},
        {"step", [](Simulation& s) { s.step(); }},
        {"channel(name)", [](Simulation& s) { static_cast<void>(s.channel("ratio")); }},
        {"channel(longest name)", [](Simulation& s) { static_cast<void>(s.channel("shaft_1/chain_torque")); }},
        {"channel(index), all",
         [](Simulation& s) {
             for (std::size_t index = ratio; index < s.channels(); ++index) static_cast<void>(s.channel(index));
         }},
        {"find_channel", [](Simulation& s) { static_cast<void>(s.find_channel("slip")); }},
        {"channel_info", [](Simulation& s) { static_cast<void>(s.channel_info(0)); }},
        {"counters, energy, hash",
         [](Simulation& s) { static_cast<void>(s.counters()), static_cast<void>(s.energy()), static_cast<void>(s.hash()); }},
        {"unknowns, time, step_length", [](Simulation& s) { static_cast<void>(s.unknowns()), static_cast<void>(s.step_length()); }},
    };
    return all;
}

/// A thousand cycles, of which the first ten may allocate: every call once, at outputs too.
void expect_none(const std::string& what, const Scene& scene, Threads threads) {
    Simulation simulation(scene, threads);
    std::map<std::string, long> counts;
    for (int cycle = 0; cycle < 200; ++cycle) {
        for (const Call& call : calls()) {
            const long before = engine::test::allocation_count();
            call.make(simulation);
            if (cycle >= 100) counts[call.name] += engine::test::allocation_count() - before;
        }
    }
    for (const Call& call : calls()) {
        std::printf("%-28s %-30s %6.2f allocations a call\n", what.c_str(), call.name, static_cast<double>(counts[call.name]) / 100.0);
        EXPECT_EQ(counts[call.name], 0) << what << ": " << call.name;
    }
}

TEST(Allocations, AreNotMadeInACycleOfAHost) {
    if (engine::test::allocation_count() < 0) GTEST_SKIP() << "a sanitizer owns malloc";
    for (const char* level : {"rigid", "medium", "fine", "full"}) {
        const Scene scene = Scene::ready("tiny")
                                .with({"start.settling_time=0.3 ms", "start.ramp_time=0.3 ms"})
                                .with({std::string("detail.level=") + level});
        expect_none(level, scene, Threads::caller());
    }
    expect_none("fine, rk4", tiny({"run.method=rk4"}), Threads::caller());
    expect_none("medium, two threads", Scene::ready("tiny").with({"start.settling_time=0.3 ms", "start.ramp_time=0.3 ms"}),
                Threads::own(2));
}

}  // namespace
}  // namespace cvtflow::host
