/// Claims about energy and momentum. Without friction and damping energy is kept; with them, power in less power out is dissipation, by
/// kind, to integrator accuracy. Forces inside the chain keep its momentum and angular momentum; every method keeps what all forces of a
/// free chain keep.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
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

/// d/dt of the stored energy along a slope, differenced. Kinetic energy is quadratic in velocities alone, so a long step is exact there.
double energy_rate(const model::Variator& variator, const std::vector<double>& state, const std::vector<model::Phase>& phases,
                   const std::vector<double>& slope) {
    model::Observer observer(variator);
    const model::ChainLayout& at = variator.layout();
    const auto is_rate = [&](int k) {
        return k < at.pulley_begin() ? k % at.link_block() >= at.link_size() : k >= at.pulley_begin() + at.pulley_size;
    };
    const auto moved = [&](double time, bool rates) {
        auto there = state;
        for (int k = 0; k < at.control_begin(); ++k) {
            if (is_rate(k) == rates) there[static_cast<std::size_t>(k)] += time * slope[static_cast<std::size_t>(k)];
        }
        const model::Account account = observer.observe(0.0, there.data(), phases.data()).account;
        const double kinetic = account[model::Energy::kinetic];
        return rates ? kinetic : total(account) - kinetic;
    };
    const double brief = 1e-10, longer = 1e-8;  // positions move by a nanometre
    return (moved(brief, false) - moved(-brief, false)) / (2.0 * brief) + (moved(longer, true) - moved(-longer, true)) / (2.0 * longer);
}

void expect_balance_at_every_instant(const model::Parameters& p, std::uint64_t seed, const std::string& name) {
    const model::Variator variator(p);
    const auto random = oracle::random_state(p, seed);
    model::EvaluationScratch scratch(variator.layout());
    std::vector<double> slope(random.state.size());
    model::right_hand_side(variator, 0.0, random.state.data(), random.phases.data(), slope.data(), scratch);
    model::Observer observer(variator);
    const model::Observation& now = observer.observe(0.0, random.state.data(), random.phases.data());
    for (std::size_t kind = 0; kind < now.account.loss.size(); ++kind) EXPECT_GT(now.account.loss[kind], 0.0) << name << ", loss " << kind;
    const double lost = std::accumulate(now.account.loss.begin(), now.account.loss.end(), 0.0);
    const double put_in = std::accumulate(now.work.begin(), now.work.end(), 0.0);
    const double rate = energy_rate(variator, random.state, random.phases, slope);
    // Places of 50 mm are rounded to 7e-18 m, forces of 1 kN act on them at some hundred contacts: 1e-13 J over 2e-10 s.
    EXPECT_NEAR(rate, put_in - lost, 0.02) << name << ", seed " << seed;
}

/// Rails that every pin between them touches.
model::Guide guides_without_play() {
    model::Guide guide;
    guide.stiffness = 1e5;
    guide.clearance = 0.0;
    return guide;
}

TEST(EnergyBalance, HoldsAtEveryInstantAndEveryLossIsPositive) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        model::Parameters varied = tiny();
        varied.detail.plates = seed % 2 == 0 ? model::PlateDetail::each : model::PlateDetail::lumped;
        varied.guide = guides_without_play();
        expect_balance_at_every_instant(varied, seed, "tiny");
        for (const std::string& level : levels()) {
            model::Parameters p = at_level(tiny(), level);
            p.guide = guides_without_play();
            expect_balance_at_every_instant(p, seed, level);
        }
    }
}

void expect_momentum_kept(model::Parameters p, const std::string& name) {
    p.detail.pulleys = model::PulleyDetail::absent;
    p.start.layout = model::StartLayout::ring;
    p.chain.pins = 24;
    const auto random = oracle::random_state(p, 3);
    Rig rig(p, random.state, random.phases);
    const ChainView chain(p, random.state.data());
    const Vector momentum = chain.momentum();
    const double angular = chain.angular_momentum();
    ASSERT_FALSE(rig.run({0.0, 1e-4, 2e-8, 1e-4})) << name;
    const ChainView later(p, rig.state());
    // Momentum is linear, so every Runge-Kutta method keeps it: rounding of 5000 steps, of masses of 0.4 kg at 6 m/s.
    EXPECT_NEAR(norm(later.momentum() - momentum), 0.0, 1e-12) << name;
    // Angular momentum is quadratic: kept to the order of the method. Measured 4e-15.
    EXPECT_NEAR(later.angular_momentum(), angular, 1e-12 * angular) << name;
    model::Observer observer(rig.variator());
    const auto& losses = observer.observe(0.0, rig.state(), rig.phases().data()).account;
    EXPECT_GT(losses[model::Loss::joint_friction] + losses[model::Loss::plate_damping], 0.0) << name << ": while it is being braked inside";
}

TEST(Momentum, OfAFreeRingIsKeptWhateverItsOwnForcesDo) {
    for (const std::string& level : levels()) expect_momentum_kept(at_level({}, level), level);
}

/// A spinning ring whose links are pushed in all directions; friction, damping and all.
model::Parameters ring() {
    model::Parameters p;
    p.detail.pulleys = model::PulleyDetail::absent;
    p.start.layout = model::StartLayout::ring;
    p.start.ring_speed = 600.0;
    p.chain.pins = 12;
    return p;
}

struct Momentum {
    std::array<double, 2> sum{};   ///< momentum in x and y [kg·m/s]
    std::array<double, 2> size{};  ///< sum of magnitudes over links
};

/// Momentum of rotation about z, of every coordinate of links: Σ x × A v [kg·m²/s].
double spin(const model::Variator& variator, const double* state) {
    const model::ChainLayout& at = variator.layout();
    const auto& matrix = variator.chain().inertia().lateral_matrix;
    const int size = at.bodies() * at.lateral();
    double total = 0.0;
    for (int link = 0; link < at.links; ++link) {
        const double *q = state + at.link_begin(link), *v = q + at.link_size();
        for (int row = 0; row < size; ++row) {
            for (int column = 0; column < size; ++column)
                total += matrix[static_cast<std::size_t>(row * size + column)] * (q[row] * v[size + column] - q[size + row] * v[column]);
        }
    }
    return total;
}

void push_links(Rig& rig) {
    const model::ChainLayout& at = rig.variator().layout();
    for (int link = 0; link < at.links; ++link) {
        for (int k = 0; k < at.link_size(); ++k)
            rig.mutable_state()[at.link_begin(link) + at.link_size() + k] += 0.02 * std::sin(1.0 + link + 3.0 * k);
    }
}

/// Momentum of every link, A v against a unit translation: order 0 of both halves.
Momentum momentum(const model::Variator& variator, const double* state) {
    const model::ChainLayout& at = variator.layout();
    const auto& matrix = variator.chain().inertia().lateral_matrix;
    const int size = 2 * at.lateral();
    Momentum total;
    for (int link = 0; link < at.links; ++link) {
        const double* v = state + at.link_begin(link) + at.link_size();
        for (int direction = 0; direction < 2; ++direction) {
            const int begin = direction * size;
            double part = 0.0;
            for (const model::End end : {model::End::rear, model::End::front}) {
                const int row = at.x(end, 0);
                for (int column = 0; column < size; ++column)
                    part += matrix[static_cast<std::size_t>(row * size + column)] * v[begin + column];
            }
            total.sum[static_cast<std::size_t>(direction)] += part;
            total.size[static_cast<std::size_t>(direction)] += std::abs(part);
        }
    }
    return total;
}

TEST(EveryMethod, KeepsTheMomentumOfAFreeChain) {
    for (const engine::StagePlan& plan : engine::methods()) {
        Rig rig(ring(), 1, plan.name);
        push_links(rig);
        const Momentum before = momentum(rig.variator(), rig.state());
        ASSERT_GT(std::abs(before.sum[0]), 1e-6 * before.size[0]);
        ASSERT_FALSE(rig.run({0.0, 2e-7, 1e-8, 1e-7})) << plan.name;
        const Momentum after = momentum(rig.variator(), rig.state());
        // Rounding of 20 steps of up to 325 stages; forces move 1e-3 of this between links.
        for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(after.sum[k], before.sum[k], 1e-12 * before.size[k]) << plan.name;
    }
}

TEST(MassScaling, KeepsTheMomentumOfRotationOfAFreeChain) {
    model::Parameters p = ring();
    const double parallel_spin = spin(Rig(p).variator(), Rig(p).state());
    p.detail.mass_scaling = 10.0;
    Rig rig(p);
    EXPECT_EQ(spin(rig.variator(), rig.state()), parallel_spin);  // pins start parallel to the axis
    push_links(rig);
    const double before = spin(rig.variator(), rig.state());
    ASSERT_FALSE(rig.run({0.0, 1e-6, 1e-8, 1e-7}));
    // A product of coordinates and speeds is kept to the method's order: (1e6 1/s · 1e-8 s)^5 in each of 100 steps.
    EXPECT_NEAR(spin(rig.variator(), rig.state()), before, 1e-8 * std::abs(before));
}

}  // namespace
}  // namespace cvtflow::claims
