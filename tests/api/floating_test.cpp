/// A host's floating-point environment: nothing of it reaches a result, and the host finds it as it left it.

#include <cvtflow/cvtflow.h>

#include <cfenv>
#include <cstring>

#include "host_fixture.hpp"

namespace cvtflow::host {
namespace {

/// Environment that a host may have set.
struct Environment {
    const char* name;
    int round;
    int traps;
    bool flushes;  ///< denormals to zero, as hosts of audio and games set it
};

constexpr Environment environments[] = {
    {"upward", FE_UPWARD, 0, false},
    {"downward", FE_DOWNWARD, 0, false},
    {"toward zero", FE_TOWARDZERO, 0, false},
    {"denormals flushed", FE_TONEAREST, 0, true},
    {"every trap set, inexact too", FE_TONEAREST, FE_ALL_EXCEPT, false},
    {"all of it", FE_UPWARD, FE_ALL_EXCEPT, true},
};

void adopt(const Environment& environment) {
    std::fesetenv(FE_DFL_ENV);
    std::fesetround(environment.round);
    if (environment.flushes) __builtin_ia32_ldmxcsr(__builtin_ia32_stmxcsr() | 0x8040);
    feenableexcept(environment.traps);
}

/// Whether modes, traps and flags are the same; the rest (where the last x87 instruction stood, how it compared) is no part of an
/// environment.
bool same(const std::fenv_t& a, const std::fenv_t& b) {
    return a.__control_word == b.__control_word && (a.__status_word & FE_ALL_EXCEPT) == (b.__status_word & FE_ALL_EXCEPT) &&
           a.__mxcsr == b.__mxcsr;
}

/// Calls the interface under an environment, and checks after each call that it is still the host's.
class Host {
public:
    explicit Host(const Environment& environment) : environment_(environment) {}

    template <class Call>
    auto operator()(const char* name, Call&& call) {
        adopt(environment_);
        std::fenv_t before;
        std::fegetenv(&before);
        auto result = call();
        std::fenv_t after;
        std::fegetenv(&after);
        std::fesetenv(FE_DFL_ENV);
        EXPECT_TRUE(same(before, after)) << name << " leaves another environment than " << environment_.name;
        return result;
    }

private:
    const Environment& environment_;
};

template <class Action>
auto counted(const Action& action) {
    return [&action] {
        action();
        return 0;
    };
}

constexpr const char* decimals = "run.step=100.3 ns";  // no binary fraction: read by rounding

/// Everything that a host may ask of a scene and a simulation, as numbers to compare bit by bit.
std::vector<double> tour(const Environment& environment, const std::string& method, Threads threads = Threads::caller()) {
    Host host(environment);
    std::vector<double> seen;
    const auto note = [&](double number) { seen.push_back(number); };
    const std::string path = std::string(CVTFLOW_SOURCE_DIR) + "/scenes/tiny.toml";
    const std::vector<std::string> brief{"start.settling_time=0.1003 ms", "start.ramp_time=0.0997 ms", decimals, "run.method=" + method};
    Scene scene = host("Scene::read", [&] { return Scene::read(path); });
    scene = host("Scene::with", [&] { return scene.with(brief); });
    const std::string text = host("Scene::text", [&] { return scene.text(); });
    scene = host("Scene::parse", [&] { return Scene::parse(text, path); });
    static_cast<void>(host("Scene::value", [&] { return scene.value("run.step"); }));
    Simulation first = host("Simulation", [&] { return Simulation(scene, threads); });
    note(host("step_length", [&] { return first.step_length(); }));
    host("on_output", counted([&] { first.on_output(1.1e-5, [](Simulation&) {}); }));
    host("advance_to", counted([&] { first.advance_to(-6.01e-5); }));
    host("step", counted([&] { first.step(); }));
    note(host("time", [&] { return first.time(); }));
    host("set_input", counted([&] { first.set_input(Input::clamping_driving, 7713.1); }));
    note(host("input", [&] { return first.input(Input::load_torque); }));
    Simulation second = host("copy", [&] { return first.copy(); });
    const State state = host("state", [&] { return first.state(); });
    host("set_state", counted([&] { second.set_state(state); }));
    host("advance_to", counted([&] { second.advance_to(-5.003e-5); }));
    for (const char* channel : {"ratio", "shaft_1/clamping"}) note(host("channel", [&] { return second.channel(channel)[0]; }));
    std::vector<double> slope(second.size());
    host("rhs", counted([&] { second.rhs(second.time(), second.unknowns(), slope); }));
    seen.insert(seen.end(), slope.begin(), slope.end());
    seen.insert(seen.end(), second.unknowns().begin(), second.unknowns().end());
    note(host("largest_stable_step", [&] { return second.largest_stable_step(); }));
    first = host("Simulation::operator=", [&] { return std::move(second); });
    return seen;
}

/// A method each: all of them in one take a quarter of an hour under sanitizers.
class HostFloatingWith : public testing::TestWithParam<const char*> {};

TEST_P(HostFloatingWith, EnvironmentReachesNoResultOfTheCppInterface) {
    const std::vector<double> expected = tour({"the default", FE_TONEAREST, 0, false}, GetParam());
    for (const Environment& environment : environments) {
        const bool traps = environment.traps != 0;  // workers inherit them
        const std::vector<double> seen = tour(environment, GetParam(), traps ? ways().back() : Threads::caller());
        ASSERT_EQ(seen.size(), expected.size());
        EXPECT_EQ(std::memcmp(seen.data(), expected.data(), seen.size() * sizeof(double)), 0) << environment.name;
    }
}

INSTANTIATE_TEST_SUITE_P(Methods, HostFloatingWith, testing::Values("rk4", "dumka3", "leapfrog-sweep", "heun"), [](const auto& method) {
    std::string name = method.param;
    std::erase(name, '-');
    return name;
});

/// The hash after a short run through the C interface.
std::uint64_t c_tour(const Environment& environment) {
    Host host(environment);
    const std::string path = std::string(CVTFLOW_SOURCE_DIR) + "/scenes/tiny.toml";
    const char* settings[] = {"start.settling_time=0.1003 ms", "start.ramp_time=0.0997 ms", decimals};
    cvtflow_scene *read = nullptr, *scene = nullptr;
    cvtflow_simulation *simulation = nullptr, *copy = nullptr;
    EXPECT_EQ(host("cvtflow_scene_read", [&] { return cvtflow_scene_read(path.c_str(), &read, nullptr); }), CVTFLOW_OK);
    EXPECT_EQ(host("cvtflow_scene_with", [&] { return cvtflow_scene_with(read, settings, 3, &scene, nullptr); }), CVTFLOW_OK);
    EXPECT_EQ(host("cvtflow_create", [&] { return cvtflow_create(scene, nullptr, &simulation, nullptr); }), CVTFLOW_OK);
    EXPECT_EQ(host("cvtflow_advance_to", [&] { return cvtflow_advance_to(simulation, -6.01e-5, nullptr); }), CVTFLOW_OK);
    EXPECT_EQ(host("cvtflow_copy", [&] { return cvtflow_copy(simulation, &copy, nullptr); }), CVTFLOW_OK);
    EXPECT_EQ(host("cvtflow_step", [&] { return cvtflow_step(copy, nullptr); }), CVTFLOW_OK);
    const std::uint64_t hash = host("cvtflow_hash", [&] { return cvtflow_hash(copy); });
    for (cvtflow_simulation* each : {simulation, copy}) host("cvtflow_destroy", counted([&] { cvtflow_destroy(each); }));
    for (cvtflow_scene* each : {read, scene}) host("cvtflow_scene_release", counted([&] { cvtflow_scene_release(each); }));
    return hash;
}

TEST(HostFloating, EnvironmentReachesNoResultOfTheCInterface) {
    const std::uint64_t expected = c_tour({"the default", FE_TONEAREST, 0, false});
    for (const Environment& environment : environments) EXPECT_EQ(c_tour(environment), expected) << environment.name;
}

TEST(HostFloating, EnvironmentIsTheHostsAgainInItsCallbacksWhichMayChangeIt) {
    Simulation simulation(tiny());
    int calls = 0;
    simulation.on_output(1e-5, [&](Simulation&) {
        EXPECT_EQ(std::fegetround(), ++calls == 1 ? FE_UPWARD : FE_DOWNWARD);
        std::fesetround(FE_DOWNWARD);
    });
    std::fesetround(FE_UPWARD);
    simulation.advance_to(-2.7e-4);
    const int left = std::fegetround();
    std::fesetenv(FE_DFL_ENV);
    EXPECT_EQ(calls, 3);
    EXPECT_EQ(left, FE_DOWNWARD);
    Simulation plain(tiny());
    plain.advance_to(-2.7e-4);
    EXPECT_EQ(simulation.hash(), plain.hash());
}

TEST(HostFloating, EnvironmentIsTheHostsAgainAfterErrors) {
    Host host(environments[5]);
    EXPECT_EQ(host("Scene::parse", [] { return code_of([] { static_cast<void>(Scene::parse("[chain]\npins = 2.5\n")); }); }),
              ErrorCode::scene);
    EXPECT_EQ(host("State::from_bytes", [] { return code_of([] { static_cast<void>(State::from_bytes({})); }); }), ErrorCode::state);
    const Scene scene = tiny({"run.step=10 us", "run.output_interval=10 us"});
    Simulation diverging(scene);
    EXPECT_NE(host("advance_to", [&] { return code_of([&] { diverging.advance_to(0.0); }); }), ErrorCode::none);
}

}  // namespace
}  // namespace cvtflow::host
