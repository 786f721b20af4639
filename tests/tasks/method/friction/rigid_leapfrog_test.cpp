/// Leapfrog of rigid pins: accuracy, energy, contacts, and as a method of a run: nothing depends on where calls end, faults have a place.

#include "tasks/method/friction/rigid_leapfrog.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

#include "engine/executor/serial.hpp"
#include "model/observe/observation.hpp"
#include "model/start/start_state.hpp"
#include "tasks/batch/sweep/sweep.hpp"
#include "tasks/method/method.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/step/step_graph.hpp"
#include "tasks/step/step_method.hpp"
#include "tests/engine/allocation_fixture.hpp"
#include "tests/engine/graph/graph_fixture.hpp"
#include "tests/oracle/oracle_cases.hpp"
#include "tests/tasks/tiny_fixture.hpp"

namespace cvtflow::tasks::test {

/// The leapfrog of rigid pins step by step, by its tasks on one thread, without a controller that observes or judges.
class RigidRun {
public:
    explicit RigidRun(const model::Parameters& parameters)
        : workspace_(parameters, method_.plan(), Partition::equal(parameters.chain.pins, 1)),
          step_method_(method_.make(workspace_)),
          graph_(step_graph(workspace_, {}, step_method_.get())) {}

    /// Begins at a state. @param time [s]   @param y [unknowns]
    void start(double time, const double* y) {
        std::copy_n(y, workspace_.layout().size(), workspace_.state_to_set());
        workspace_.step.time = time;
        step_method_->restart();
        step_method_->load({});
    }
    /// One step of a length [s].
    void step(double length) {
        workspace_.step.h = length;
        OneStep controller{step_method_->step()};
        executor_.run(graph_, &workspace_, controller);
        workspace_.step.time += length;
    }
    void steps(double length, long count) {
        for (long k = 0; k < count; ++k) step(length);
    }

    [[nodiscard]] double time() const { return workspace_.step.time; }
    [[nodiscard]] std::vector<double> state() const {
        const double* y = workspace_.state();
        return {y, y + workspace_.layout().size()};
    }
    [[nodiscard]] const std::vector<model::Phase>& phases() const { return workspace_.tips.phases; }
    [[nodiscard]] const EnergyAccount& energies() { return workspace_.energy.count(); }
    [[nodiscard]] const model::Variator& variator() const { return workspace_.variator; }
    [[nodiscard]] StepMethod& method() { return *step_method_; }
    [[nodiscard]] const engine::TaskGraph& graph() const { return graph_; }

private:
    struct OneStep final : engine::Controller {
        explicit OneStep(CycleSequence step) : cycles(std::move(step)) {}
        [[nodiscard]] int next() noexcept override { return cycles.next(); }
        CycleSequence cycles;
    };

    const Method method_{"leapfrog-rigid"};
    Workspace workspace_;
    std::unique_ptr<StepMethod> step_method_;
    engine::TaskGraph graph_;
    engine::Serial executor_;
};

[[nodiscard]] inline double total(const auto& values) { return std::accumulate(values.begin(), values.end(), 0.0); }
[[nodiscard]] inline double lost(const EnergyAccount& from, const EnergyAccount& to) { return total(to.lost) - total(from.lost); }
/// Change of stored energy minus works plus losses [J]: zero but for errors of the integration.
[[nodiscard]] inline double residual(const EnergyAccount& from, const EnergyAccount& to) {
    return (to.stored - from.stored) - (total(to.work) - total(from.work)) + lost(from, to);
}

}  // namespace cvtflow::tasks::test

namespace cvtflow::tasks {
namespace {

using namespace model;
using test::lost, test::residual, test::RigidRun;

/// Some time after the machine's geometric start.
void settle(RigidRun& run, const Parameters& p, double until, double step) {
    const double begin = -p.start.settling_time;
    run.start(begin, start_state(p).state.data());
    run.steps(step, std::lround((until - begin) / step));
}

/// The state of the baseline machine some time after its geometric start, on the slow motion that follows the start's jolt.
std::vector<double> moving_state(const Parameters& p, double until) {
    RigidRun run(p);
    settle(run, p, until, 1e-6);
    return run.state();
}

std::vector<double> stepped(const Parameters& p, const std::vector<double>& from, double begin, double span, long steps) {
    RigidRun run(p);
    run.start(begin, from.data());
    run.steps(span / static_cast<double>(steps), steps);
    return run.state();
}

/// The classical fourth-order method on the same forces with friction as it is.
std::vector<double> by_runge_kutta(const Variator& variator, std::vector<double> y, double begin, double span, long steps) {
    EvaluationScratch scratch(variator.layout());
    const std::vector<Phase> phases(static_cast<std::size_t>(tips_per_link * variator.layout().links), Phase::touching);
    const double h = span / static_cast<double>(steps);
    std::vector<double> k[4], there(y.size());
    for (auto& slope : k) slope.resize(y.size());
    for (long step = 0; step < steps; ++step) {
        const double t = begin + static_cast<double>(step) * h;
        const double share[] = {0.0, 0.5, 0.5, 1.0};
        for (int stage = 0; stage < 4; ++stage) {
            for (std::size_t i = 0; i < y.size(); ++i) there[i] = stage == 0 ? y[i] : y[i] + share[stage] * h * k[stage - 1][i];
            right_hand_side(variator, t + share[stage] * h, there.data(), phases.data(), k[stage].data(), scratch);
        }
        for (std::size_t i = 0; i < y.size(); ++i) y[i] += h / 6.0 * (k[0][i] + 2.0 * k[1][i] + 2.0 * k[2][i] + k[3][i]);
    }
    return y;
}

/// Difference of the pins' places in the plane, root mean square [m].
double distance(const ChainLayout& at, const std::vector<double>& a, const std::vector<double>& b) {
    double square = 0.0;
    for (int pin = 0; pin < at.links; ++pin) {
        for (const int k : {0, 1}) {
            const std::size_t place = static_cast<std::size_t>(at.link_begin(pin) + rigid_place(at, k));
            square += (a[place] - b[place]) * (a[place] - b[place]);
        }
    }
    return std::sqrt(square / at.links);
}

TEST(RigidLeapfrog, ConvergesToTheSolutionOfItsForces) {
    const Parameters p = oracle::with_rigid_pins({});
    const Variator model(p);
    const double begin = -50e-3, span = 40e-6;
    const std::vector<double> start = moving_state(p, begin);
    const std::vector<double> exact = by_runge_kutta(model, start, begin, span, 800);
    const double moved = distance(model.layout(), start, exact);
    ASSERT_GT(moved, 3e-4);
    double before = moved;
    for (const long steps : {10, 20, 40, 80, 160}) {
        const double error = distance(model.layout(), stepped(p, start, begin, span, steps), exact);
        RecordProperty("error_" + std::to_string(steps), std::to_string(1e9 * error) + " nm");
        EXPECT_LT(error, 1e-4 * moved) << steps;
        EXPECT_LT(error, before) << steps << " steps: first order at least";
        before = 0.6 * error;
    }
}

/// Machines with different work for the step.
std::vector<oracle::Case> stepped_machines() {
    const Parameters base = oracle::with_rigid_pins({});
    std::vector<oracle::Case> cases{{"baseline", base},
                                    {"smoothed law", base},
                                    {"rigid pulleys", base},
                                    {"mixed pitches, driven by torque", base},
                                    {"underdrive under ratio control", base}};
    cases[1].parameters.detail.friction = FrictionLaw::smoothed;
    cases[2].parameters.detail.pulleys = PulleyDetail::rigid;
    cases[3].parameters.chain.pitch = {8.12e-3, 8.0e-3};
    cases[3].parameters.drive.mode = DriveMode::torque;
    cases[3].parameters.drive.torque = TimeTable(150.0);
    cases[4].parameters.start.ratio = 2.4;
    cases[4].parameters.clamping.driving = TimeTable(23.6e3);
    cases[4].parameters.control.enabled = true;
    cases[4].parameters.control.ratio = TimeTable(2.4);
    return cases;
}

/// Stored energy changes by works minus losses: within 1e-3 of the losses of 20 ms after the jolt of the start.
TEST(RigidLeapfrog, EnergyBalanceCloses) {
    for (const oracle::Case& one : stepped_machines()) {
        SCOPED_TRACE(one.name);
        const Parameters& p = one.parameters;
        RigidRun run(p);
        settle(run, p, -40e-3, 5e-6);
        const EnergyAccount from = run.energies();
        run.steps(5e-6, 4000);
        EXPECT_GT(lost(from, run.energies()), 2.0);
        EXPECT_LT(std::abs(residual(from, run.energies())), 1e-3 * lost(from, run.energies()));
    }
}

/// The machine of the scene `tiny`.
Parameters tiny_machine() {
    Parameters p = oracle::with_rigid_pins({});
    p.chain.pins = 24;
    p.pulley.centre_distance = 47e-3;
    p.pulley.arc_position = 16.06e-3;
    p.pulley.innermost = 10e-3;
    p.pulley.outermost = 22e-3;
    p.load.torque = TimeTable(12.0);
    p.clamping.driving = TimeTable(7.7e3);
    p.clamping.driven = TimeTable(5.7e3);
    p.start.settling_time = 10e-3;
    p.start.ramp_time = 5e-3;
    return p;
}

/// Links of a small machine's geometric start are out of balance: the energy of that jolt is counted as the leapfrog has it, ½ v·M v' of
/// the velocities around an instant. With ½ v·M v a fifth of the losses would be missing.
TEST(RigidLeapfrog, EnergyBalanceClosesOverTheJoltOfAStart) {
    const Parameters p = tiny_machine();
    RigidRun run(p);
    run.start(-p.start.settling_time, start_state(p).state.data());
    const EnergyAccount from = run.energies();
    run.steps(5e-6, 400);
    EXPECT_GT(lost(from, run.energies()), 0.1);
    EXPECT_LT(std::abs(residual(from, run.energies())), 0.01 * lost(from, run.energies()));
}

/// The torque of the strands' tensions is the load's, and the chain stays between the sheaves' flanks.
TEST(RigidLeapfrog, BaselineCarriesItsLoad) {
    const Parameters p = oracle::with_rigid_pins({});
    RigidRun run(p);
    settle(run, p, -20e-3, 5e-6);
    Observer observer(run.variator());
    double torque = 0.0, slip = 0.0;
    constexpr int outputs = 400;
    for (int k = 0; k < outputs; ++k) {
        run.steps(5e-6, 10);
        const Observation& now = observer.observe(run.time(), run.state().data(), run.phases().data());
        torque += (now.tight - now.slack) * now.radius[1] / outputs;
        slip += now.slip / outputs;
    }
    EXPECT_NEAR(torque, 150.0, 0.02 * 150.0);
    EXPECT_GT(slip, 1e-3);
    EXPECT_LT(slip, 1e-2);
}

/// The sweep and an evaluation leave out pins that are certainly free; a probe finds the depth of every tip.
TEST(RigidLeapfrog, PressesEveryTipThatIsInsideItsSheave) {
    for (const double ratio : {0.45, 1.0, 2.3}) {
        Parameters p = oracle::with_rigid_pins({});
        p.start.ratio = ratio;
        const Variator model(p);
        RigidRun run(p);
        settle(run, p, -p.start.settling_time + 8e-3, 4e-6);
        const std::vector<double> y = run.state();
        SheaveMotion sheaves[4];
        model.pulleys().motions(y.data() + model.layout().pulley_begin(), sheaves);
        const RigidInstant now = model.chain().rigid()->evaluate(y.data(), sheaves);
        int inside = 0;
        for (int tip = 0; tip < tips_per_link * model.layout().links; ++tip) {
            const int link = tip / tips_per_link, of_link = tip % tips_per_link;
            NeighbourWindow near;
            TipProbe probe;
            model.chain().probe(near.of(model.layout(), y.data(), link), sheaves, false, probe);
            const double depth = probe.depth[of_link];
            if (std::abs(depth) < 1e-12) continue;  // within rounding
            inside += depth > 0.0;
            EXPECT_EQ(run.phases()[static_cast<std::size_t>(tip)] == Phase::touching, depth > 0.0)
                << "ratio " << ratio << ", link " << link << ", tip " << of_link;
            EXPECT_EQ(now.of_tip(now.columns.tip.normal, link, of_link) > 0.0, depth > 0.0) << "ratio " << ratio << ", link " << link;
        }
        EXPECT_GT(inside, model.layout().links) << "at ratio " << ratio;
    }
}

/// The graph without the order of a pair of tasks.
engine::TaskGraph without(const engine::TaskGraph& whole, int before, int after) {
    engine::TaskGraph graph;
    for (int task = 0; task < whole.size(); ++task) graph.add(whole.task(task));
    for (int task = 0; task < whole.size(); ++task) {
        for (const int successor : whole.successors(task)) {
            if (task != before || successor != after) graph.order(task, successor);
        }
    }
    graph.freeze();
    return graph;
}

TEST(RigidLeapfrog, TasksDoNotRaceAndEveryOrderIsNeeded) {
    const RigidRun run(oracle::with_rigid_pins(oracle::small_scene()));
    EXPECT_TRUE(engine::race_check(run.graph()).empty());
    int orders = 0;
    for (int task = 0; task < run.graph().size(); ++task) {
        for (const int successor : run.graph().successors(task)) {
            ++orders;
            EXPECT_FALSE(engine::race_check(without(run.graph(), task, successor)).empty()) << run.graph().task(task).name;
        }
    }
    EXPECT_EQ(orders, 3);
}

TEST(RigidLeapfrog, StepsAllocateNothing) {
    const Parameters p = oracle::with_rigid_pins(oracle::small_scene());
    RigidRun run(p);
    settle(run, p, -p.start.settling_time + 2e-6, 2e-6);
    const long before = engine::test::allocation_count();
    run.steps(2e-6, 100);
    EXPECT_EQ(engine::test::allocation_count(), before);
}

/// Steps of the pins alone between resting sheaves.
TEST(RigidLeapfrog, EveryInstructionSetHasTheSameBits) {
    const Parameters p = oracle::with_rigid_pins({});
    const model::StartState start = start_state(p);
    std::vector<std::vector<double>> ends;
    for (const Isa isa : usable_isas()) {
        const Variator variator(p, isa);
        RigidState pins(variator.chain().rigid()->model());
        pins.read(start.state.data());
        SheaveMotion sheaves[4];
        variator.pulleys().motions(pins.tail.data(), sheaves);
        pins.model.accelerate(sheaves, pins.columns, pins.forces);
        for (int step = 0; step < 200; ++step) {
            pins.model.kernels().drift(2e-6, pins.columns);
            pins.model.accelerate(sheaves, {2e-6}, pins.columns, pins.forces);
            static_cast<void>(pins.model.kernels().kick(pins.model.coefficients(), 2e-6, pins.columns));
        }
        ends.push_back(start.state);
        pins.write(ends.back().data());
        EXPECT_EQ(std::memcmp(ends.front().data(), ends.back().data(), sizeof(double) * ends.back().size()), 0) << name_of(isa);
        EXPECT_NE(ends.back(), start.state);
    }
}

TEST(RigidLeapfrog, ResumesBitForBitFromWhatItSaves) {
    const Parameters p = oracle::with_rigid_pins({});
    RigidRun one(p), other(p);
    settle(one, p, -p.start.settling_time + 5e-3, 5e-6);
    other.start(one.time(), one.state().data());
    std::vector<double> memory, after[2];
    one.method().save(memory);
    other.method().load(memory);
    for (RigidRun* run : {&one, &other}) {
        run->step(2e-6);  // another length: velocities are advanced by what was saved
        run->steps(5e-6, 100);
        run->method().save(after[run == &one ? 0 : 1]);
    }
    EXPECT_EQ(std::memcmp(after[0].data(), after[1].data(), sizeof(double) * after[0].size()), 0);
    EXPECT_EQ(one.phases(), other.phases());
    memory.pop_back();
    EXPECT_THROW(other.method().load(memory), std::invalid_argument);
}

/// A step of another length shifts the lead of the velocities, whose error is of the order of the change of acceleration over a step: less
/// than 1e-5 of the way.
TEST(RigidLeapfrog, StepsOfDifferentLengthsEndWhereEqualOnesDo) {
    const Parameters p = oracle::with_rigid_pins({});
    const Variator model(p);
    const double begin = -50e-3;
    const std::vector<double> from = moving_state(p, begin);
    RigidRun mixed(p);
    mixed.start(begin, from.data());
    for (int k = 0; k < 20; ++k) {
        for (const double step : {0.5e-6, 1.5e-6}) mixed.step(step);
    }
    const std::vector<double> equal = stepped(p, from, begin, 40e-6, 40);
    EXPECT_LT(distance(model.layout(), mixed.state(), equal), 1e-5 * distance(model.layout(), from, equal));
}

const engine::Cancellation never_cancelled;

/// The scene `tiny` with rigid pins at 2 us: 5 us do not resolve the jolt of so small a machine.
Scene rigid_tiny(const std::vector<std::string>& settings = {}) {
    Scene scene = ready_tiny();
    apply_detail(scene, "rigid");
    set_values(scene,
               std::vector<std::string>{"run.method=leapfrog-rigid", "run.step=2 us", "start.settling_time=2 ms", "start.ramp_time=1 ms"});
    set_values(scene, settings);
    return scene;
}

void settle_tiny(Simulation& simulation) {
    SilentObserver silent;
    ASSERT_FALSE(simulation.advance({.until = 0.0}, silent, never_cancelled));
    ASSERT_EQ(simulation.time(), 0.0);
}

TEST(RigidRuns, DoesNotDependOnWhereCallsEnd) {
    Simulation whole(rigid_tiny()), parts(rigid_tiny());
    SilentObserver silent;
    for (Simulation* simulation : {&whole, &parts}) settle_tiny(*simulation);
    ASSERT_FALSE(whole.advance({.until = 2e-3}, silent, never_cancelled));
    for (int k = 1; k <= 8; ++k) ASSERT_FALSE(parts.advance({.until = 0.25e-3 * k}, silent, never_cancelled));
    EXPECT_EQ(whole.hash(), parts.hash());
    EXPECT_EQ(whole.counters().steps, parts.counters().steps);
}

TEST(RigidRuns, ResumesBitForBitInAnotherSimulation) {
    Simulation one(rigid_tiny());
    settle_tiny(one);
    SilentObserver silent;
    ASSERT_FALSE(one.advance({.until = 1e-3}, silent, never_cancelled));
    Simulation other(rigid_tiny());
    other.restore(one.integration_state());
    for (Simulation* simulation : {&one, &other}) ASSERT_FALSE(simulation->advance({.until = 2e-3}, silent, never_cancelled));
    EXPECT_EQ(one.integration_state().hash(), other.integration_state().hash());
}

/// Inputs that change at points of their tables cut steps; both laws, pulleys of all kinds, control and two pitches.
TEST(RigidRuns, FinishesWhatScenesHaveWithAClosedBalance) {
    const std::vector<std::vector<std::string>> scenes{
        {"load.torque=[[\"0 ms\", \"12 N*m\"], [\"1.0013 ms\", \"12 N*m\"], [\"2.3 ms\", \"6 N*m\"]]"},
        {"detail.friction=smoothed"},
        {"detail.pulleys=rigid"},
        {"control.enabled=true", "control.ratio=1.02"},
        {"chain.pitch=[\"8.12 mm\", \"8.0 mm\"]"},
        {"drive.mode=torque", "drive.torque=12 N*m"},
        {"start.layout=ring", "detail.pulleys=absent"}};
    for (const std::vector<std::string>& settings : scenes) {
        SCOPED_TRACE(settings.front());
        Simulation simulation(rigid_tiny(settings));
        SilentObserver silent;
        if (simulation.needs_settling()) settle_tiny(simulation);
        const Fault fault = simulation.advance({.until = 4e-3}, silent, never_cancelled);
        EXPECT_FALSE(fault) << fault.message();
        EXPECT_LE(simulation.balance_error_ratio(), 1.0);
    }
}

/// The ledger of the state equals the sums of the energy watch: both add up each step.
TEST(RigidRuns, WritesItsLossesIntoTheLedger) {
    Scene scene = rigid_tiny();
    scene.parameters.ledger = true;
    Simulation simulation(scene);
    settle_tiny(simulation);
    const model::ChainLayout& at = simulation.workspace().layout();
    const auto ledger = [&] {
        double sum = 0.0;
        for (int k = 0; k < model::loss_kinds; ++k) sum += simulation.workspace().state()[at.ledger_begin() + k];
        return sum;
    };
    const double before = ledger();
    SilentObserver silent;
    ASSERT_FALSE(simulation.advance({.until = 2e-3}, silent, never_cancelled));
    const double lost = simulation.workspace().energy.sums(simulation.time()).lost();
    EXPECT_GT(lost, 0.0);
    EXPECT_NEAR(ledger() - before, lost, 1e-12 * lost);
}

TEST(RigidRuns, NamesTimeAndPinOfAFault) {
    Simulation simulation(rigid_tiny({"tip.deepest=1 um"}));
    SilentObserver silent;
    const Fault fault = simulation.advance({.until = 0.0}, silent, never_cancelled);
    EXPECT_EQ(fault.kind, FaultKind::penetration);
    EXPECT_TRUE(fault.pin.has_value());
    EXPECT_GT(fault.value, 1e-6);
    EXPECT_LT(fault.time, 0.0);
}

TEST(RigidRuns, FindsStepsThatAreTooLong) {
    Simulation simulation(rigid_tiny({"run.step=9 us", "run.output_interval=90 us"}));
    SilentObserver silent;
    const Fault fault = simulation.advance({.until = 0.0}, silent, never_cancelled);
    EXPECT_TRUE(fault || simulation.balance_error_ratio() > 1.0);
}

TEST(RigidRuns, AllocatesNothingBetweenTheStartAndTheEndOfARun) {
    Simulation simulation(rigid_tiny({"run.step=4 us", "run.output_interval=20 us"}));
    settle_tiny(simulation);
    struct Counter final : RunObserver {
        void output(double, const Workspace&, const Counters& counters) override {
            if (counters.steps == 5) before = engine::test::allocation_count();
            if (counters.steps == 200) after = engine::test::allocation_count();
        }
        void transition(const TransitionRecord&) override {}
        long before = -1, after = -2;
    } counter;
    ASSERT_FALSE(simulation.advance({.until = 2e-3}, counter, never_cancelled));
    EXPECT_EQ(counter.before, counter.after);
}

/// The step runs on one thread if the scene leaves it open; it cannot be cut into segments.
TEST(RigidRuns, IsOneSegment) {
    Schedule two;
    two.executor = "flow";
    two.segments = two.threads = 2;
    EXPECT_THROW(Simulation(rigid_tiny(), two), SimulationError);
    EXPECT_THROW(rigid_tiny({"run.segments=2"}), SceneError);
    EXPECT_THROW(rigid_tiny({"run.schedule=flow"}), SceneError);
    EXPECT_TRUE(violations(rigid_tiny({"run.schedule=auto", "run.threads=4"})).empty());
}

}  // namespace
}  // namespace cvtflow::tasks
