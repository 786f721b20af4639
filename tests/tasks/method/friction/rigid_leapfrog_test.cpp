/// Leapfrog of rigid pins: accuracy, energy, contacts, and as a method of a run: nothing depends on where calls end, faults have a place.

#include "tasks/method/friction/rigid_leapfrog.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <vector>

#include "model/observe/observation.hpp"
#include "model/start/start_state.hpp"
#include "tasks/batch/sweep/sweep.hpp"
#include "tasks/method/method.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/step/step_graph.hpp"
#include "tasks/step/step_method.hpp"
#include "tests/claims/rig_fixture.hpp"
#include "tests/engine/graph/graph_fixture.hpp"
#include "tests/oracle/oracle_cases.hpp"
#include "tests/tasks/run/settled_run_fixture.hpp"

namespace cvtflow::tasks {
namespace {

using namespace model;
using claims::Rig;

/// The machine some time after its geometric start, on the slow motion that follows the start's jolt.
Rig moving(const Parameters& p, double until, double step) {
    Rig rig(p, 1, "leapfrog-rigid");
    EXPECT_FALSE(rig.run({-p.start.settling_time, until, step, until + p.start.settling_time}));
    return rig;
}

/// A state of it after a span in that many steps.
std::vector<double> stepped(const Parameters& p, const Rig& from, const char* method, double span, long steps) {
    Rig rig(p, from.state_copy(), from.phases(), 1, method);
    EXPECT_FALSE(rig.run({from.time(), from.time() + span, span / static_cast<double>(steps), span}));
    return rig.state_copy();
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

/// The solution is that of the classical fourth-order method on the same forces with friction as it is, to what floats leave: a link's
/// length of 8 mm is rounded by 2e-10 m, its force by 0.05 N, and that moves a pin by 2e-9 m at most.
TEST(RigidLeapfrog, ConvergesToTheSolutionOfItsForces) {
    const Parameters p = oracle::with_rigid_pins({});
    const double span = 40e-6, rounding = 2e-9;  // [s], [m]
    const Rig start = moving(p, -50e-3, 1e-6);
    const ChainLayout& at = start.variator().layout();
    const std::vector<double> exact = stepped(p, start, "rk4", span, 800);
    const double moved = distance(at, start.state_copy(), exact);
    ASSERT_GT(moved, 3e-4);
    double before = moved;
    for (const long steps : {10, 20, 40, 80, 160}) {
        const double error = distance(at, stepped(p, start, "leapfrog-rigid", span, steps), exact);
        RecordProperty("error_" + std::to_string(steps), std::to_string(1e9 * error) + " nm");
        EXPECT_LT(error, 1e-4 * moved) << steps;
        EXPECT_LT(error, std::max(before, rounding)) << steps << " steps: first order at least";
        before = 0.6 * error;
    }
}

/// Links of a small machine's geometric start are out of balance: the energy of that jolt is counted as the leapfrog has it, ½ v·M v' of
/// the velocities around an instant. With ½ v·M v a fifth of the losses would be missing.
TEST(RigidLeapfrog, EnergyBalanceClosesOverTheJoltOfAStart) {
    Parameters p = oracle::with_rigid_pins(tiny_parameters());
    p.start.settling_time = 10e-3;
    p.start.ramp_time = 5e-3;
    Rig rig = moving(p, -8e-3, 5e-6);
    const EnergyBalance balance = rig.workspace().energy.balance();
    EXPECT_GT(balance.loss, 0.1);
    EXPECT_LT(std::abs(balance.residual()), 0.01 * balance.loss);
}

/// The sweep and an evaluation leave out pins that are certainly free; a probe finds the depth of every tip.
TEST(RigidLeapfrog, PressesEveryTipThatIsInsideItsSheave) {
    for (const double ratio : {0.45, 1.0, 2.3}) {
        Parameters p = oracle::with_rigid_pins({});
        p.start.ratio = ratio;
        const Rig run = moving(p, -p.start.settling_time + 8e-3, 4e-6);
        const Variator& model = run.variator();
        const std::vector<double> y = run.state_copy();
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
            EXPECT_EQ(std::max(0.0, now.of_tip(now.columns.tip.depth, link, of_link)), std::max(0.0, depth)) << ratio << ", link " << link;
        }
        EXPECT_GT(inside, model.layout().links) << "at ratio " << ratio;
    }
}

TEST(RigidLeapfrog, TasksDoNotRaceAndEveryOrderIsNeeded) {
    const Parameters p = oracle::with_rigid_pins(oracle::small_scene());
    Workspace workspace(p, Method("leapfrog-rigid").plan(), Partition::equal(p.chain.pins, 1));
    const auto method = Method("leapfrog-rigid").make(workspace);
    const engine::TaskGraph graph = step_graph(workspace, {}, method.get());
    EXPECT_TRUE(engine::race_check(graph).empty());
    int orders = 0;
    for (int task = 0; task < graph.size(); ++task) {
        for (const int successor : graph.successors(task)) {
            ++orders;
            EXPECT_FALSE(engine::race_check(engine::test::without_edge(graph, task, successor)).empty()) << graph.task(task).name;
        }
    }
    EXPECT_EQ(orders, 4);
}

/// Steps of the pins alone between resting sheaves.
TEST(RigidLeapfrog, EveryInstructionSetHasTheSameBits) {
    const Parameters p = oracle::with_rigid_pins({});
    const model::StartState start = start_state(p);
    std::vector<std::vector<double>> ends;
    for (const Isa isa : usable_isas()) {
        const Variator variator(p, isa);
        RigidState pins(variator.chain().rigid()->model());
        SheaveMotion sheaves[4];
        variator.pulleys().motions(start.state.data() + variator.layout().pulley_begin(), sheaves);
        pins.read(start.state.data(), variator.chain().rigid()->evaluate(start.state.data(), sheaves));
        const RigidKernels<float>& kernel = pins.model.kernels<float>();
        const RigidCoefficients& c = pins.model.coefficients();
        const RigidKick kick{2e-6};
        Account& account = pins.forces.account;
        for (int step = 0; step < 200; ++step) {
            kernel.links(c, kick, pins.columns, account);
            kernel.press(c, sheaves, kick, pins.columns);
            kernel.plates(c, kick, pins.columns, account);
            kernel.rub(c, pins.columns, pins.forces.reaction, account);
            kernel.kick(c, kick, pins.columns, account);
        }
        ends.push_back(start.state);
        pins.write(ends.back().data());
        EXPECT_EQ(std::memcmp(ends.front().data(), ends.back().data(), sizeof(double) * ends.back().size()), 0) << name_of(isa);
        EXPECT_NE(ends.back(), start.state);
    }
}

/// A step of another length shifts the lead of the velocities, whose error is of the order of the change of acceleration over a step: less
/// than 1e-5 of the way.
TEST(RigidLeapfrog, StepsOfDifferentLengthsEndWhereEqualOnesDo) {
    const Parameters p = oracle::with_rigid_pins({});
    const Rig from = moving(p, 0.0, 1e-6);
    std::vector<double> points{0.0};
    for (int k = 0; k < 20; ++k) points.push_back(1e-6 * (2.0 * k + 0.3));  // of the load, which does not change there
    Parameters cut = p;
    cut.load.torque = TimeTable(points, std::vector<double>(points.size(), p.load.torque.at(0.0)));
    Rig mixed(cut, from.state_copy(), from.phases(), 1, "leapfrog-rigid");
    EXPECT_FALSE(mixed.run({0.0, 40e-6, 1e-6, 40e-6}));
    EXPECT_EQ(mixed.counters().steps, 60);
    const std::vector<double> equal = stepped(p, from, "leapfrog-rigid", 40e-6, 40);
    const ChainLayout& at = from.variator().layout();
    EXPECT_LT(distance(at, mixed.state_copy(), equal), 1e-5 * distance(at, from.state_copy(), equal));
}

/// The scene `tiny` with rigid pins at 2 us: 7 us do not resolve the jolt of so small a machine.
Scene rigid_tiny(const std::vector<std::string>& settings = {}) {
    return scene_of("tiny", "rigid", {"run.method=leapfrog-rigid", "run.step=2 us", "start.settling_time=2 ms", "start.ramp_time=1 ms"},
                    settings);
}

TEST(RigidRuns, ContinueBitForBitInAnotherSimulation) { expect_continued(rigid_tiny(), 1e-3, 2e-3); }

/// Inputs that change at points of their tables cut steps; both laws, pulleys of all kinds, control and two pitches. Stored energy changes
/// by works minus losses: within 1e-3 of the losses behind the jolt of the start. The ledger of the state equals the sums of the energy
/// watch: both add up each step.
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
        Scene scene = rigid_tiny(settings);
        scene.parameters.ledger = true;
        Simulation simulation(scene);
        const EnergyLedger& energy = simulation.workspace().energy;
        const auto ledger = [&] {
            const double* losses = simulation.workspace().state() + simulation.workspace().layout().ledger_begin();
            return std::accumulate(losses, losses + model::loss_kinds, 0.0);
        };
        const bool settles = simulation.needs_settling();
        settle_and_go(simulation, settles ? 0.0 : 1e-3);
        const double before = ledger(), lost = energy.sums(simulation.time()).lost();
        const auto from = energy.mark();
        settle_and_go(simulation, 4e-3);
        EXPECT_LE(simulation.balance_error_ratio(), 1.0);
        const EnergyBalance balance = energy.balance(from);
        EXPECT_TRUE(!settles || std::abs(balance.residual()) < 1e-3 * balance.loss) << balance.residual() << " of " << balance.loss;
        const double later = energy.sums(simulation.time()).lost() - lost;
        EXPECT_NEAR(ledger() - before, later, 1e-12 * energy.sums(simulation.time()).lost());
        EXPECT_TRUE(!settles || later > 0.0);
    }
}

TEST(RigidRuns, NamesTimeAndPinOfAFault) {
    Simulation simulation(rigid_tiny({"tip.deepest=1 um"}));
    const Fault fault = go(simulation, {.until = 0.0});
    EXPECT_EQ(fault.kind, FaultKind::penetration);
    EXPECT_TRUE(fault.pin.has_value());
    EXPECT_GT(fault.value, 1e-6);
    EXPECT_LT(fault.time, 0.0);
}

TEST(RigidRuns, FindsStepsThatAreTooLong) {
    Simulation simulation(rigid_tiny({"run.step=15 us", "run.output_interval=90 us"}));
    const Fault fault = go(simulation, {.until = 0.0});
    EXPECT_TRUE(fault || simulation.balance_error_ratio() > 1.0);
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
