#include "tasks/step/integration_state.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <limits>

#include "tasks/method/method.hpp"
#include "tasks/run/checkpoint.hpp"
#include "tasks/run/simulation.hpp"
#include "tests/sample_fixture.hpp"
#include "tests/tasks/tiny_fixture.hpp"
#include "tests/temporary_file_fixture.hpp"

namespace cvtflow::tasks {
namespace {

const engine::Cancellation never;

Scene tiny(const std::vector<std::string>& settings = {}) {
    return scene_of(
        "tiny", "",
        {"start.settling_time=20 us", "start.ramp_time=10 us", "run.until=20 us", "run.output_interval=5 us", "run.schedule=serial"},
        settings);
}

/// Pauses at every output but the first; counts and hashes outputs and transitions.
class Pauser final : public RunObserver {
public:
    explicit Pauser(bool pauses) : pauses_(pauses) {}
    void output(double time, const Workspace&, const Counters&) override {
        times.push_back(time);
        pause = pauses_ && times.size() > 1;
    }
    void transition(const TransitionRecord& record) override { transitions.push_back(record.time); }
    bool pause = false;
    std::vector<double> times, transitions;

private:
    bool pauses_;
};

struct Course {
    std::uint64_t hash;
    Counters settling, run;
    std::vector<double> times, transitions;
    bool operator==(const Course&) const = default;
};

Course undisturbed(const Scene& scene) {
    Simulation simulation(scene);
    Pauser observer(false);
    EXPECT_FALSE(simulation.advance({.until = 0.0}, observer, never));
    const Counters settling = simulation.counters();
    EXPECT_FALSE(simulation.advance({.until = scene.run.until}, observer, never));
    return {simulation.hash(), settling, simulation.counters(), observer.times, observer.transitions};
}

/// Throws the simulation away at every output; another one continues from a checkpoint on disk.
Course from_file_to_file(const Scene& scene, int segments) {
    const tests::TemporaryFile place("checkpoint");
    const std::string& file = place.path();
    Pauser observer(true);
    Course course{};
    IntegrationState at;
    bool fresh = true;
    for (int session = 0; session < 100; ++session) {
        Scene here = scene;
        here.run.segments = session % 2 == 0 ? 1 : segments;
        Simulation simulation(here);
        if (!fresh) simulation.restore(at);
        observer.pause = false;
        const bool settling = simulation.needs_settling();
        const Fault fault = simulation.advance({.until = here.run.until, .pause = &observer.pause}, observer, never);
        fresh = false;
        if (settling) course.settling = simulation.counters();
        if (!fault && !settling) {
            course.hash = simulation.hash();
            course.run = simulation.counters();
            break;
        }
        Checkpoint checkpoint;
        checkpoint.integration = simulation.integration_state();
        sign(checkpoint, here, simulation.workspace().variator);
        engine::write_state(file, checkpoint);
        const Checkpoint read = read_checkpoint(file);
        require_same(file, read, here, simulation.workspace().variator);
        EXPECT_EQ(read.integration, checkpoint.integration);
        at = read.integration;
    }
    course.times = observer.times;
    course.transitions = observer.transitions;
    return course;
}

void expect_the_same_course(const std::vector<std::string>& methods) {
    int usable = 0;
    for (const std::string& method : methods) {
        SCOPED_TRACE(method);
        Scene scene = tiny();
        scene.run.method = method;
        scene.run.step = 5e-8;
        try {
            const Simulation simulation(scene);
        } catch (const SimulationError&) {
            continue;
        }
        ++usable;
        const Course whole = undisturbed(scene);
        EXPECT_GT(whole.settling.detected, 0);
        EXPECT_EQ(from_file_to_file(scene, 3), whole);
    }
    EXPECT_GT(2 * usable, static_cast<int>(methods.size()));
}

TEST(IntegrationState, OfAMethodContinuesFromACheckpointBitForBit) {
    expect_the_same_course(cvtflow::test::sample(method_names(), cvtflow::test::depth(4, 12), "checkpoints"));
}
TEST(NightlyIntegrationState, OfEveryMethodContinuesFromACheckpointBitForBit) { expect_the_same_course(method_names()); }

TEST(IntegrationState, ContinuesWithStickAndSlipLedgerAndControl) {
    const Scene scene = tiny({"detail.stick_slip=true", "record.ledger=true", "control.enabled=true"});
    EXPECT_EQ(from_file_to_file(scene, 5), undisturbed(scene));
}

TEST(IntegrationState, OfAnotherSizeIsRefused) {
    const Simulation small(tiny({"detail.pulleys=rigid"}));
    Simulation simulation(tiny());
    EXPECT_THROW(simulation.restore(small.integration_state()), SimulationError);
}

/// Somewhere within settling, with all that the method remembers.
IntegrationState midway(const Scene& scene) {
    Simulation simulation(scene);
    Pauser observer(true);
    EXPECT_EQ(simulation.advance({.until = 0.0, .pause = &observer.pause}, observer, never).kind, FaultKind::cancelled);
    return simulation.integration_state();
}

using Bytes = std::vector<std::byte>;

Bytes bytes_of(IntegrationState state) {
    Bytes bytes;
    engine::write_fields(bytes, [&](auto& archive) { state.visit(archive); });
    return bytes;
}

/// The first value of a field.
struct Place {
    std::string name;
    std::size_t at;
};

/// Of all fields with values, those within others too.
std::vector<Place> places_in(std::span<const std::byte> all, std::size_t begin, std::size_t end) {
    std::vector<Place> places;
    for (std::size_t at = begin; at < end;) {
        const auto length = std::to_integer<std::size_t>(all[at]);
        const std::string name(reinterpret_cast<const char*>(all.data()) + at + 1, length);
        const char type = std::to_integer<char>(all[at + 1 + length]);
        std::uint64_t count = 0;
        std::memcpy(&count, all.data() + at + length + 2, sizeof count);
        at += length + 2 + sizeof count;
        const std::size_t size = count * (type == 'B' ? 1 : type == 'f' ? 4 : 8);
        if (name == "energy" || name == "method") {
            for (Place& inner : places_in(all, at, at + size)) places.push_back({name + "/" + inner.name, inner.at});
        } else if (count > 0) {
            places.push_back({name, at});
        }
        at += size;
    }
    return places;
}

/// A simulation's state after it has been taken by another, before its next step; empty: it was refused.
Bytes taken(const Bytes& bytes, Simulation& other) {
    try {
        IntegrationState state;
        engine::read_fields(bytes, [&](auto& archive) { state.visit(archive); });
        other.restore(state);
        const bool pause = true;
        SilentObserver silent;
        static_cast<void>(other.advance({.until = 0.0, .pause = &pause}, silent, never));
        return bytes_of(other.integration_state());
    } catch (const std::exception&) {
        return {};
    }
}

void expect_every_field_to_matter(const Scene& scene) {
    const IntegrationState state = midway(scene);
    const Bytes good = bytes_of(state);
    Simulation other(scene);
    EXPECT_EQ(taken(good, other), good);
    const std::vector<Place> places = places_in(good, 0, good.size());
    EXPECT_GT(places.size(), 50u);
    for (const Place& place : places) {
        Bytes bad = good;
        bad[place.at] ^= std::byte{1};
        EXPECT_NE(taken(bad, other), good) << place.name;
    }
    for (const std::size_t kept : {std::size_t{1}, std::size_t{5}, good.size() / 2, good.size() - 1})
        EXPECT_TRUE(taken(Bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(kept)), other).empty()) << kept;
}

/// What is written is read again, and no field is listed for one direction alone.
TEST(IntegrationState, OfMethodsComesBackAndEveryFieldOfItMatters) {
    for (const std::string& method : test::known_methods(
             {"dopri54", "dumka3", "leapfrog-sweep", "leapfrog-rigid", "fitted", "trapezoidal-broyden", "trapezoidal-frozen"})) {
        SCOPED_TRACE(method);
        Scene scene = tiny();
        if (method == "leapfrog-rigid") apply_detail(scene, "rigid");
        set_value(scene, "run.method=" + method);
        expect_every_field_to_matter(scene);
    }
}

TEST(IntegrationState, OfLevelsComesBackAndEveryFieldOfItMatters) {
    for (const char* level : {"fine", "full", "rigid"}) {
        SCOPED_TRACE(level);
        Scene scene = tiny({"control.enabled=true"});
        apply_detail(scene, level);
        expect_every_field_to_matter(scene);
    }
}

TEST(IntegrationState, ThatCannotBeIsRefused) {
    const IntegrationState good = midway(tiny());
    ASSERT_EQ(good.invalid_reason(), nullptr);
    const std::function<void(IntegrationState&)> changes[] = {
        [](IntegrationState& s) { s.grid_number = -1; },
        [](IntegrationState& s) { s.counters.steps = std::numeric_limits<long>::max(); },
        [](IntegrationState& s) { s.outputs += 10; },
        [](IntegrationState& s) { s.phases[3] = static_cast<model::Phase>(4); },
        [](IntegrationState& s) { s.time = std::numeric_limits<double>::quiet_NaN(); },
        [](IntegrationState& s) { s.output_interval = 0.0; },
        [](IntegrationState& s) { s.step = std::numeric_limits<double>::infinity(); },
        [](IntegrationState& s) { s.step = 1e-300; }};  // output_interval / step is counted
    for (const auto& change : changes) {
        IntegrationState bad = good;
        change(bad);
        Simulation simulation(tiny());
        EXPECT_THROW(simulation.restore(bad), SimulationError);
        EXPECT_NE(bad.invalid_reason(), nullptr);
    }
}

TEST(Simulation, ResetIsANewOne) {
    Scene scene = tiny();
    Simulation used(scene);
    Pauser observer(false);
    ASSERT_FALSE(used.advance({.until = 0.0}, observer, never));
    scene.parameters.load.torque = model::TimeTable(7.0);
    scene.parameters.tip.friction.saturation_speed *= 0.5;
    ASSERT_TRUE(fits(used, scene));
    used.reset(scene, nullptr);
    Simulation fresh(scene);
    ASSERT_FALSE(used.advance({.until = 0.0}, observer, never));
    ASSERT_FALSE(fresh.advance({.until = 0.0}, observer, never));
    EXPECT_EQ(used.hash(), fresh.hash());
    EXPECT_EQ(used.counters(), fresh.counters());
    scene.parameters.detail.pulleys = model::PulleyDetail::rigid;
    EXPECT_FALSE(fits(used, scene));
}

/// Every counter of settling: one of the six was lost.
TEST(RunHistory, ComesBackWhole) {
    Scene scene = tiny();
    Simulation simulation(scene);
    Checkpoint checkpoint;
    checkpoint.integration = simulation.integration_state();
    long number = 1;
    const auto count = [&number](std::string_view /*name*/, long& field) { field = number++; };
    visit_counters(checkpoint.history.settling, count);
    EXPECT_EQ(number - 1, static_cast<long>(sizeof(Counters) / sizeof(long))) << "visit_counters() leaves one out";
    checkpoint.history.settled = true;
    checkpoint.history.begin = 0.25;
    checkpoint.history.wall = 3.0;
    checkpoint.history.settling_wall = 2.0;
    sign(checkpoint, scene, simulation.workspace().variator);
    const tests::TemporaryFile file("history");
    engine::write_state(file.path(), checkpoint);
    EXPECT_EQ(read_checkpoint(file.path()).history, checkpoint.history);
}

TEST(Checkpoint, OfAnotherVersionContinuesOnlyIfMixed) {
    const Scene scene = tiny();
    const Simulation simulation(scene);
    const model::Variator& variator = simulation.workspace().variator;
    Checkpoint checkpoint;
    checkpoint.integration = simulation.integration_state();
    sign(checkpoint, scene, variator);
    EXPECT_NO_THROW(require_same("a", checkpoint, scene, variator));
    checkpoint.program = "cvtflow 0.1.0 (deadbeef), GNU";
    EXPECT_THROW(require_same("a", checkpoint, scene, variator), SimulationError);
    EXPECT_NO_THROW(require_same("a", checkpoint, scene, variator, true));
}

}  // namespace
}  // namespace cvtflow::tasks
