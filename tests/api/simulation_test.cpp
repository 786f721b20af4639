/// One simulation in a host: steps, states, inputs, channels, callbacks, errors, time, rigid pins.

#include <gmock/gmock.h>
#include <malloc.h>

#include <algorithm>
#include <cmath>

#include "host_fixture.hpp"

namespace cvtflow::host {
namespace {

/// Rigid pins run on one thread, whatever the host asks for.
Scene rigid() { return tiny({"detail.pins=rigid", "run.method=leapfrog-rigid", "run.step=1 us"}); }

TEST(HostSimulation, GivesTheSameBitsInOneCallAndInAThousand) {
    const Scene scene = tiny();
    Simulation whole(scene), pieces(scene), steps(scene);
    whole.advance_to(2e-5);
    for (int k = -300; k <= 20; ++k) pieces.advance_to(1e-6 * k);
    while (steps.time() < 2e-5 - 1e-12) steps.step();
    EXPECT_NE(whole.counters().steps, 0);
    EXPECT_EQ(pieces.hash(), whole.hash());
    EXPECT_EQ(steps.hash(), whole.hash());
    EXPECT_EQ(pieces.time(), whole.time());
    EXPECT_EQ(steps.counters(), whole.counters());
    for (Simulation* simulation : {&whole, &pieces}) simulation->advance_to(2.73e-5);  // between two outputs
    while (steps.time() < whole.time()) steps.step();
    for (Simulation* other : {&pieces, &steps}) {
        for (const char* mean : {"shaft_1/chain_torque", "shaft_2/chain_torque", "dissipated/total"})
            EXPECT_EQ(other->channel(mean)[0], whole.channel(mean)[0]) << mean;
    }
}

TEST(HostSimulation, GivesTheSameBitsForEveryWayOfRunning) {
    for (const auto& [scene, counts] : {std::pair(tiny(), std::vector{0, 3, 24}), std::pair(rigid(), std::vector{0, 1})}) {
        const std::uint64_t expected = serial_hash(scene, 1e-5);
        for (const int segments : counts) {
            for (const Threads threads :
                 {Threads::caller(), Threads::private_arena(2), Threads::private_arena(3), Threads::current_arena(2)}) {
                Simulation other(scene, threads, segments);
                other.advance_to(-1e-4);
                other.advance_to(1e-5);
                EXPECT_EQ(other.hash(), expected) << other.method() << static_cast<int>(threads.way()) << ", " << segments << " segments";
            }
        }
    }
}

TEST(HostSimulation, ContinuesBitwiseFromAStateThatWasPutBack) {
    for (const Scene& scene : {tiny(), rigid()}) {
        for (const double saved_at : {-2.5e-4, -1e-7, 0.0, 3.3e-6}) {
            Simulation simulation(scene);
            simulation.advance_to(saved_at);
            const State saved = simulation.state();
            simulation.advance_to(1e-5);
            const std::uint64_t expected = simulation.hash();
            const Counters counters = simulation.counters();
            simulation.set_state(saved);  // back in time
            EXPECT_EQ(simulation.state(), saved);
            simulation.advance_to(1e-5);
            EXPECT_EQ(simulation.hash(), expected) << saved_at;
            Simulation other(scene, Threads::private_arena(2));  // and in another simulation, run another way
            other.set_state(State::from_bytes(saved.bytes()));
            other.advance_to(1e-5);
            EXPECT_EQ(other.hash(), expected) << saved_at;
            EXPECT_EQ(other.counters(), counters);
        }
    }
}

TEST(HostSimulation, CopiesGoTheirOwnWay) {
    Simulation simulation(tiny());
    simulation.advance_to(-1e-4);
    simulation.set_input(Input::load_torque, 5.0);
    Simulation copy = simulation.copy();
    EXPECT_EQ(copy.hash(), simulation.hash());
    EXPECT_EQ(copy.input(Input::load_torque), 5.0);
    copy.advance_to(1e-6);
    EXPECT_NE(copy.hash(), simulation.hash());
    simulation.advance_to(1e-6);
    EXPECT_EQ(copy.hash(), simulation.hash());
}

TEST(HostSimulation, RefusesStatesThatAreDamagedOrOfAnotherScene) {
    Simulation simulation(tiny());
    const State good = simulation.state();
    std::vector<std::byte> bytes(good.bytes().begin(), good.bytes().end());
    bytes[bytes.size() / 2] ^= std::byte{1};
    EXPECT_EQ(error_of([&] { static_cast<void>(State::from_bytes(bytes)); }), "saved state: a damaged state: its checksum differs");
    EXPECT_EQ(error_of([&] { static_cast<void>(State::from_bytes(std::span(bytes).first(3))); }), "saved state: not a state");
    EXPECT_EQ(error_of([&] { simulation.set_state(State()); }), "saved state: not a state");
    Simulation stiffer(tiny({"tip.hertz=3e10"}));
    EXPECT_EQ(error_of([&] { stiffer.set_state(good); }), "saved state: it belongs to another scene, method or step");
    Simulation elsewhere(tiny({"run.threads=3", "run.until=7 ms", "scene.name=other"}));
    EXPECT_NO_THROW(elsewhere.set_state(good));  // what does not matter to the course does not count
}

TEST(HostSimulation, TakesInputsFromTheHost) {
    const Scene scene = tiny();
    Simulation simulation(scene);
    simulation.advance_to(0.0);
    EXPECT_EQ(simulation.input(Input::clamping_driving), 7700.0);
    simulation.set_input(Input::clamping_driving, 8000.0);
    simulation.set_input(Input::drive_speed, 250.0);
    EXPECT_EQ(simulation.input(Input::clamping_driving), 8000.0);
    EXPECT_EQ(simulation.channel("shaft_1/clamping")[0], 8000.0);
    // The governor's torque is 2 J w (speed target - speed) + J w² (angle target - angle): the angle does not jump with the speed target.
    Simulation same(scene);
    same.advance_to(0.0);
    const double polar = 2e-2 + 2 * 8e-3, frequency = 2.0 * M_PI * 200.0;
    const double expected = same.channel("shaft_1/torque")[0] + 2.0 * polar * frequency * (250.0 - 209.43951023931953);
    EXPECT_NEAR(simulation.channel("shaft_1/torque")[0], expected, 1e-9 * std::abs(expected));
    simulation.set_input(Input::drive_speed, 250.0);  // once more changes nothing
    EXPECT_NEAR(simulation.channel("shaft_1/torque")[0], expected, 1e-9 * std::abs(expected));
}

TEST(HostSimulation, AnInputHeldAtTheTablesValueChangesNothing) {
    Simulation simulation(tiny()), held(tiny());
    for (const Input input : {Input::clamping_driving, Input::clamping_driven, Input::load_torque})
        held.set_input(input, held.input(input));
    simulation.advance_to(1e-6);
    held.advance_to(1e-6);
    EXPECT_EQ(held.hash(), simulation.hash());
}

TEST(HostSimulation, ShowsChannelsByNameAndNumber) {
    Simulation simulation(tiny());
    EXPECT_GT(simulation.channels(), 40u);
    const std::size_t tension = simulation.find_channel("links/tension");
    EXPECT_EQ(simulation.channel_info(tension).unit, "N");
    EXPECT_EQ(simulation.channel_info(tension).width, 24u);
    EXPECT_EQ(simulation.channel(tension).size(), 24u);
    for (std::size_t k = 0; k < simulation.channels(); ++k)
        EXPECT_EQ(simulation.find_channel(std::string(simulation.channel_info(k).name)), k);
    simulation.advance_to(-1e-4);
    EXPECT_GT(simulation.channel("tips/touching")[0], 0.0);
    EXPECT_EQ(simulation.channel("run/steps")[0], static_cast<double>(simulation.counters().steps));
    EXPECT_EQ(error_of([&] { static_cast<void>(simulation.channel("ratoi")); }), "channel: there is no 'ratoi' (did you mean \"ratio\"?)");
    EXPECT_EQ(code_of([&] { static_cast<void>(simulation.channel(1000)); }), ErrorCode::argument);
}

/// The shafts alone are observed where that is enough; what needs the chain comes on top.
TEST(HostSimulation, ReadsTheSameInWhateverOrder) {
    const char* const names[] = {"shaft_1/speed", "shaft_2/chain_torque", "tight_tension", "power/drive", "slip"};
    Simulation simulation(tiny()), other(tiny());
    for (const double time : {0.0, 1e-5, 2e-5}) {
        for (Simulation* each : {&simulation, &other}) each->advance_to(time);
        std::vector<double> forwards, backwards;
        for (const char* name : names) forwards.push_back(simulation.channel(name)[0]);
        for (auto name = std::rbegin(names); name != std::rend(names); ++name) backwards.insert(backwards.begin(), other.channel(*name)[0]);
        EXPECT_EQ(forwards, backwards);
        EXPECT_NE(forwards[2], 0.0);
    }
}

TEST(HostSimulation, RightHandSideIsTheSlopeOfTheMotion) {
    Simulation simulation(tiny({"detail.friction=smoothed", "run.step=10 ns", "run.output_interval=10 ns", "run.state_interval=10 ns"}));
    simulation.advance_to(-2.9e-4);
    const std::size_t size = simulation.size();
    std::vector<double> before(simulation.unknowns().begin(), simulation.unknowns().end()), slope(size), again(size);
    const double t = simulation.time();
    simulation.rhs(t, before, slope);
    simulation.rhs(t, before, again);
    EXPECT_EQ(slope, again);
    simulation.step();
    const double h = simulation.time() - t;
    const std::vector<double> after(simulation.unknowns().begin(), simulation.unknowns().end());
    simulation.rhs(simulation.time(), after, again);
    double error = 0.0, change = 0.0;
    for (std::size_t k = 0; k < size; ++k) {
        const double moved = after[k] - before[k], left = moved - 0.5 * h * (slope[k] + again[k]);
        error += left * left;
        change += moved * moved;
    }
    EXPECT_LT(std::sqrt(error / change), 0.04);  // h λ is up to 0.6: the trapezoidal rule errs by (h λ)²/12
    EXPECT_EQ(code_of([&] { simulation.rhs(t, std::span(before).first(3), slope); }), ErrorCode::argument);
}

TEST(HostSimulation, CallsBackAfterTheStepsThatReachAnInterval) {
    Simulation simulation(tiny());
    std::vector<double> times;
    long transitions = 0;
    double last = -1.0;
    simulation.on_output(5e-5, [&](Simulation& at) { times.push_back(at.time()); });
    simulation.on_transition([&](Simulation&, const Transition& t) {
        EXPECT_GE(t.time, last);
        EXPECT_NE(t.from, t.to);
        last = t.time;
        ++transitions;
    });
    simulation.advance_to(-1e-9);
    ASSERT_EQ(times.size(), 6u);
    for (std::size_t k = 0; k < times.size(); ++k) EXPECT_NEAR(times[k], -2.5e-4 + 5e-5 * static_cast<double>(k), 1e-12);
    EXPECT_GT(transitions, 20);
    EXPECT_EQ(simulation.counters(), Counters()) << "after settling they begin anew";
    Simulation silent(tiny());
    silent.advance_to(-1e-9);
    EXPECT_EQ(simulation.hash(), silent.hash());
}

TEST(HostSimulation, CallbacksMayDoEverythingButStepTheirOwnSimulation) {
    const Scene scene = tiny();
    Simulation simulation(scene, Threads::private_arena(2)), other(scene);
    int calls = 0;
    simulation.on_output(1e-4, [&](Simulation& self) {
        ++calls;
        EXPECT_EQ(error_of([&] { self.advance_to(1.0); }), "a simulation cannot be stepped or replaced from its own callback");
        EXPECT_EQ(code_of([&] { self.step(); }), ErrorCode::busy);
        EXPECT_EQ(code_of([&] { self.set_state(self.state()); }), ErrorCode::busy);
        EXPECT_GT(self.channel("shaft_1/clamping")[0], 0.0);
        self.set_input(Input::clamping_driving, 7700.0 + calls);
        other.advance_to(self.time());
        Simulation twin = self.copy();
        twin.advance_to(self.time() + 1e-6);
    });
    simulation.advance_to(-1e-6);
    EXPECT_EQ(calls, 2);
    EXPECT_EQ(simulation.input(Input::clamping_driving), 7702.0);
}

/// advance_to() ends cancelled, and calls back no more.
TEST(HostSimulation, CallbacksMayDestroyOrMoveTheirOwnSimulation) {
    const Scene scene = tiny();
    std::unique_ptr<Simulation> simulation, other;
    const std::vector<std::function<void()>> ends{[&] { simulation.reset(); }, [&] { *simulation = Simulation(scene); },
                                                  [&] { other = std::make_unique<Simulation>(std::move(*simulation)); },
                                                  [&] {
                                                      other = std::make_unique<Simulation>(std::move(*simulation));
                                                      simulation.reset();
                                                      other.reset();
                                                  }};
    for (const auto& end : ends) {
        for (const bool at_transition : {false, true}) {
            int calls = 0;
            simulation = std::make_unique<Simulation>(scene);
            const auto once = [&] { ++calls, end(); };
            if (at_transition)
                simulation->on_transition([&](Simulation&, const Transition&) { once(); });
            else
                simulation->on_output(1e-5, [&](Simulation&) { once(); });
            EXPECT_EQ(code_of([&] { simulation->advance_to(0.0); }), ErrorCode::cancelled);
            EXPECT_EQ(calls, 1);
        }
    }
}

/// The last reference to a simulation may be that of its callback.
TEST(HostSimulation, MayEndWithTheCallbackThatHoldsIt) {
    auto simulation = std::make_shared<Simulation>(tiny());
    Simulation& it = *simulation;
    const std::weak_ptr<Simulation> seen = simulation;
    it.on_output(1e-5, [simulation](Simulation& self) { self.on_output(1.0, nullptr); });
    simulation.reset();
    EXPECT_FALSE(seen.expired());
    EXPECT_EQ(code_of([&] { it.advance_to(0.0); }), ErrorCode::cancelled);
    EXPECT_TRUE(seen.expired());
}

TEST(HostSimulation, ExceptionsOfCallbacksReachTheCaller) {
    Simulation simulation(tiny(), Threads::private_arena(2));
    simulation.on_output(1e-4, [](Simulation&) { throw std::string("from the host"); });
    EXPECT_THROW(simulation.advance_to(0.0), std::string);
    EXPECT_NEAR(simulation.time(), -2e-4, 1e-9);
    simulation.on_output(1.0, nullptr);
    simulation.advance_to(-1e-4);  // and continues
    Simulation undisturbed(tiny());
    undisturbed.advance_to(-1e-4);
    EXPECT_EQ(simulation.hash(), undisturbed.hash());
}

TEST(HostSimulation, ReportsFaultsWithCodesAndStaysAtTheLastGoodStep) {
    Simulation simulation(tiny({"run.step=10 us", "run.output_interval=10 us"}));
    const ErrorCode code = code_of([&] { simulation.advance_to(0.0); });
    EXPECT_TRUE(code == ErrorCode::non_finite || code == ErrorCode::penetration || code == ErrorCode::left_sheave ||
                code == ErrorCode::blow_up)
        << error_name(code);
    for (const double unknown : simulation.unknowns()) ASSERT_TRUE(std::isfinite(unknown));
    EXPECT_LT(simulation.largest_stable_step(), 1e-5);
    EXPECT_GT(simulation.largest_stable_step(), 1e-9);
}

TEST(HostSimulation, ReportsWhatIsWrongWithScenesAndArguments) {
    EXPECT_EQ(code_of([] { static_cast<void>(Scene::read("/nowhere.toml")); }), ErrorCode::scene);
    EXPECT_EQ(error_of([] { static_cast<void>(Scene::parse("[chain]\npins = 2\n", "host.toml")); }),
              "host.toml:2:8: chain.pins: 2 is outside [3, 10000]");
    EXPECT_EQ(error_of([] { static_cast<void>(Scene::ready("baselin")); }), "no scene 'baselin' (did you mean 'baseline'?)");
    EXPECT_EQ(tiny().value("chain.pins"), "24");
    EXPECT_EQ(code_of([] { static_cast<void>(tiny().value("chain.pin")); }), ErrorCode::argument);
    EXPECT_EQ(error_of([] { Simulation(tiny(), Threads::private_arena(-1)); }), "threads: -1 is outside [0, 1024]");
    EXPECT_EQ(error_of([] { Simulation(tiny(), Threads::current_arena(0)); }), "threads: 0 is outside [1, 1024]");
    EXPECT_EQ(error_of([] { Simulation(tiny(), Threads::caller(), 25); }), "segments: 25 is outside [0, 24], the links of this chain");
    Simulation simulation(tiny());
    EXPECT_EQ(code_of([&] { simulation.advance_to(std::nan("")); }), ErrorCode::argument);
    EXPECT_EQ(code_of([&] { simulation.on_output(0.0, [](Simulation&) {}); }), ErrorCode::argument);
    EXPECT_EQ(code_of([&] { simulation.advance_to(-1.0); }), ErrorCode::argument);  // the past
    EXPECT_EQ(simulation.time(), -3e-4);
}

TEST(HostSimulation, VersionOfHeadersAndLibraryIsThatOfTheProject) {
    const std::string headers =
        std::to_string(CVTFLOW_VERSION_MAJOR) + "." + std::to_string(CVTFLOW_VERSION_MINOR) + "." + std::to_string(CVTFLOW_VERSION_PATCH);
    EXPECT_EQ(headers, CVTFLOW_PROJECT_VERSION);
    EXPECT_EQ(library_version(), CVTFLOW_PROJECT_VERSION);
}

/// count: simulations; a fifth fills what oneTBB and the allocator keep
void come_and_go(int count) {
    const Scene scene = tiny();
    std::size_t in_use = 0;
    long workers = 0;
    for (int k = 0; k < count; ++k) {
        Simulation simulation(scene, k % 2 == 0 ? Threads::caller() : Threads::private_arena(2));
        if (k % 4 < 2) simulation.step();
        if (k == count / 5) in_use = mallinfo2().uordblks;
        if (k == count / 5) workers = threads();
    }
    EXPECT_LT(mallinfo2().uordblks, in_use + 100'000);  // a simulation takes 0.2 MB
    EXPECT_LE(threads(), workers);
}
TEST(HostSimulation, AHundredComeAndGoWithoutATrace) { come_and_go(100); }
TEST(NightlyHostSimulation, AThousandComeAndGoWithoutATrace) { come_and_go(1000); }

// Time goes forward by steps and back by states.

/// Outputs may be far apart: a request between the last two was obeyed by doing nothing.
TEST(HostTime, GoesBackByNoStepWhateverTheOutputs) {
    for (const std::string interval : {"10 us", "1 ms"}) {
        Simulation simulation(tiny({"run.output_interval=" + interval, "run.state_interval=" + interval}));
        simulation.advance_to(-1e-4);
        for (const double back : {1e-6, 5e-6, 1e-4}) {
            const auto go_back = [&] { simulation.advance_to(-1e-4 - back); };
            EXPECT_EQ(code_of(go_back), ErrorCode::argument) << interval << ", " << back;
            EXPECT_THAT(error_of(go_back), testing::HasSubstr("to go back, set a state"));
        }
        simulation.advance_to(-1e-4);                  // again
        simulation.advance_to(-1e-4 * (1.0 - 1e-15));  // rounded otherwise
        EXPECT_NEAR(simulation.time(), -1e-4, 1e-12);
        for (int k = 0; k < 30; ++k) simulation.step();
        EXPECT_EQ(code_of([&] { simulation.advance_to(-1e-4); }), ErrorCode::argument) << interval;  // steps have been taken
        simulation.advance_to(simulation.time());
    }
}

/// The last step may have ended after the requested time, and so after the next one.
TEST(HostTime, MayBeAskedForInPartsOfAStep) {
    Simulation simulation(tiny({"run.step=1 us"}));
    for (int k = -3000; k < -2990; ++k) simulation.advance_to(1e-7 * k);
    EXPECT_EQ(simulation.counters().steps, 1);
}

/// Elasticity limits leapfrogs: h ω < 2 with the 1.23e5 Hz of the fastest oscillation, some microseconds.
TEST(HostTime, KnowsTheLargestStableStepOfProgramsToo) {
    Simulation leapfrog(tiny({"run.method=leapfrog-sweep"})), dumka3(tiny({"run.method=dumka3"}));
    for (Simulation* simulation : {&leapfrog, &dumka3}) simulation->advance_to(-2.9e-4);
    EXPECT_GT(leapfrog.largest_stable_step(), 1e-6);
    EXPECT_LT(leapfrog.largest_stable_step(), 2.0 / (2.0 * 3.14159 * 1e5));
    EXPECT_GT(dumka3.largest_stable_step(), 50e-6) << "its longest polynomial reaches far";
    EXPECT_EQ(leapfrog.method(), "leapfrog-sweep");
    EXPECT_EQ(Simulation(tiny({"run.method=auto"})).method(), "leapfrog-sweep");
}

// Rigid pins in a host: one thread, the same bits.

TEST(HostRigidPins, ReportEveryTransitionOfTheirTips) {
    Simulation simulation(rigid());
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
