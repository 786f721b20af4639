#include "model/rigid/rigid_stepper.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "model/observe/observation.hpp"
#include "model/start/start_state.hpp"
#include "tests/engine/allocation_fixture.hpp"
#include "tests/model/rigid/plain_pins_fixture.hpp"
#include "tests/oracle/oracle_cases.hpp"

namespace cvtflow::model {
namespace {

/// Steps of one length from a time on.
void run(RigidStepper& stepper, double begin, double step, long steps) {
    for (long k = 0; k < steps; ++k) stepper.step(begin + static_cast<double>(k) * step, step);
}

/// A stepper some time after the machine's geometric start.
void settle(RigidStepper& stepper, const Parameters& p, double until, double step) {
    const double begin = -p.start.settling_time;
    stepper.start(begin, start_state(p).state.data());
    run(stepper, begin, step, std::lround((until - begin) / step));
}

/// The state of the baseline machine some time after its geometric start, on the slow motion that follows the start's jolt.
std::vector<double> moving_state(const Variator& variator, const Parameters& p, double until) {
    RigidStepper stepper(variator);
    settle(stepper, p, until, 1e-6);
    std::vector<double> y(static_cast<std::size_t>(variator.layout().size()));
    stepper.state(y.data());
    return y;
}

std::vector<double> stepped(const Variator& variator, const std::vector<double>& from, double begin, double span, long steps) {
    RigidStepper stepper(variator);
    stepper.start(begin, from.data());
    run(stepper, begin, span / static_cast<double>(steps), steps);
    std::vector<double> y(from.size());
    stepper.state(y.data());
    return y;
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

TEST(RigidStepper, ConvergesToTheSolutionOfItsForces) {
    const Parameters p = test::with_rigid_pins({});
    const Variator model(p);
    const double begin = -50e-3, span = 40e-6;
    const std::vector<double> start = moving_state(model, p, begin);
    const std::vector<double> exact = by_runge_kutta(model, start, begin, span, 800);
    const double moved = distance(model.layout(), start, exact);
    ASSERT_GT(moved, 3e-4);
    double before = moved;
    for (const long steps : {10, 20, 40, 80, 160}) {
        const double error = distance(model.layout(), stepped(model, start, begin, span, steps), exact);
        RecordProperty("error_" + std::to_string(steps), std::to_string(1e9 * error) + " nm");
        EXPECT_LT(error, 1e-4 * moved) << steps;
        EXPECT_LT(error, before) << steps << " steps: first order at least";
        before = 0.6 * error;
    }
}

/// Machines that differ in what the step has to do.
std::vector<oracle::Case> stepped_machines() {
    const Parameters base = test::with_rigid_pins({});
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

/// What is stored changes by works minus losses: within 1e-3 of the losses of 20 ms after the jolt of the start.
TEST(RigidStepper, EnergyBalanceCloses) {
    for (const oracle::Case& one : stepped_machines()) {
        SCOPED_TRACE(one.name);
        const Parameters& p = one.parameters;
        const Variator model(p);
        RigidStepper stepper(model);
        settle(stepper, p, -40e-3, 5e-6);
        const RigidBalance from = stepper.balance();
        run(stepper, -40e-3, 5e-6, 4000);
        const RigidBalance to = stepper.balance();
        const double lost = to.losses() - from.losses();
        EXPECT_GT(lost, 2.0);
        EXPECT_LT(std::abs(residual(from, to)), 1e-3 * lost);
    }
}

/// The machine of the scene `tiny`.
Parameters tiny_machine() {
    Parameters p = test::with_rigid_pins({});
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
TEST(RigidStepper, EnergyBalanceClosesOverTheJoltOfAStart) {
    const Parameters p = tiny_machine();
    const Variator model(p);
    RigidStepper stepper(model);
    const double begin = -p.start.settling_time;
    stepper.start(begin, start_state(p).state.data());
    const RigidBalance from = stepper.balance();
    run(stepper, begin, 5e-6, 400);
    const double lost = stepper.balance().losses() - from.losses();
    EXPECT_GT(lost, 0.1);
    EXPECT_LT(std::abs(residual(from, stepper.balance())), 0.01 * lost);
}

/// The torque of the strands' tensions is the load's, and the chain stays between the sheaves' flanks.
TEST(RigidStepper, BaselineCarriesItsLoad) {
    const Parameters p = test::with_rigid_pins({});
    const Variator model(p);
    RigidStepper stepper(model);
    settle(stepper, p, -20e-3, 5e-6);
    Observer observer(model);
    std::vector<double> y(static_cast<std::size_t>(model.layout().size()));
    const ChainLayout& at = model.layout();
    double torque = 0.0, slip = 0.0;
    constexpr int outputs = 400;
    for (int k = 0; k < outputs; ++k) {
        run(stepper, -20e-3 + k * 50e-6, 5e-6, 10);
        stepper.state(y.data());
        std::vector<Phase> phases;
        for (int tip = 0; tip < tips_per_link * at.links; ++tip)
            phases.push_back(stepper.touches(tip / tips_per_link, tip % tips_per_link) ? Phase::touching : Phase::free);
        const Observation& now = observer.observe(stepper.time(), y.data(), phases.data());
        torque += (now.tight - now.slack) * now.radius[1] / outputs;
        slip += now.slip / outputs;
    }
    EXPECT_NEAR(torque, 150.0, 0.02 * 150.0);
    EXPECT_GT(slip, 1e-3);
    EXPECT_LT(slip, 1e-2);
}

/// The sweep and an evaluation leave out pins that are certainly free; a probe finds the depth of every tip.
TEST(RigidStepper, PressesEveryTipThatIsInsideItsSheave) {
    for (const double ratio : {0.45, 1.0, 2.3}) {
        Parameters p = test::with_rigid_pins({});
        p.start.ratio = ratio;
        const Variator model(p);
        RigidStepper stepper(model);
        settle(stepper, p, -p.start.settling_time + 8e-3, 4e-6);
        std::vector<double> y(static_cast<std::size_t>(model.layout().size()));
        stepper.state(y.data());
        SheaveMotion sheaves[4];
        model.pulleys().motions(y.data() + model.layout().pulley_begin(), sheaves);
        const RigidChain& chain = *model.chain().rigid();
        chain.evaluate(y.data(), sheaves);
        int inside = 0;
        for (int tip = 0; tip < tips_per_link * model.layout().links; ++tip) {
            const int link = tip / tips_per_link, of_link = tip % tips_per_link;
            NeighbourWindow near;
            TipProbe probe;
            model.chain().probe(near.of(model.layout(), y.data(), link), sheaves, false, probe);
            const double depth = probe.depth[of_link];
            if (std::abs(depth) < 1e-12) continue;  // within rounding
            inside += depth > 0.0;
            EXPECT_EQ(stepper.touches(link, of_link), depth > 0.0) << "ratio " << ratio << ", link " << link << ", tip " << of_link;
            EXPECT_EQ(chain.of_tip(Column::tip_normal, link, of_link) > 0.0, depth > 0.0) << "ratio " << ratio << ", link " << link;
        }
        EXPECT_GT(inside, model.layout().links) << "at ratio " << ratio;
    }
}

TEST(RigidStepper, StepsAllocateNothing) {
    const Parameters p = test::with_rigid_pins(oracle::small_scene());
    const Variator model(p);
    RigidStepper stepper(model);
    settle(stepper, p, -p.start.settling_time + 2e-6, 2e-6);
    const long before = engine::test::allocation_count();
    run(stepper, stepper.time(), 2e-6, 100);
    EXPECT_EQ(engine::test::allocation_count(), before);
}

TEST(RigidStepper, EveryInstructionSetHasTheSameBits) {
    const Parameters p = test::with_rigid_pins({});
    std::vector<std::vector<double>> ends;
    for (const Isa isa : usable_isas()) {
        const Variator model(p, isa);
        ends.push_back(stepped(model, start_state(p).state, -p.start.settling_time, 5e-3, 1000));
        EXPECT_EQ(std::memcmp(ends.front().data(), ends.back().data(), sizeof(double) * ends.back().size()), 0) << name_of(isa);
    }
}

TEST(RigidStepper, ResumesBitForBitFromWhatItSaves) {
    const Parameters p = test::with_rigid_pins({});
    const Variator model(p);
    RigidStepper one(model), other(model);
    const double begin = -p.start.settling_time;
    one.start(begin, start_state(p).state.data());
    run(one, begin, 5e-6, 1000);
    std::vector<double> memory, after[2];
    one.save(memory);
    other.load(memory);
    for (RigidStepper* stepper : {&one, &other}) {
        const double now = stepper->time();
        stepper->step(now, 2e-6);  // another length: velocities are advanced by what was saved
        run(*stepper, now + 2e-6, 5e-6, 100);
        stepper->save(after[stepper == &one ? 0 : 1]);
    }
    EXPECT_EQ(std::memcmp(after[0].data(), after[1].data(), sizeof(double) * after[0].size()), 0);
    memory.pop_back();
    EXPECT_THROW(other.load(memory), std::invalid_argument);
}

/// A step of another length shifts the lead of the velocities, whose error is of the order of the change of acceleration over a step: less
/// than 1e-5 of the way.
TEST(RigidStepper, StepsOfDifferentLengthsEndWhereEqualOnesDo) {
    const Parameters p = test::with_rigid_pins({});
    const Variator model(p);
    const double begin = -50e-3;
    const std::vector<double> from = moving_state(model, p, begin);
    RigidStepper mixed(model);
    mixed.start(begin, from.data());
    double now = begin;
    for (int k = 0; k < 20; ++k) {
        for (const double step : {0.5e-6, 1.5e-6}) {
            mixed.step(now, step);
            now += step;
        }
    }
    std::vector<double> y(from.size());
    mixed.state(y.data());
    const std::vector<double> equal = stepped(model, from, begin, 40e-6, 40);
    EXPECT_LT(distance(model.layout(), y, equal), 1e-5 * distance(model.layout(), from, equal));
}

}  // namespace
}  // namespace cvtflow::model
