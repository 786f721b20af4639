/// Claims about energy and momentum: without friction and damping energy is kept; with them, power in less power out is dissipation, by
/// kind, to integrator accuracy. Forces inside the chain keep its momentum and angular momentum; every method keeps what all forces of a
/// free chain keep. On smooth motions the classical Runge-Kutta method converges with its order, 4.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "engine/method/catalogue.hpp"
#include "model/observe/observation.hpp"
#include "tasks/scene/scene.hpp"
#include "tests/claims/chain_view_fixture.hpp"
#include "tests/claims/rig_fixture.hpp"
#include "tests/oracle/random_state.hpp"

namespace cvtflow::claims {
namespace {

// Claims about energy and momentum. Without friction and damping energy is kept; with them, power in less power out is dissipation, by
// kind, to integrator accuracy. Forces inside the chain keep its momentum and angular momentum; every method keeps what all forces of a
// free chain keep.

model::Parameters tiny() { return tasks::read_scene(std::string(CVTFLOW_SOURCE_DIR) + "/scenes/tiny.toml").parameters; }

double total(const model::Account& account) { return std::accumulate(account.energy.begin(), account.energy.end(), 0.0); }

double energy(Rig& rig) {
    model::Observer observer(rig.variator());
    return total(observer.observe(rig.time(), rig.state(), rig.phases().data()).account);
}

struct Ledger {
    double lost = 0.0, put_in = 0.0;  ///< [J]
    double passed = 0.0;              ///< sum of magnitudes [J]
};
Ledger ledger(const Rig& rig) {
    Ledger sum;
    const double* entry = rig.state() + rig.variator().layout().ledger_begin();
    for (int k = 0; k < model::loss_kinds + model::work_kinds; ++k) {
        (k < model::loss_kinds ? sum.lost : sum.put_in) += entry[k];
        sum.passed += std::abs(entry[k]);
    }
    return sum;
}

/// Settled under load with everything on; then friction and damping may be taken away.
std::vector<double> settled_state(const model::Parameters& p, double time, std::vector<model::Phase>& phases) {
    Rig rig(p);
    EXPECT_FALSE(rig.run({-time, 0.0, 5e-8, time / 10.0}));
    phases = rig.phases();
    return rig.state_copy();
}

TEST(Energy, IsKeptWithoutFrictionDampingAndInputs) {
    model::Parameters p = tiny();
    p.start.settling_time = 3e-3;
    p.start.ramp_time = 2e-3;
    std::vector<model::Phase> phases;
    std::vector<double> state = settled_state(p, 3e-3, phases);  // taking friction away is a jolt: the motion is far from steady
    make_conservative(p);
    p.drive.mode = model::DriveMode::torque;
    p.drive.torque = p.load.torque = model::TimeTable(0.0);
    p.ledger = true;  // counts the work of the constant clamping forces
    state.resize(static_cast<std::size_t>(model::layout_of(p).size()));
    Rig rig(p, state, phases);
    const double before = energy(rig);
    ASSERT_FALSE(rig.run({0.0, 1e-3, 2e-8, 1e-4}));
    const Ledger sum = ledger(rig);
    EXPECT_EQ(sum.lost, 0.0);
    EXPECT_GT(std::abs(sum.put_in), 0.01);
    EXPECT_GT(rig.counters().detected, 0) << "tips come and go meanwhile";
    // Measured 8e-13 of the total (1.6 kJ, most of it rotation), which is 6e-9 of the 0.2 J that sit in springs.
    EXPECT_NEAR(energy(rig) - before, sum.put_in, 1e-11 * before);
}

struct Balance {
    std::string level;  ///< empty: that of tiny
    double duration;
    bool control;
};
class EnergyBalance : public testing::TestWithParam<Balance> {};

TEST_P(EnergyBalance, TheLedgerOfWorksAndLossesClosesOverARunWithEverythingOn) {
    model::Parameters p = tiny();
    if (!GetParam().level.empty()) p = at_level(p, GetParam().level);
    p.control.enabled = GetParam().control;
    p.ledger = true;
    p.start.settling_time = p.start.ramp_time = 1e-3;
    Rig rig(p);
    const double before = energy(rig);
    ASSERT_FALSE(rig.run({-1e-3, -1e-3 + GetParam().duration, 5e-8, 1e-4}));
    const Ledger sum = ledger(rig);
    EXPECT_GT(sum.lost, 0.1);
    EXPECT_GT(rig.counters().detected, 100);
    // Measured 2e-8 to 5e-8 at steps from 50 to 12 ns: kinks of friction and of contacts opening, not the method, set the error.
    EXPECT_NEAR(energy(rig) - before, sum.put_in - sum.lost, 1e-6 * sum.passed);
}

std::vector<Balance> balances() {
    std::vector<Balance> all{{"", 1e-3, false}};
    for (const std::string& level : levels()) all.push_back({level, 0.5e-3, true});
    return all;
}

INSTANTIATE_TEST_SUITE_P(Details, EnergyBalance, testing::ValuesIn(balances()),
                         [](const auto& instance) { return instance.param.level.empty() ? std::string("tiny") : instance.param.level; });

void expect_momentum_kept(const model::Parameters& p, const std::string& name) {
    const auto random = oracle::random_state(p, 3);
    Rig rig(p, random.state, random.phases);
    const ChainView chain(p, random.state.data());
    const double angular = chain.angular_momentum();
    ASSERT_FALSE(rig.run({0.0, 1e-4, 2e-8, 1e-4})) << name;
    const ChainView later(p, rig.state());
    // Momentum is linear, so every Runge-Kutta method keeps it: rounding of 5000 steps, of masses of 0.4 kg at 6 m/s.
    EXPECT_NEAR(norm(later.momentum() - chain.momentum()), 0.0, 1e-12) << name;
    // Angular momentum is quadratic: kept to the order of the method. Measured 4e-15.
    EXPECT_NEAR(later.angular_momentum(), angular, 1e-12 * angular) << name;
    model::Observer observer(rig.variator());
    const auto& losses = observer.observe(0.0, rig.state(), rig.phases().data()).account;
    EXPECT_GT(losses[model::Loss::joint_friction] + losses[model::Loss::plate_damping], 0.0) << name << ": while it is being braked inside";
}

TEST(Momentum, OfAFreeRingIsKeptWhateverItsOwnForcesDo) {
    for (const std::string& level : levels()) expect_momentum_kept(at_level(free_ring(24), level), level);
}

/// Links of a spinning ring are pushed in all directions; friction, damping and all.
TEST(EveryMethod, KeepsTheMomentumOfAFreeChain) {
    const model::Parameters p = free_ring(12, 600.0);
    for (const engine::StagePlan& plan : engine::methods()) {
        Rig rig(p, 1, plan.name);
        jolt(rig.variator().layout(), rig.mutable_state());
        const std::vector<double> start = rig.state_copy();
        const ChainView before(p, start.data());
        double size = 0.0;  // sum of magnitudes over links, in either direction
        for (int link = 0; link < before.links(); ++link) size += 0.6 * model::link_mass(p) * norm(before.velocity(link, model::End::rear));
        ASSERT_GT(norm(before.momentum()), 1e-6 * size);
        ASSERT_FALSE(rig.run({0.0, 2e-7, 1e-8, 1e-7})) << plan.name;
        // Rounding of 20 steps of up to 325 stages; forces move 1e-3 of this between links.
        EXPECT_NEAR(norm(ChainView(p, rig.state()).momentum() - before.momentum()), 0.0, 1e-12 * size) << plan.name;
    }
}

// Claim: on smooth motions of the variator the classical Runge-Kutta method converges with its order, 4.

std::vector<double> solution(const Smooth& scene, double step) {
    Rig rig(scene.parameters, scene.state, scene.phases);
    EXPECT_FALSE(rig.run({0.0, smooth_span, step, smooth_span}));
    EXPECT_EQ(rig.counters().truncated, 0);
    return rig.state_copy();
}

TEST(Rk4, ConvergesWithOrderFourOnAFreeRingAndOnAChainClampedBetweenElasticSheaves) {
    for (const Smooth& scene : {disturbed_ring(), clamped_ring()}) {
        const std::vector<double> reference = solution(scene, smooth_span / 256);  // its error is 4⁴ times smaller than that of the finest
        double coarser = 0.0;
        for (const int steps : {8, 16, 32, 64}) {
            const double error = distance(solution(scene, smooth_span / steps), reference);
            if (steps > 8) {
                EXPECT_NEAR(std::log2(coarser / error), 4.0, 0.25) << "errors " << coarser << " and " << error;
            }
            coarser = error;
        }
    }
}

}  // namespace
}  // namespace cvtflow::claims
