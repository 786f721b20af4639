#include "tasks/run/simulation.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <utility>

#include "engine/record/run/state_file.hpp"
#include "tasks/run/saved_start.hpp"
#include "tests/sample_fixture.hpp"
#include "tests/tasks/tiny_fixture.hpp"

namespace cvtflow::tasks {
namespace {

SilentObserver silent;
const engine::Cancellation never_ended;

Scene tiny_scene() {
    Scene scene = read_scene(std::string(CVTFLOW_SOURCE_DIR) + "/scenes/tiny.toml");
    scene.parameters.start.settling_time = 5e-4;
    scene.parameters.start.ramp_time = 5e-4;
    scene.run.until = 1e-4;
    scene.run.step = 5e-8;
    return scene;
}

Fault settle_and_run(Simulation& simulation, double until) {
    if (const Fault fault = simulation.advance({.until = 0.0}, silent, never_ended)) return fault;
    return simulation.advance({.until = until}, silent, never_ended);
}

std::vector<double> slope_of(const Simulation& simulation, double t) {
    const Workspace& w = simulation.workspace();
    model::EvaluationScratch scratch(w.layout());
    std::vector<double> slope(static_cast<std::size_t>(w.layout().size()));
    model::right_hand_side(w.variator, t, w.state(), w.tips.phases.data(), slope.data(), scratch);
    return slope;
}

/// Automatic steps are long here: tips come and go within one.
TEST(Simulation, HasTheSameHashForEveryNumberOfSegments) {
    const std::vector<std::vector<std::string>> rows{
        {},
        {"run.step=auto"},
        {"detail.stick_slip=true", "record.ledger=true"},
        {"detail.stick_slip=true", "record.ledger=true", "run.step=auto"},
        {"guide.stiffness=1e6 N/m", "guide.clearance=0", "guide.offset=-0.3 mm", "guide.friction_coefficient=0.5"},
        {"imperfection.pin_length_spread=1 um", "imperfection.unbalance=1 g*m"}};
    for (const std::vector<std::string>& row : rows) {
        std::uint64_t expected = 0;
        for (const int segments : cvtflow::test::depth(std::vector{1, 5}, std::vector{1, 2, 3, 5, 7, 14, 24})) {
            Scene scene = tiny_scene();
            scene.parameters.start.settling_time = scene.parameters.start.ramp_time = 2e-4;
            set_values(scene, row);
            scene.run.segments = segments;
            Simulation simulation(scene);
            ASSERT_FALSE(settle_and_run(simulation, 1e-5));
            if (segments == 1) expected = simulation.hash();
            EXPECT_EQ(simulation.hash(), expected) << segments << " segments, " << testing::PrintToString(row);
        }
    }
}

/// Memory that outlasts a step is part of it, so the count has at least the numbers that a checkpoint keeps.
TEST(Simulation, CountsTheMemoryOfItsMethod) {
    const auto bytes = [](const char* method, model::PinDetail pins, std::size_t& kept) {
        Scene scene = tiny_scene();
        scene.run.method = method;
        if (pins == model::PinDetail::rigid) apply_detail(scene, "rigid");
        Simulation simulation(scene);
        EXPECT_FALSE(settle_and_run(simulation, 1e-5)) << method;
        kept = simulation.integration_state().method.size();
        const model::RigidState* columns = simulation.workspace().rigid_pins();  // counted as the workspace's
        const std::optional<std::size_t> method_bytes = simulation.integrator().method().bytes();
        return columns != nullptr ? *method_bytes + columns->bytes() : method_bytes;
    };
    std::size_t kept = 0;
    for (const auto& [method, pins] : {std::pair{"leapfrog-sweep", model::PinDetail::halves},
                                       {"leapfrog-chebyshev", model::PinDetail::halves},
                                       {"leapfrog-rigid", model::PinDetail::rigid}}) {
        EXPECT_GT(bytes(method, pins, kept).value_or(0), kept * sizeof(float)) << method;
        EXPECT_GT(kept, 0u) << method;
    }
    EXPECT_EQ(bytes("rk4", model::PinDetail::halves, kept), 0u) << "its stages are in the workspace";
}

TEST(Simulation, GoesThroughTransitionsInTheseRuns) {
    Simulation simulation(tiny_scene());
    ASSERT_FALSE(simulation.advance({.until = 0.0}, silent, never_ended));
    EXPECT_GT(simulation.counters().detected, 100);
    EXPECT_GT(simulation.counters().truncated, 50);
}

TEST(Simulation, AnyNumberMayLiveSideBySide) {
    Simulation alone(tiny_scene());
    ASSERT_FALSE(settle_and_run(alone, 1e-5));
    Scene other = tiny_scene();
    other.parameters.detail.pulleys = model::PulleyDetail::rigid;
    other.run.segments = 3;
    Simulation first(tiny_scene()), second(other);
    for (int part = 0; part < 2; ++part) {  // by turns
        ASSERT_FALSE(first.advance({.until = 1e-5}, silent, never_ended));
        ASSERT_FALSE(second.advance({.until = 1e-5}, silent, never_ended));
    }
    EXPECT_EQ(first.hash(), alone.hash());
    EXPECT_NE(second.hash(), alone.hash());
}

TEST(Simulation, RunsInOneGoAsInPieces) {
    Simulation whole(tiny_scene()), pieces(tiny_scene());
    ASSERT_FALSE(settle_and_run(whole, 4e-5));
    ASSERT_FALSE(settle_and_run(pieces, 2e-5));
    ASSERT_FALSE(pieces.advance({.until = 4e-5, .new_part = true}, silent, never_ended));
    EXPECT_DOUBLE_EQ(pieces.time(), whole.time());
    // Times of steps may differ in their last digit.
    for (int k = 0; k < whole.workspace().layout().size(); ++k)
        EXPECT_NEAR(pieces.workspace().state()[k], whole.workspace().state()[k], 1e-7 + 1e-7 * std::abs(whole.workspace().state()[k]));
}

TEST(Simulation, WhereCallsEndDoesNotChangeABit) {
    const double until = 2e-5;
    Simulation whole(tiny_scene()), pieces(tiny_scene());
    ASSERT_FALSE(settle_and_run(whole, until));
    long calls = 0, steps = 0;
    while (pieces.needs_settling() || pieces.time() < until - 1e-12) {
        const Fault fault = pieces.advance({.until = until, .steps = 997}, silent, never_ended);
        ASSERT_TRUE(!fault || fault.kind == FaultKind::max_steps) << fault.message();
        ASSERT_LT(++calls, 100);
        steps = pieces.counters().steps;
    }
    EXPECT_GT(calls, 5);
    EXPECT_EQ(steps, whole.counters().steps) << "of the run, without those of settling";
    EXPECT_EQ(pieces.hash(), whole.hash());
}

TEST(Simulation, APartBegunAnewCountsFromZeroAndEndsAfterItsSteps) {
    Simulation simulation(tiny_scene());
    ASSERT_FALSE(settle_and_run(simulation, 1e-5));
    const double before = simulation.time();
    EXPECT_EQ(simulation.advance({.steps = 5, .new_part = true}, silent, never_ended).kind, FaultKind::max_steps);
    EXPECT_EQ(simulation.counters().steps, 5);
    EXPECT_GT(simulation.time(), before);
    EXPECT_EQ(simulation.advance({.steps = 3}, silent, never_ended).kind, FaultKind::max_steps);
    EXPECT_EQ(simulation.counters().steps, 8) << "continues";
}

/// A state file that is gone with the test.
class WrittenState {
public:
    explicit WrittenState(const Simulation& simulation) : WrittenState(simulation.saved_state()) {}
    explicit WrittenState(const engine::SavedState& saved)
        : path_(std::filesystem::temp_directory_path() / ("cvtflow_simulation_test_" + std::to_string(::getpid()) + ".h5")) {
        engine::write_state(path_.string(), saved);
    }
    ~WrittenState() { std::filesystem::remove(path_); }
    WrittenState(const WrittenState&) = delete;
    WrittenState& operator=(const WrittenState&) = delete;
    [[nodiscard]] std::string path() const { return path_.string(); }

private:
    std::filesystem::path path_;
};

TEST(Simulation, ContinuesFromASavedStateAsIfItHadNotBeenSaved) {
    for (const double saved_at : {0.0, 2e-5}) {
        for (const bool everything : {false, true}) {
            Scene scene = tiny_scene();
            scene.parameters.control.enabled = everything;
            if (everything) scene.parameters.control.driven = model::DrivenControl::slip;
            scene.parameters.ledger = everything;
            scene.parameters.detail.stick_slip = everything;
            Simulation simulation(scene);
            ASSERT_FALSE(settle_and_run(simulation, saved_at));
            const WrittenState file(simulation);
            scene.state_file = file.path();
            Simulation continued(scene);
            EXPECT_FALSE(continued.needs_settling());
            EXPECT_TRUE(continued.start_differences().empty());
            EXPECT_EQ(continued.time(), simulation.time());
            EXPECT_EQ(continued.hash(), simulation.hash());
            EXPECT_EQ(slope_of(continued, continued.time()), slope_of(simulation, simulation.time()));
            ASSERT_FALSE(continued.advance({.until = saved_at + 1e-5}, silent, never_ended));
            ASSERT_FALSE(simulation.advance({.until = saved_at + 1e-5, .new_part = true}, silent, never_ended));
            EXPECT_EQ(continued.hash(), simulation.hash());
        }
    }
}

/// The number changes from one to two and back: the first controller's integral continues, the second's begins at zero.
TEST(Simulation, TakesASavedStateWithAnotherNumberOfControllers) {
    for (const auto driven : {model::DrivenControl::none, model::DrivenControl::safety}) {
        Scene scene = tiny_scene();
        scene.parameters.control.enabled = true;
        scene.parameters.control.driven = driven;
        scene.parameters.ledger = true;
        Simulation simulation(scene);
        ASSERT_FALSE(settle_and_run(simulation, 1e-5));
        const model::ChainLayout before = simulation.workspace().layout();
        ASSERT_NE(simulation.workspace().state()[before.control_begin()], 0.0);
        const WrittenState file(simulation);
        scene.state_file = file.path();
        const bool had_two = driven == model::DrivenControl::safety;
        scene.parameters.control.driven = had_two ? model::DrivenControl::none : model::DrivenControl::safety;
        Simulation other(scene);
        const model::ChainLayout& at = other.workspace().layout();
        EXPECT_EQ(before.controls + at.controls, 3);
        EXPECT_EQ(other.workspace().state()[at.control_begin()], simulation.workspace().state()[before.control_begin()]);
        if (!had_two) {
            EXPECT_EQ(other.workspace().state()[at.control_begin() + 1], 0.0);
        }
        for (int k = 0; k < model::loss_kinds + model::work_kinds; ++k)
            EXPECT_EQ(other.workspace().state()[at.ledger_begin() + k], simulation.workspace().state()[before.ledger_begin() + k]);
    }
}

/// A state of release 0.3.0, whose ledger had no loss of guides: with one controller it has as many numbers behind the pulleys as one
/// without any has now.
TEST(Simulation, TakesTheLedgerOfASavedStateFromBeforeGuides) {
    for (const auto driven : {model::DrivenControl::none, model::DrivenControl::safety}) {
        Scene scene = tiny_scene();
        scene.parameters.control.enabled = true;
        scene.parameters.control.driven = driven;
        scene.parameters.ledger = true;
        Simulation simulation(scene);
        ASSERT_FALSE(settle_and_run(simulation, 1e-5));
        const model::ChainLayout& at = simulation.workspace().layout();
        engine::SavedState saved = simulation.saved_state();
        ASSERT_EQ(std::erase_if(saved.attributes, [](const auto& each) { return each.name == ledger_size_attribute; }), 1u);
        saved.state.erase(saved.state.begin() + at.ledger_begin() + static_cast<int>(model::Loss::guide));
        const WrittenState file(saved);
        scene.state_file = file.path();
        const Simulation other(scene);
        EXPECT_EQ(std::vector<double>(other.workspace().state(), other.workspace().state() + at.size()),
                  std::vector<double>(simulation.workspace().state(), simulation.workspace().state() + at.size()));
    }
}

TEST(Simulation, TakesASavedStateWithOrWithoutControlAndLedger) {
    for (const bool had : {false, true}) {
        Scene scene = tiny_scene();
        scene.parameters.control.enabled = had;
        scene.parameters.ledger = had;
        Simulation simulation(scene);
        ASSERT_FALSE(simulation.advance({.until = 0.0}, silent, never_ended));
        const WrittenState file(simulation);
        scene.state_file = file.path();
        scene.parameters.control.enabled = !had;
        scene.parameters.ledger = !had;
        Simulation other(scene);
        const model::ChainLayout& at = other.workspace().layout();
        EXPECT_EQ(std::vector<double>(other.workspace().state(), other.workspace().state() + at.control_begin()),
                  std::vector<double>(simulation.workspace().state(), simulation.workspace().state() + at.control_begin()));
        for (int k = at.control_begin(); k < at.size(); ++k) EXPECT_EQ(other.workspace().state()[k], 0.0);
    }
}

TEST(Simulation, TranslatesStickAndSlipOfASavedState) {
    for (const bool had : {false, true}) {
        Scene scene = tiny_scene();
        scene.parameters.detail.stick_slip = had;
        Simulation simulation(scene);
        ASSERT_FALSE(simulation.advance({.until = 0.0}, silent, never_ended));
        const WrittenState file(simulation);
        scene.state_file = file.path();
        scene.parameters.detail.stick_slip = !had;
        Simulation other(scene);
        ASSERT_FALSE(other.advance({.until = 1e-6}, silent, never_ended));
        int touching = 0, stick_or_slip = 0;
        for (const model::Phase phase : other.workspace().tips.phases) {
            touching += phase == model::Phase::touching ? 1 : 0;
            stick_or_slip += phase == model::Phase::stick || phase == model::Phase::slip ? 1 : 0;
        }
        EXPECT_GT(had ? touching : stick_or_slip, 20);
        EXPECT_EQ(had ? stick_or_slip : touching, 0);
    }
}

TEST(Simulation, ReportsWhatDiffersFromTheSceneThatWasSettledAndRefusesAnotherDetail) {
    Scene scene = tiny_scene();
    Simulation simulation(scene);
    const WrittenState file(simulation);
    scene.state_file = file.path();
    scene.parameters.half.mass *= 2.0;
    EXPECT_EQ(Simulation(scene).start_differences().size(), 1u);
    scene.parameters.detail.pulleys = model::PulleyDetail::rigid;
    EXPECT_THROW(Simulation{scene}, SimulationError);
}

/// A tenth of a millimetre of pitch is a hundred times the strain that the chain's plates carry.
TEST(Simulation, SettlesAnewWhereItsStateBelongsToAnotherMachine) {
    Scene scene = tiny_scene();
    Simulation simulation(scene);
    ASSERT_FALSE(simulation.advance({.until = 0.0}, silent, never_ended));
    const WrittenState file(simulation);
    scene.state_file = file.path();
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
        Scene other = scene;
        set_value(other, setting);
        Simulation started(other);
        EXPECT_EQ(started.needs_settling(), !fits) << setting;
        EXPECT_EQ(fitting_start(other) != nullptr, fits) << setting;
        if (!fits) {
            EXPECT_NE(started.start_differences().back().find("settles again"), std::string::npos) << setting;
        }
        Simulation reused(scene);
        reused.reset(other, saved_start(other).get());
        EXPECT_EQ(reused.hash(), started.hash()) << setting;
        if (fits) continue;
        other.parameters.start.settling_time = 0.0;
        EXPECT_THROW(Simulation{other}, SimulationError) << setting;
    }
}

/// A workspace that another case has used: unknowns that a saved state lacks begin at zero, as in a new simulation.
TEST(Simulation, BeginsControlAndLedgerAtZeroWhereTheSavedStateHasNone) {
    Scene scene = tiny_scene();
    Simulation plain(scene);
    ASSERT_FALSE(plain.advance({.until = 0.0}, silent, never_ended));
    const WrittenState file(plain);
    scene.state_file = file.path();
    for (const char* setting : {"control.enabled=true", "control.integral=1e8 N/s", "record.ledger=true"}) set_value(scene, setting);
    const Simulation started(scene);
    Simulation reused(scene);
    ASSERT_FALSE(reused.advance({.until = reused.time() + 20e-6}, silent, never_ended));
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
    Scene scene = read_scene(std::string(CVTFLOW_SOURCE_DIR) + "/scenes/control.toml", StartState::ignored);
    apply_detail(scene, "rigid");
    set_values(scene, std::vector<std::string>{"start.state=\"\"", "start.settling_time=40 ms", "control.gains=found"});
    Simulation simulation(scene);
    const auto clamping = [&] {
        const Workspace& w = simulation.workspace();
        return w.variator.pulleys().inputs().at(simulation.time(), w.state() + w.layout().pulley_begin()).clamping[0];
    };
    const auto built_up = [&] { return simulation.workspace().state()[simulation.workspace().layout().control_begin()]; };
    ASSERT_FALSE(simulation.advance({.until = 0.0}, silent, never_ended));
    const double integral = scene.parameters.control.integral, found = built_up() * integral;
    EXPECT_GT(found, 1e3);
    EXPECT_LT(found, 3e3);
    EXPECT_GT(clamping(), 25.1e3 + found) << "what is left of the error acts beside it";
    ASSERT_FALSE(simulation.advance({.until = 60e-3}, silent, never_ended));
    model::Observer observer(simulation.workspace().variator);
    const model::Observation& now = simulation.workspace().observed_by(observer, simulation.time());
    EXPECT_NEAR(now.ratio, 1.0023, 0.0005);
    EXPECT_NEAR(clamping(), 25.1e3 + integral * built_up(), 0.02 * clamping());
}

/// Checkpoints pause a run regularly; the used part of its budget stays used.
TEST(WallBudget, PausesDoNotGiveTheBudgetOfWallTimeBack) {
    struct Pausing final : RunObserver {
        bool due = false;
        void output(double, const Workspace&, const Counters&) override { due = true; }
        void transition(const TransitionRecord&) override {}
    } observer;
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
        observer.due = false;
        fault = simulation.advance({.until = scene.run.until, .pause = &observer.due}, observer, engine::Cancellation());
    } while (fault.kind == FaultKind::cancelled && ++pauses < 10'000);
    EXPECT_EQ(fault.kind, FaultKind::max_wall);
    EXPECT_EQ(fault.limit, budget);
    EXPECT_GT(fault.value, budget);
    EXPECT_GT(pauses, 3);
}

}  // namespace
}  // namespace cvtflow::tasks
