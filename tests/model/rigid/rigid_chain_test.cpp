#include "model/rigid/rigid_chain.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <random>
#include <vector>

#include "model/observe/observation.hpp"
#include "model/start/start_state.hpp"
#include "model/variator/variator.hpp"
#include "tests/oracle/oracle_cases.hpp"

namespace cvtflow::model {
namespace {

/// A geometric start with its tips pressed in and everything moved and set in motion by chance.
std::vector<double> random_state(const Parameters& p, std::uint64_t seed) {
    std::vector<double> y = start_state(p).state;
    const PulleyModel pulleys(p);
    const ChainLayout at = layout_of(p);
    std::mt19937_64 generator(seed);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    const double amplitude[] = {3e-6, 3e-6, 3e-6, 3e-5, 3e-5, 3e-6, 3e-6, 3e-6};  // m
    for (int k = 0; k < rigid_coordinates; ++k) {
        for (int pin = 0; pin < at.links; ++pin) {
            const std::size_t place = static_cast<std::size_t>(at.link_begin(pin) + rigid_place(at, k));
            y[place] += amplitude[k] * uniform(generator);
            y[place + static_cast<std::size_t>(at.link_size())] += 0.02 * uniform(generator);
        }
    }
    const std::size_t tail = static_cast<std::size_t>(at.pulley_begin()), size = static_cast<std::size_t>(at.pulley_size);
    for (std::size_t k = 0; k < size; ++k) {
        y[tail + k] += 2e-6 * uniform(generator);
        y[tail + size + k] += 0.01 * uniform(generator);
    }
    for (int shaft = 0; shaft < 2 && size != 0; ++shaft)
        y[tail + static_cast<std::size_t>(pulleys.coordinates().movable(shaft))] += (shaft == 0 ? -1.0 : 1.0) * 2e-5;
    return y;
}

std::vector<oracle::Case> rigid_machines() {
    std::vector<oracle::Case> cases;
    for (const auto pulleys : {PulleyDetail::elastic, PulleyDetail::rigid, PulleyDetail::absent}) {
        for (const auto law : {FrictionLaw::piecewise, FrictionLaw::smoothed}) {
            oracle::Case one{"", oracle::with_rigid_pins(oracle::small_scene())};
            one.parameters.detail.pulleys = pulleys;
            one.parameters.detail.friction = law;
            if (pulleys == PulleyDetail::absent) one.parameters.start.layout = StartLayout::ring;
            if (pulleys == PulleyDetail::rigid) one.parameters.detail.mass_scaling = 3.0;
            if (law == FrictionLaw::piecewise && pulleys == PulleyDetail::elastic) {
                one.parameters.tip.friction_law = TipFriction::table;
                one.parameters.tip.friction_table = {{0.0, 0.02, 0.1}, {0.07, 0.09, 0.05}};
                one.parameters.tip.pressure_sensitivity = -0.4;
            }
            one.name = "pulleys " + std::to_string(static_cast<int>(pulleys)) + ", law " + std::to_string(static_cast<int>(law));
            cases.push_back(one);
        }
    }
    return cases;
}

/// Slope of a state, with everything around it.
struct Evaluation {
    Evaluation(const Variator& variator, const std::vector<double>& y, double t = 0.0) : slope(y.size()) {
        const ChainLayout& at = variator.layout();
        EvaluationScratch scratch(at);
        const std::vector<Phase> phases(static_cast<std::size_t>(tips_per_link * at.links), Phase::free);
        right_hand_side(variator, t, y.data(), phases.data(), slope.data(), scratch);
        chain = variator.chain().rigid()->last().forces.account;
        all = chain;
        if (at.pulley_size == 0) return;
        inputs = variator.pulleys().inputs().at(t, y.data() + at.pulley_begin());
        std::vector<double> ignored(static_cast<std::size_t>(2 * at.pulley_size));
        variator.pulleys().slope(y.data() + at.pulley_begin(), inputs, {}, ignored.data(), &all);
    }
    std::vector<double> slope;
    Inputs inputs;
    Account chain, all;  ///< accounts of the chain, and of chain and pulleys

    [[nodiscard]] static double total(const auto& values) { return std::accumulate(values.begin(), values.end(), 0.0); }
};

double kinetic(const Variator& variator, const std::vector<double>& y) {
    const ChainLayout& at = variator.layout();
    double energy = at.pulley_size != 0 ? variator.pulleys().kinetic(y.data() + at.pulley_begin()) : 0.0;
    for (int pin = 0; pin < at.links; ++pin)
        energy += kinetic_energy(variator.chain().inertia(), y.data() + at.link_begin(pin) + at.link_size());
    return energy;
}

/// Accelerations are compared where those of halves are (tests/model/variator_test.cpp). Relative 1e-11: tensions of 1 kN are known to
/// 1e-8 N, by lengths of up to 0.1 m known to 1e-17 m, and energies and losses go with their squares.
TEST(RigidModel, EnergiesAndLossesOfEveryKindAreTheOracles) {
    std::uint64_t seed = 1;
    for (const oracle::Case& one : oracle::rigid_details(oracle::small_scene())) {
        SCOPED_TRACE(one.name);
        const Variator variator(one.parameters);
        const oracle::RandomState random = oracle::random_state(one.parameters, seed++);
        const Evaluation now(variator, random.state);
        const oracle::Result expected = oracle::right_hand_side(one.parameters, 0.0, random.state, random.phases);
        const oracle::Energies& e = expected.energies;
        const std::array<double, energy_kinds> energies{0.0, e.inner, e.pack, e.plates, e.joints, e.tips, e.supports};
        for (std::size_t k = 0; k < energy_kinds; ++k) EXPECT_NEAR(now.all.energy[k], energies[k], 1e-11 * energies[k]) << "energy " << k;
        EXPECT_NEAR(kinetic(variator, random.state), e.kinetic, 1e-13 * e.kinetic);
        for (std::size_t k = 0; k < loss_kinds; ++k) {
            const double loss = expected.powers.losses[k];
            EXPECT_NEAR(now.all.loss[k], loss, 1e-11 * loss) << "loss " << k;
        }
    }
}

/// Differences of 1 kJ over 2e-8 s round to 1e-5 W.
TEST(RigidModel, EnergyChangesByWorksMinusLosses) {
    for (const oracle::Case& one : rigid_machines()) {
        SCOPED_TRACE(one.name);
        const Variator variator(one.parameters);
        const ChainLayout& at = variator.layout();
        const std::vector<double> y = random_state(one.parameters, 7);
        const Evaluation now(variator, y);
        const auto energy_after = [&](double time) {
            std::vector<double> there = y;
            for (std::size_t k = 0; k < y.size(); ++k) there[k] += time * now.slope[k];
            return Evaluation::total(Evaluation(variator, there).all.energy) + kinetic(variator, there);
        };
        constexpr double instant = 1e-8;
        const double rate = (energy_after(instant) - energy_after(-instant)) / (2.0 * instant);
        WorkRates works{};
        if (at.pulley_size != 0) works = model::input_powers(variator.pulleys().coordinates(), y.data() + at.pulley_begin(), now.inputs);
        const double losses = Evaluation::total(now.all.loss), expected = Evaluation::total(works) - losses;
        EXPECT_NEAR(rate, expected, 2e-3 + 1e-5 * losses);
        for (const double loss : now.all.loss) EXPECT_GE(loss, 0.0);
    }
}

/// Rigid pulleys do not tilt: normal forces put no torque on them.
TEST(RigidModel, DragOfCreepIsTheTorqueOfTheChainOnRigidPulleys) {
    Parameters p = oracle::with_rigid_pins({});
    p.detail.pulleys = PulleyDetail::rigid;
    const Variator variator(p);
    Observer observer(variator);
    const std::vector<double> y = random_state(p, 11);
    const std::vector<Phase> phases(static_cast<std::size_t>(tips_per_link * variator.layout().links), Phase::touching);
    const Observation& now = observer.observe(0.0, y.data(), phases.data());
    const Creep& found = now.creep;
    for (std::size_t k = 0; k < 2; ++k) {
        EXPECT_NE(now.chain_torque[k], 0.0);
        EXPECT_NEAR(found.drag[k], now.chain_torque[k], 1e-11 * std::abs(now.chain_torque[k]));  // sums in another order
        EXPECT_NEAR(now.free_speed[k], now.speed[k] + now.chain_torque[k] / found.hold[k], 1e-9 * std::abs(now.free_speed[k]));
    }
    EXPECT_GT(now.creep.power, 0.0);
    EXPECT_LT(now.creep.power, now.account[Loss::tip_friction]) << "pins slide radially as well";
}

TEST(RigidModel, EveryInstructionSetHasTheSameBits) {
    const Parameters p = oracle::with_rigid_pins(oracle::small_scene());
    const std::vector<double> y = random_state(p, 3);
    const std::vector<Isa> isas = usable_isas();
    const Evaluation reference(Variator(p, isas.front()), y);
    for (const Isa isa : isas) {
        const Evaluation other(Variator(p, isa), y);
        EXPECT_EQ(std::memcmp(reference.slope.data(), other.slope.data(), sizeof(double) * y.size()), 0) << name_of(isa);
        EXPECT_EQ(reference.all.loss, other.all.loss) << name_of(isa);
        EXPECT_EQ(reference.all.energy, other.all.energy) << name_of(isa);
    }
}

/// A probe of few links finds the depths that an evaluation of all does where tips touch.
TEST(RigidModel, ProbesFindTheDepthsOfTheEvaluation) {
    const Parameters p = oracle::with_rigid_pins(oracle::small_scene());
    const Variator variator(p);
    const ChainLayout& at = variator.layout();
    const std::vector<double> y = random_state(p, 5);
    const Evaluation now(variator, y);
    SheaveMotion sheaves[4];
    variator.pulleys().motions(y.data() + at.pulley_begin(), sheaves);
    for (int link = 0; link < at.links; ++link) {
        NeighbourWindow near;
        TipProbe probe;
        variator.chain().probe(near.of(at, y.data(), link), sheaves, false, probe);
        for (int tip = 0; tip < tips_per_link; ++tip) {
            const double depth = variator.chain().rigid()->last().of_tip(variator.chain().rigid()->last().columns.tip.depth, link, tip);
            EXPECT_EQ(std::max(0.0, probe.depth[tip]), std::max(0.0, depth)) << link << " " << tip;
        }
    }
}

Parameters chain_of(int pins, FrictionLaw law) {
    Parameters p;
    p.chain.pins = pins;
    p.detail.friction = law;
    return oracle::with_rigid_pins(p);
}

/// Velocities, forces and sliding speeds of the last two steps without any order; a quarter of the links does not pull.
RigidColumns filled_columns(const RigidModel& model, unsigned seed) {
    RigidColumns columns = model.columns();
    std::mt19937 random(seed);
    const auto between = [&](double low, double high) { return low + (high - low) * static_cast<double>(random() % 1000) / 999.0; };
    for (int pin = 0; pin < columns.pins(); ++pin) {
        columns.velocity.z[pin] = between(-0.05, 0.05);
        columns.velocity.slide[pin] = between(-0.05, 0.05);
        columns.force.z[pin] = between(-300.0, 300.0);
        columns.tip.force.z[pin] = between(-300.0, 300.0);
        columns.force.slide[pin] = between(-150.0, 150.0);
        columns.tip.force.slide[pin] = between(-150.0, 150.0);
        columns.joint.normal[pin] = std::max(0.0, between(-1000.0, 3000.0));
        for (const Row slip : {columns.joint.slip, columns.joint.slip_before}) slip[pin] = between(-0.03, 0.03);
        columns.plate.tension[pin] = std::max(0.0, between(-1000.0, 3000.0));
        for (const Row slip :
             {columns.plate.slip_low, columns.plate.slip_high, columns.plate.slip_low_before, columns.plate.slip_high_before})
            slip[pin] = between(-0.03, 0.03);
        columns.tip.lengthening[pin] = between(-0.03, 0.03);
    }
    columns.wrap({columns.velocity.z, columns.velocity.slide});
    columns.wrap({columns.force.z, columns.force.slide});
    columns.wrap({columns.tip.force.z, columns.tip.force.slide});
    columns.wrap(columns.plate.tension);
    columns.wrap({columns.plate.slip_low, columns.plate.slip_high_before});
    columns.wrap(columns.tip.lengthening);
    return columns;
}

/// Friction per sliding speed at a speed. (model/EQUATIONS.md section 7)
double grip_of(const Parameters& p, const Friction& friction, double normal, double speed) {
    const double v0 = friction.saturation_speed, d = p.detail.friction == FrictionLaw::piecewise ? 0.0 : p.detail.smoothing;
    const double beyond = speed - (1.0 - d) * v0;
    double secant = 1.0 / std::max(speed, v0);
    if (std::abs(speed - v0) < d * v0) secant = 1.0 / v0 - beyond * beyond / (4.0 * d * v0 * v0) / speed;
    return friction.coefficient * normal * secant;
}

/// Speed of the front (+1) or rear (-1) half of pin `of` behind a step: half of the pin's mass each, held by its link (of the front half
/// that of pin `from`) and by the other half.
double speed_behind(const RigidModel& model, const RigidColumns& columns, int of, int from, double half, double step) {
    const double both = columns.force.z[of] + columns.tip.force.z[of];
    const double apart = columns.force.slide[of] + columns.tip.force.slide[of];
    const double plates = half > 0.0 ? -columns.plate.friction[from] : columns.plate.friction[of];
    const double force = 0.5 * both + half * (apart - columns.joint.friction[of]) + plates;
    const double speed = columns.velocity.z[of] + 0.5 * half * columns.velocity.slide[of];
    return speed + step / (0.5 * model.coefficients().mass) * force;
}

/// Sliding speeds of all pins or links, extrapolated from the last two steps.
std::vector<double> expected_slips(const RigidColumns& columns, const double* slip, const double* before) {
    std::vector<double> speeds;
    for (int pin = 0; pin < columns.pins(); ++pin) speeds.push_back(std::abs(2.0 * slip[pin] - before[pin]));
    return speeds;
}

/// The friction of each half of a link's plates, and of the halves of a pin, is its grip times the sliding speed that all frictions
/// together leave behind. The grip is that at the sliding speed extrapolated from the last two steps.
TEST(RigidPlates, FrictionFollowsFromTheVelocitiesThatTheWholeChainLeavesBehind) {
    constexpr double step = 5e-6;
    for (const FrictionLaw law : {FrictionLaw::piecewise, FrictionLaw::smoothed}) {
        for (const int pins : {3, 4, 7, 8, 9, 15, 16, 17, 23, 24, 84, 85, 200}) {
            SCOPED_TRACE(pins);
            const Parameters p = chain_of(pins, law);
            const RigidModel model(p);
            RigidColumns columns = filled_columns(model, static_cast<unsigned>(pins));
            const auto low = expected_slips(columns, columns.plate.slip_low, columns.plate.slip_low_before);
            const auto high = expected_slips(columns, columns.plate.slip_high, columns.plate.slip_high_before);
            const auto apart = expected_slips(columns, columns.joint.slip, columns.joint.slip_before);
            Account account;
            model.kernels().plate_friction(model.coefficients(), {step}, columns, account);
            model.kernels().joint_friction(model.coefficients(), {step}, columns, account);
            const double *friction = columns.plate.friction, *joint = columns.joint.friction;
            double largest = 0.0, held = 0.0;
            for (int pin = 0; pin < pins; ++pin) {
                const int next = (pin + 1) % pins, before = (pin + pins - 1) % pins;
                const auto after = [&](int of, int from, double half) { return speed_behind(model, columns, of, from, half, step); };
                const double slides = after(next, pin, 1.0) - after(pin, before, -1.0);
                const double parts = after(pin, before, 1.0) - after(pin, before, -1.0);
                const double holds = grip_of(p, p.joint.friction, columns.joint.normal[pin], apart[static_cast<std::size_t>(pin)]);
                EXPECT_NEAR(joint[pin], holds * parts, 1e-9) << pin;
                EXPECT_NEAR(columns.joint.slip[pin], parts, 1e-12) << pin;
                const double parting = model.coefficients().plate_reach * (columns.tip.lengthening[next] - columns.tip.lengthening[pin]);
                const double tension = 0.5 * columns.plate.tension[pin];
                const double at_low = grip_of(p, p.plate.friction, tension, low[static_cast<std::size_t>(pin)]) * (slides - parting);
                const double at_high = grip_of(p, p.plate.friction, tension, high[static_cast<std::size_t>(pin)]) * (slides + parting);
                EXPECT_NEAR(friction[pin], at_low + at_high, 1e-9) << pin;
                EXPECT_NEAR(columns.plate.moment[pin], at_high - at_low, 1e-9) << pin;
                EXPECT_NEAR(columns.plate.slip_low[pin], slides - parting, 1e-12) << pin;
                EXPECT_NEAR(columns.plate.slip_high[pin], slides + parting, 1e-12) << pin;
                largest = std::max(largest, std::abs(friction[pin]));
                held = std::max(held, std::abs(joint[pin]));
            }
            EXPECT_GT(std::min(largest, held), 10.0);
        }
    }
}

}  // namespace
}  // namespace cvtflow::model
