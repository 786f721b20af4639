#include "model/variator/rigid/rigid_stepper.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "model/variator/rigid/rigid_observation.hpp"
#include "tests/engine/allocation_fixture.hpp"
#include "tests/oracle/oracle_cases.hpp"

namespace cvtflow::model {
namespace {

/// The state of the baseline machine some time after its geometric start, on the slow motion that follows the start's jolt.
std::vector<double> moving_state(const RigidModel& model, const Parameters& p, double until) {
    RigidStepper stepper(model, 1e-6);
    stepper.start(-p.start.settling_time, rigid_start(p).data());
    while (stepper.time() < until) stepper.step();
    std::vector<double> y(static_cast<std::size_t>(model.layout().size()));
    stepper.state(y.data());
    return y;
}

std::vector<double> stepped(const RigidModel& model, const std::vector<double>& from, double begin, double span, long steps) {
    RigidStepper stepper(model, span / static_cast<double>(steps));
    stepper.start(begin, from.data());
    for (long k = 0; k < steps; ++k) stepper.step();
    std::vector<double> y(from.size());
    stepper.state(y.data());
    return y;
}

/// The classical fourth-order method on the same forces with friction as it is.
std::vector<double> by_runge_kutta(const RigidModel& model, std::vector<double> y, double begin, double span, long steps) {
    RigidColumns columns = model.columns();
    RigidForces forces;
    const double h = span / static_cast<double>(steps);
    std::vector<double> k[4], there(y.size());
    for (auto& slope : k) slope.resize(y.size());
    for (long step = 0; step < steps; ++step) {
        const double t = begin + static_cast<double>(step) * h;
        const double share[] = {0.0, 0.5, 0.5, 1.0};
        for (int stage = 0; stage < 4; ++stage) {
            for (std::size_t i = 0; i < y.size(); ++i) there[i] = stage == 0 ? y[i] : y[i] + share[stage] * h * k[stage - 1][i];
            model.slope(t + share[stage] * h, there.data(), k[stage].data(), columns, forces);
        }
        for (std::size_t i = 0; i < y.size(); ++i) y[i] += h / 6.0 * (k[0][i] + 2.0 * k[1][i] + 2.0 * k[2][i] + k[3][i]);
    }
    return y;
}

/// Difference of the pins' places in the plane, root mean square [m].
double distance(const RigidLayout& at, const std::vector<double>& a, const std::vector<double>& b) {
    double square = 0.0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(2 * at.pins); ++k) square += (a[k] - b[k]) * (a[k] - b[k]);
    return std::sqrt(square / at.pins);
}

TEST(RigidStepper, ConvergesToTheSolutionOfItsForces) {
    const Parameters p;
    const RigidModel model(p);
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
    const Parameters base;
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
        const RigidModel model(p);
        RigidStepper stepper(model, 5e-6);
        stepper.start(-p.start.settling_time, rigid_start(p).data());
        while (stepper.time() < -40e-3) stepper.step();
        const RigidBalance from = stepper.balance();
        while (stepper.time() < -20e-3) stepper.step();
        const RigidBalance to = stepper.balance();
        const double lost = to.losses() - from.losses();
        EXPECT_GT(lost, 2.0);
        EXPECT_LT(std::abs(residual(from, to)), 1e-3 * lost);
    }
}

/// The torque of the strands' tensions is the load's, and the chain stays between the sheaves' flanks.
TEST(RigidStepper, BaselineCarriesItsLoad) {
    const Parameters p;
    const RigidModel model(p);
    RigidStepper stepper(model, 5e-6);
    stepper.start(-p.start.settling_time, rigid_start(p).data());
    double torque = 0.0, slip = 0.0;
    long count = 0;
    while (stepper.time() < 0.0) {
        stepper.step();
        if (stepper.time() < -20e-3) continue;
        const RigidObservation now = observe(stepper);
        torque += (now.tight - now.slack) * now.radius[1];
        slip += now.slip;
        ++count;
    }
    EXPECT_NEAR(torque / static_cast<double>(count), 150.0, 0.02 * 150.0);
    EXPECT_GT(slip / static_cast<double>(count), 1e-3);
    EXPECT_LT(slip / static_cast<double>(count), 1e-2);
}

TEST(RigidStepper, StepsAllocateNothing) {
    const Parameters p = oracle::small_scene();
    const RigidModel model(p);
    RigidStepper stepper(model, 2e-6);
    stepper.start(-p.start.settling_time, rigid_start(p).data());
    stepper.step();
    const long before = engine::test::allocation_count();
    for (int k = 0; k < 100; ++k) stepper.step();
    EXPECT_EQ(engine::test::allocation_count(), before);
}

TEST(RigidStepper, EveryInstructionSetHasTheSameBits) {
    const Parameters p;
    std::vector<std::vector<double>> ends;
    for (const Isa isa : usable_isas()) {
        const RigidModel model(p, isa);
        ends.push_back(stepped(model, rigid_start(p), -p.start.settling_time, 5e-3, 1000));
        EXPECT_EQ(std::memcmp(ends.front().data(), ends.back().data(), sizeof(double) * ends.back().size()), 0) << name_of(isa);
    }
}

}  // namespace
}  // namespace cvtflow::model
