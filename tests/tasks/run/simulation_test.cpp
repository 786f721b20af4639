#include "tasks/run/simulation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <tuple>
#include <utility>

#include "engine/record/run/state_file.hpp"
#include "tasks/run/saved_start.hpp"
#include "tests/tasks/run/settled_run_fixture.hpp"
#include "tests/temporary_file_fixture.hpp"

namespace cvtflow::tasks {
namespace {

Scene tiny_scene(const std::vector<std::string>& settings = {}) {
    return scene_of("tiny", "", {"start.settling_time=0.5 ms", "start.ramp_time=0.5 ms", "run.until=0.1 ms", "run.step=50 ns"}, settings);
}

std::vector<double> state_of(const Simulation& simulation) {
    const double* y = simulation.workspace().state();
    return {y, y + simulation.workspace().layout().size()};
}

std::vector<double> slope_of(const Simulation& simulation, double t) {
    const Workspace& w = simulation.workspace();
    model::EvaluationScratch scratch(w.layout());
    std::vector<double> slope(static_cast<std::size_t>(w.layout().size()));
    model::right_hand_side(w.variator, t, w.state(), w.tips.phases.data(), slope.data(), scratch);
    return slope;
}

/// Memory that outlasts a step is part of it, so the count has at least the bytes that a state keeps.
TEST(Simulation, CountsTheMemoryOfItsMethod) {
    const auto bytes = [](const char* method, const char* level, std::size_t& kept) {
        Simulation simulation(scene_of("tiny", level, {"start.settling_time=0.5 ms", "start.ramp_time=0.5 ms", "run.step=50 ns"},
                                       {std::string("run.method=") + method}));
        settle_and_go(simulation, 1e-5);
        kept = simulation.integration_state().method.size();
        const model::RigidState* columns = simulation.workspace().rigid_pins();  // counted as the workspace's
        const std::optional<std::size_t> method_bytes = simulation.integrator().method().bytes();
        return columns != nullptr ? *method_bytes + columns->bytes() : method_bytes;
    };
    std::size_t kept = 0;
    for (const auto& [method, level] : {std::pair{"leapfrog-sweep", ""}, {"leapfrog-rigid", "rigid"}}) {
        EXPECT_GT(bytes(method, level, kept).value_or(0), kept) << method;
        EXPECT_GT(kept, 0u) << method;
    }
    EXPECT_EQ(bytes("rk4", "", kept), 0u) << "its stages are in the workspace";
}

TEST(Simulation, GoesThroughTransitionsInTheseRuns) {
    Simulation simulation(tiny_scene());
    ASSERT_FALSE(go(simulation, {.until = 0.0}));
    EXPECT_GT(simulation.counters().detected, 100);
    EXPECT_GT(simulation.counters().truncated, 50);
}

TEST(Simulation, AnyNumberMayLiveSideBySide) {
    const std::uint64_t alone = hash_at(tiny_scene(), 1e-5);
    Simulation first(tiny_scene()), second(tiny_scene({"detail.pulleys=rigid", "run.segments=3"}));
    for (int part = 0; part < 2; ++part) {  // by turns
        for (Simulation* each : {&first, &second}) EXPECT_FALSE(go(*each, {.until = 1e-5}));
    }
    EXPECT_EQ(first.hash(), alone);
    EXPECT_NE(second.hash(), alone);
}

TEST(Simulation, RunsInOneGoAsInPieces) {
    Simulation whole(tiny_scene()), pieces(tiny_scene());
    settle_and_go(whole, 4e-5);
    settle_and_go(pieces, 2e-5);
    ASSERT_FALSE(go(pieces, {.until = 4e-5, .new_part = true}));
    EXPECT_DOUBLE_EQ(pieces.time(), whole.time());
    // Times of steps may differ in their last digit.
    for (int k = 0; k < whole.workspace().layout().size(); ++k)
        EXPECT_NEAR(pieces.workspace().state()[k], whole.workspace().state()[k], 1e-7 + 1e-7 * std::abs(whole.workspace().state()[k]));
}

TEST(Simulation, WhereCallsEndDoesNotChangeABit) {
    const Scene rigid = scene_of("tiny", "rigid", {"run.step=2 us", "start.settling_time=2 ms", "start.ramp_time=1 ms"});
    for (const auto& [scene, until, at_once] : {std::tuple{tiny_scene(), 2e-5, 997L}, {rigid, 2e-3, 97L}}) {
        Simulation whole(scene), pieces(scene);
        settle_and_go(whole, until);
        long calls = 0;
        while (pieces.needs_settling() || pieces.time() < until - 1e-12) {
            const Fault fault = go(pieces, {.until = until, .steps = at_once});
            ASSERT_TRUE(!fault || fault.kind == FaultKind::max_steps) << fault.message();
            ASSERT_LT(++calls, 100);
        }
        EXPECT_GT(calls, 5);
        EXPECT_EQ(pieces.counters().steps, whole.counters().steps) << "of the run, without those of settling";
        EXPECT_EQ(pieces.hash(), whole.hash());
    }
}

TEST(Simulation, APartBegunAnewCountsFromZeroAndEndsAfterItsSteps) {
    Simulation simulation(tiny_scene());
    settle_and_go(simulation, 1e-5);
    const double before = simulation.time();
    EXPECT_EQ(go(simulation, {.steps = 5, .new_part = true}).kind, FaultKind::max_steps);
    EXPECT_EQ(simulation.counters().steps, 5);
    EXPECT_GT(simulation.time(), before);
    EXPECT_EQ(go(simulation, {.steps = 3}).kind, FaultKind::max_steps);
    EXPECT_EQ(simulation.counters().steps, 8) << "continues";
}

/// A simulation that has gone to a time, its state in a file, and what begins with it.
class SavedStates : public testing::Test {
protected:
    /// Writes its state, of which scenes begin from now on.
    void save(const Simulation& simulation) { engine::write_state(file_.path(), simulation.saved_state()); }
    std::unique_ptr<Simulation> saved(const Scene& scene, double at = 0.0) {
        auto simulation = std::make_unique<Simulation>(scene);
        settle_and_go(*simulation, at);
        save(*simulation);
        return simulation;
    }
    /// A scene that begins with it.
    [[nodiscard]] Scene begun(Scene scene, const std::vector<std::string>& settings = {}) const {
        scene.state_file = file_.path();
        set_values(scene, settings);
        return scene;
    }

    const tests::TemporaryFile file_{"simulation_test"};
};

const std::vector<std::string> everything{"control.enabled=true", "control.driven=slip", "record.ledger=true", "detail.stick_slip=true"};

TEST_F(SavedStates, ContinueAsIfTheyHadNotBeenSaved) {
    for (const double saved_at : {0.0, 2e-5}) {
        for (const auto& settings : {std::vector<std::string>{}, everything}) {
            const Scene scene = tiny_scene(settings);
            const auto simulation = saved(scene, saved_at);
            Simulation continued(begun(scene));
            EXPECT_FALSE(continued.needs_settling());
            EXPECT_TRUE(continued.start_differences().empty());
            EXPECT_EQ(continued.time(), simulation->time());
            EXPECT_EQ(continued.hash(), simulation->hash());
            EXPECT_EQ(slope_of(continued, continued.time()), slope_of(*simulation, simulation->time()));
            ASSERT_FALSE(go(continued, {.until = saved_at + 1e-5}));
            ASSERT_FALSE(go(*simulation, {.until = saved_at + 1e-5, .new_part = true}));
            EXPECT_EQ(continued.hash(), simulation->hash());
        }
    }
}

/// Their numbers change from none, one and two to each other: integrals of the controllers that both have and the ledger continue, others
/// begin at zero.
TEST_F(SavedStates, TakeAnotherNumberOfControllersWithOrWithoutALedger) {
    const std::vector<std::string> machines[] = {
        {}, {"control.enabled=true", "record.ledger=true"}, {"control.enabled=true", "control.driven=safety", "record.ledger=true"}};
    for (const auto& had : machines) {
        const auto simulation = saved(tiny_scene(had), 1e-5);
        const std::vector<double> before = state_of(*simulation);
        const model::ChainLayout from = simulation->workspace().layout();
        for (const auto& has : machines) {
            SCOPED_TRACE(testing::PrintToString(had) + " to " + testing::PrintToString(has));
            const Simulation other(begun(tiny_scene(has)));
            const std::vector<double> after = state_of(other);
            const model::ChainLayout& at = other.workspace().layout();
            EXPECT_TRUE(std::equal(after.begin(), after.begin() + at.control_begin(), before.begin()));
            for (int k = 0; k < at.controls; ++k) {
                const double integral = k < from.controls ? before[static_cast<std::size_t>(from.control_begin() + k)] : 0.0;
                EXPECT_EQ(after[static_cast<std::size_t>(at.control_begin() + k)], integral);
                EXPECT_TRUE(integral != 0.0 || k > 0 || from.controls == 0);
            }
            for (int k = 0; k < at.size() - at.ledger_begin(); ++k) {
                const double counted = from.size() > from.ledger_begin() ? before[static_cast<std::size_t>(from.ledger_begin() + k)] : 0.0;
                EXPECT_EQ(after[static_cast<std::size_t>(at.ledger_begin() + k)], counted);
            }
        }
    }
}

TEST_F(SavedStates, HaveStickAndSlipTranslated) {
    for (const bool had : {false, true}) {
        static_cast<void>(saved(tiny_scene({had ? "detail.stick_slip=true" : "detail.stick_slip=false"})));
        Simulation other(begun(tiny_scene({had ? "detail.stick_slip=false" : "detail.stick_slip=true"})));
        ASSERT_FALSE(go(other, {.until = 1e-6}));
        const auto count = [&](model::Phase phase) { return std::ranges::count(other.workspace().tips.phases, phase); };
        const auto touching = count(model::Phase::touching), stick_or_slip = count(model::Phase::stick) + count(model::Phase::slip);
        EXPECT_GT(had ? touching : stick_or_slip, 20);
        EXPECT_EQ(had ? stick_or_slip : touching, 0);
    }
}

TEST_F(SavedStates, ReportWhatDiffersFromTheSceneThatWasSettledAndRefuseAnotherDetail) {
    Scene scene = tiny_scene();
    save(Simulation(scene));
    scene.parameters.half.mass *= 2.0;
    EXPECT_EQ(Simulation(begun(scene)).start_differences().size(), 1u);
    scene.parameters.detail.pulleys = model::PulleyDetail::rigid;
    EXPECT_THROW(Simulation{begun(scene)}, SimulationError);
}

/// A tenth of a millimetre of pitch is a hundred times the strain that the chain's plates carry.
TEST_F(SavedStates, OfAnotherMachineAreSettledAnew) {
    static_cast<void>(saved(tiny_scene()));
    const Scene scene = begun(tiny_scene());
    const std::pair<const char*, bool> settings[] = {{"tip.friction_coefficient=0.12", true},
                                                     {"chain.damping_ratio=0.05", true},
                                                     {"half.mass=3.5 g", true},
                                                     {"clamping.driven=60 kN", true},
                                                     {"chain.pitch=8.2 mm", false},
                                                     {"chain.pitch=[\"8.12 mm\",\"8.22 mm\",\"8.02 mm\"]", false},
                                                     {"half.width=2.2 mm", false},
                                                     {"joint.radius=8 mm", false},
                                                     {"tip.hertz=1e11", false},
                                                     {"pulley.centre_distance=47.2 mm", false}};
    for (const auto& [setting, fits] : settings) {
        SCOPED_TRACE(setting);
        Scene other = scene;
        set_value(other, setting);
        Simulation started(other);
        EXPECT_EQ(started.needs_settling(), !fits);
        EXPECT_EQ(fitting_start(other) != nullptr, fits);
        EXPECT_TRUE(fits || started.start_differences().back().find("settles again") != std::string::npos);
        Simulation reused(scene);
        reused.reset(other, saved_start(other).get());
        EXPECT_EQ(reused.hash(), started.hash());
        if (fits) continue;
        other.parameters.start.settling_time = 0.0;
        EXPECT_THROW(Simulation{other}, SimulationError);
    }
}

/// A workspace that another case has used: unknowns that a saved state lacks begin at zero, as in a new simulation.
TEST_F(SavedStates, LeaveNothingOfTheCaseBeforeInAWorkspace) {
    static_cast<void>(saved(tiny_scene()));
    const Scene scene = begun(tiny_scene(), {"control.enabled=true", "control.integral=1e8 N/s", "record.ledger=true"});
    const Simulation started(scene);
    Simulation reused(scene);
    ASSERT_FALSE(go(reused, {.until = reused.time() + 20e-6}));
    const model::ChainLayout& at = reused.workspace().layout();
    ASSERT_NE(reused.workspace().state()[at.control_begin()], 0.0) << "an integral of the first case";
    reused.reset(scene, saved_start(scene).get());
    EXPECT_EQ(reused.workspace().state()[at.control_begin()], 0.0);
    EXPECT_EQ(reused.hash(), started.hash());
}

TEST(Simulation, RefusesAnUnknownMethod) {
    Scene scene = tiny_scene();
    scene.run.method = "rk17";
    EXPECT_THROW(Simulation{scene}, SimulationError);
}

/// The scene begins with 2 kN too little. The proportional part alone would leave the ratio off by 2 kN/K_P = 0.15 %; the guess of C is
/// good to a factor of three.
TEST(Simulation, WithFoundGainsHoldsTheRatioBySettlingOnce) {
    const Scene scene = scene_of("control", "rigid", {"start.state=\"\"", "start.settling_time=40 ms", "control.gains=found"});
    Simulation simulation(scene);
    const auto clamping = [&] {
        return simulation.workspace().variator.pulleys().inputs().at(simulation.time(), pulleys_of(simulation)).clamping[0];
    };
    const auto built_up = [&] { return simulation.workspace().state()[simulation.workspace().layout().control_begin()]; };
    settle_and_go(simulation, 0.0);
    const double integral = scene.parameters.control.integral, found = built_up() * integral;
    EXPECT_GT(found, 1e3);
    EXPECT_LT(found, 3e3);
    EXPECT_GT(clamping(), 25.1e3 + found) << "what is left of the error acts beside it";
    settle_and_go(simulation, 60e-3);
    model::Observer observer(simulation.workspace().variator);
    const model::Observation& now = simulation.workspace().observed_by(observer, simulation.time());
    EXPECT_NEAR(now.ratio, 1.0023, 0.0005);
    EXPECT_NEAR(clamping(), 25.1e3 + integral * built_up(), 0.02 * clamping());
}

/// Checkpoints pause a run regularly; the used part of its budget stays used.
TEST(WallBudget, PausesDoNotGiveTheBudgetOfWallTimeBack) {
    bool due = false;
    Outputs observer([&](double, const Workspace&, const Counters&) { due = true; });
    constexpr double budget = 0.05;  // [s]
    Scene scene = ready_tiny();
    scene.parameters.start.settling_time = 0.0;
    scene.run.until = 1.0;  // minutes
    scene.run.step = 5e-8;
    scene.run.output_interval = 2e-7;  // a few steps: several pauses fit into the budget, however slow the build
    scene.run.max_wall = budget;
    Simulation simulation(scene);
    Fault fault;
    int pauses = 0;
    do {
        due = false;
        fault = simulation.advance({.until = scene.run.until, .pause = &due}, observer, engine::Cancellation());
    } while (fault.kind == FaultKind::cancelled && ++pauses < 10'000);
    EXPECT_EQ(fault.kind, FaultKind::max_wall);
    EXPECT_EQ(fault.limit, budget);
    EXPECT_GT(fault.value, budget);
    EXPECT_GT(pauses, 3);
}

}  // namespace
}  // namespace cvtflow::tasks
