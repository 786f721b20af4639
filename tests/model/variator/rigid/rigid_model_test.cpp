#include "model/variator/rigid/rigid_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numeric>
#include <random>

#include "tests/model/variator/rigid/plain_pins_fixture.hpp"
#include "tests/oracle/oracle_cases.hpp"

namespace cvtflow::model {
namespace {

/// A geometric start with its tips pressed in and everything moved and set in motion by chance.
std::vector<double> random_state(const Parameters& p, std::uint64_t seed) {
    std::vector<double> y = rigid_start(p);
    const RigidModel model(p);
    const RigidLayout& at = model.layout();
    std::mt19937_64 generator(seed);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    const double amplitude[] = {3e-6, 3e-6, 3e-6, 3e-5, 3e-5};  // m
    for (int k = 0; k < rigid_coordinates; ++k) {
        for (int pin = 0; pin < at.pins; ++pin) {
            y[static_cast<std::size_t>(at.coordinate(k) + pin)] += amplitude[k] * uniform(generator);
            y[static_cast<std::size_t>(at.velocity(k) + pin)] += 0.02 * uniform(generator);
        }
    }
    const std::size_t tail = static_cast<std::size_t>(at.pulley_begin()), size = static_cast<std::size_t>(at.pulley_size);
    for (std::size_t k = 0; k < size; ++k) {
        y[tail + k] += 2e-6 * uniform(generator);
        y[tail + size + k] += 0.01 * uniform(generator);
    }
    for (int shaft = 0; shaft < 2 && size != 0; ++shaft)
        y[tail + static_cast<std::size_t>(model.pulleys().movable(shaft))] += (shaft == 0 ? -1.0 : 1.0) * 2e-5;
    return y;
}

std::vector<oracle::Case> machines() {
    std::vector<oracle::Case> cases;
    for (const auto pulleys : {PulleyDetail::elastic, PulleyDetail::rigid, PulleyDetail::absent}) {
        for (const auto law : {FrictionLaw::piecewise, FrictionLaw::smoothed}) {
            oracle::Case one{"", oracle::small_scene()};
            one.parameters.detail.pulleys = pulleys;
            one.parameters.detail.friction = law;
            if (pulleys == PulleyDetail::absent) one.parameters.start.layout = StartLayout::ring;
            if (pulleys == PulleyDetail::rigid) one.parameters.detail.mass_scaling = 3.0;
            one.name = "pulleys " + std::to_string(static_cast<int>(pulleys)) + ", law " + std::to_string(static_cast<int>(law));
            cases.push_back(one);
        }
    }
    return cases;
}

/// Slope of a state, with everything around it.
struct Evaluation {
    Evaluation(const RigidModel& model, const std::vector<double>& y, double t = 0.0) : columns(model.columns()), slope(y.size()) {
        model.slope(t, y.data(), slope.data(), columns, forces);
    }
    RigidColumns columns;
    RigidForces forces;
    std::vector<double> slope;

    [[nodiscard]] double potential() const { return std::accumulate(forces.account.energy.begin(), forces.account.energy.end(), 0.0); }
    [[nodiscard]] double losses() const { return std::accumulate(forces.account.loss.begin(), forces.account.loss.end(), 0.0); }
};

/// Coordinates (first) or velocities of pins and pulleys.
std::vector<double> part_of(const RigidLayout& at, const std::vector<double>& y, bool velocities) {
    const auto pins = y.begin() + (velocities ? at.velocity(0) : 0);
    std::vector<double> part(pins, pins + rigid_coordinates * at.pins);
    const auto pulleys = y.begin() + at.pulley_begin() + (velocities ? at.pulley_size : 0);
    part.insert(part.end(), pulleys, pulleys + at.pulley_size);
    return part;
}

/// 1e-7 of the largest acceleration of a pin: the plain writing differences energies over 1e-11 m, which errs by 1e-4 N of 1e4 N.
TEST(RigidModel, AccelerationsAreThoseOfThePlainWriting) {
    std::uint64_t seed = 1;
    for (const oracle::Case& one : machines()) {
        SCOPED_TRACE(one.name);
        const RigidModel model(one.parameters);
        const RigidLayout& at = model.layout();
        const std::vector<double> y = random_state(one.parameters, seed++);
        const Evaluation now(model, y);
        std::vector<double> inertia;
        for (int k = 0; k < at.pulley_size; ++k) inertia.push_back(model.pulleys().inertia(k));
        const auto plain = test::plain_motion(one.parameters, part_of(at, y, false), part_of(at, y, true), inertia);
        double largest = 0.0;
        const std::size_t pins = static_cast<std::size_t>(rigid_coordinates * at.pins);
        for (std::size_t k = 0; k < pins; ++k) largest = std::max(largest, std::abs(plain.acceleration[k]));
        ASSERT_GT(largest, 1e4);
        for (std::size_t k = 0; k < pins; ++k)
            EXPECT_NEAR(now.slope[static_cast<std::size_t>(at.velocity(0)) + k], plain.acceleration[k], 1e-7 * largest) << k;
        // The chain's forces on the pulleys: the slope without them taken away.
        std::vector<double> bare(now.slope.begin() + at.pulley_begin(), now.slope.begin() + at.pulley_begin() + 2 * at.pulley_size);
        if (at.pulley_size != 0) model.pulleys().slope(y.data() + at.pulley_begin(), now.forces.inputs, {}, bare.data(), nullptr);
        for (int k = 0; k < at.pulley_size; ++k) {
            const std::size_t v = static_cast<std::size_t>(at.pulley_size + k);
            const double force =
                inertia[static_cast<std::size_t>(k)] * (now.slope[static_cast<std::size_t>(at.pulley_begin()) + v] - bare[v]);
            const double expected = inertia[static_cast<std::size_t>(k)] * plain.acceleration[pins + static_cast<std::size_t>(k)];
            EXPECT_NEAR(force, expected, 1e-7 * largest * model.coefficients().mass) << "pulley " << k;
        }
        EXPECT_NEAR(now.potential() - now.forces.account[Energy::supports], plain.energy, 1e-9 * plain.energy);
        const double own = now.losses() - now.forces.account[Loss::supports] - now.forces.account[Loss::cylinder];
        EXPECT_NEAR(own, plain.lost, 1e-6 * plain.lost);
    }
}

/// Differences of 1 kJ over 2e-8 s round to 1e-5 W.
TEST(RigidModel, EnergyChangesByWorksMinusLosses) {
    for (const oracle::Case& one : machines()) {
        SCOPED_TRACE(one.name);
        const RigidModel model(one.parameters);
        const RigidLayout& at = model.layout();
        const std::vector<double> y = random_state(one.parameters, 7);
        const Evaluation now(model, y);
        const auto energy_after = [&](double time) {
            std::vector<double> there = y;
            for (std::size_t k = 0; k < y.size(); ++k) there[k] += time * now.slope[k];
            return Evaluation(model, there).potential() + model.kinetic(there.data());
        };
        constexpr double instant = 1e-8;
        const double rate = (energy_after(instant) - energy_after(-instant)) / (2.0 * instant);
        WorkRates works{};
        if (at.pulley_size != 0) works = model.pulleys().works(y.data() + at.pulley_begin(), now.forces.inputs);
        const double expected = std::accumulate(works.begin(), works.end(), 0.0) - now.losses();
        EXPECT_NEAR(rate, expected, 2e-3 + 1e-5 * now.losses());
        for (const double loss : now.forces.account.loss) EXPECT_GE(loss, 0.0);
    }
}

TEST(RigidModel, EveryInstructionSetHasTheSameBits) {
    Parameters p = oracle::small_scene();
    const std::vector<double> y = random_state(p, 3);
    const Evaluation reference(RigidModel(p, Isa::baseline), y);
    for (const Isa isa : usable_isas()) {
        const RigidModel model(p, isa);
        const Evaluation other(model, y);
        EXPECT_EQ(std::memcmp(reference.slope.data(), other.slope.data(), sizeof(double) * y.size()), 0) << name_of(isa);
        EXPECT_EQ(reference.forces.account.loss, other.forces.account.loss) << name_of(isa);
        EXPECT_EQ(reference.forces.account.energy, other.forces.account.energy) << name_of(isa);
    }
}

}  // namespace
}  // namespace cvtflow::model
