/// Claim: elastic forces are minus the gradient of the observed energies, and every friction and damping force dissipates, whatever the
/// state. (for the production kernels themselves)

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "model/observe/observation.hpp"
#include "tests/claims/rig_fixture.hpp"
#include "tests/oracle/oracle_cases.hpp"

namespace cvtflow::claims {
namespace {

TEST(Losses, AreNeverNegativeOnAnyState) {
    std::uint64_t seed = 900;
    std::vector<oracle::Case> cases = oracle::all_details(oracle::small_scene());
    for (const oracle::Case& slowed : oracle::slowed_pins(oracle::small_scene())) cases.push_back(slowed);
    for (const oracle::Case& one : cases) {
        const model::Variator variator(one.parameters);
        model::Observer observer(variator);
        const auto random = oracle::random_state(one.parameters, ++seed);
        const model::Observation& now = observer.observe(0.0, random.state.data(), random.phases.data());
        for (int kind = 0; kind < model::loss_kinds; ++kind)
            EXPECT_GE(now.account.loss[static_cast<std::size_t>(kind)], 0.0) << one.name << ", loss " << kind;
    }
}

TEST(Losses, AreNeverNegativeWithAnyFrictionLawAndDampingSoHeavyThatContactsLetGo) {
    for (const auto law : {model::FrictionLaw::piecewise, model::FrictionLaw::smoothed}) {
        for (const bool stick_slip : {false, true}) {
            for (const double damping : {0.0, 0.02, 50.0}) {
                model::Parameters p = oracle::small_scene();
                p.detail.friction = law;
                p.detail.stick_slip = stick_slip;
                p.chain.damping_ratio = damping;
                const model::Variator variator(p);
                model::Observer observer(variator);
                for (std::uint64_t seed = 1; seed <= 5; ++seed) {
                    const auto random = oracle::random_state(p, seed);
                    for (const double loss : observer.observe(0.0, random.state.data(), random.phases.data()).account.loss)
                        EXPECT_GE(loss, 0.0);
                }
            }
        }
    }
}

/// Generalized force on one coordinate: inertia times acceleration, for the coordinates of one link.
std::vector<double> link_force(const model::Variator& variator, int link, const std::vector<double>& slope) {
    const model::ChainLayout& at = variator.layout();
    const model::LinkInertia& inertia = variator.chain().inertia();
    const double* a = slope.data() + at.link_begin(link) + at.link_size();
    std::vector<double> force(static_cast<std::size_t>(at.link_size()), 0.0);
    const int lateral = at.bodies() * at.lateral();
    const auto multiply = [&](const double* matrix, int size, int begin) {
        for (int row = 0; row < size; ++row) {
            for (int column = 0; column < size; ++column)
                force[static_cast<std::size_t>(begin + row)] += matrix[row * size + column] * a[begin + column];
        }
    };
    multiply(inertia.lateral_matrix.data(), lateral, 0);
    multiply(inertia.lateral_matrix.data(), lateral, lateral);
    multiply(inertia.axial_matrix.data(), 2 * at.bodies(), 2 * lateral);
    return force;
}

class Gradient {
public:
    explicit Gradient(const model::Parameters& p) : Gradient(p, oracle::random_state(p, 21)) {}
    Gradient(const model::Parameters& p, const oracle::RandomState& state)
        : variator_(p), observer_(variator_), random_(state), slope_(random_.state.size()) {
        model::EvaluationScratch scratch(variator_.layout());
        model::right_hand_side(variator_, 0.0, random_.state.data(), random_.phases.data(), slope_.data(), scratch);
    }

    [[nodiscard]] const model::Variator& variator() const { return variator_; }
    [[nodiscard]] std::vector<double> force(int link) const { return link_force(variator_, link, slope_); }
    [[nodiscard]] double slope(int index) const { return slope_[static_cast<std::size_t>(index)]; }
    [[nodiscard]] const std::vector<double>& state() const { return random_.state; }
    /// -∂V/∂q by a central difference of step h [m or rad].
    [[nodiscard]] double minus_gradient(int index, double h) { return -(potential(index, h) - potential(index, -h)) / (2.0 * h); }

private:
    double potential(int index, double moved) {
        auto there = random_.state;
        there[static_cast<std::size_t>(index)] += moved;
        const model::Account account = observer_.observe(0.0, there.data(), random_.phases.data()).account;
        return std::accumulate(account.energy.begin() + 1, account.energy.end(), 0.0);
    }

    model::Variator variator_;
    model::Observer observer_;
    oracle::RandomState random_;
    std::vector<double> slope_;
};

/// Depths are rounded to 1e-17 m, of ~100 contacts of ~5 kN: 1e-12 J, so h = 2e-9 m leaves 3e-4 N; h² V'''/6 is about K h²/sqrt(δ) = 3e-5
/// N, and 1e-1 N where a contact or a clearance opens within h (stiffness 1e9 N/m · h/10).
constexpr double h = 2e-9;

model::Parameters conservative(const std::string& level) {
    model::Parameters p = at_level(oracle::small_scene(), level);
    make_conservative(p);
    return p;
}

class ElasticForces : public testing::TestWithParam<std::string> {};

TEST_P(ElasticForces, OnLinksAreMinusTheGradientOfTheObservedEnergy) {
    Gradient gradient(conservative(GetParam()));
    const model::ChainLayout& at = gradient.variator().layout();
    for (int link = 0; link < at.links; ++link) {
        const auto force = gradient.force(link);
        for (int k = 0; k < at.link_size(); ++k) {
            const double expected = gradient.minus_gradient(at.link_begin(link) + k, h);
            EXPECT_NEAR(force[static_cast<std::size_t>(k)], expected, 5e-3 + 1e-6 * std::abs(expected))
                << "link " << link << ", coordinate " << k;
        }
    }
}

TEST_P(ElasticForces, OnPulleysAreMinusTheGradientPlusInputs) {
    const model::Parameters p = conservative(GetParam());
    Gradient gradient(p);
    const model::ChainLayout& at = gradient.variator().layout();
    const model::PulleyModel& pulleys = gradient.variator().pulleys();
    const double* block = gradient.state().data() + at.pulley_begin();
    const model::Inputs inputs = pulleys.inputs().at(0.0, block);
    std::vector<double> other(static_cast<std::size_t>(2 * at.pulley_size));  // what inputs and gyroscopic moments do alone, from rest
    std::vector<double> straight(block, block + 2 * at.pulley_size);
    std::fill_n(straight.begin(), at.pulley_size, 0.0);
    pulleys.slope(straight.data(), inputs, {}, other.data(), nullptr);
    for (int k = 0; k < at.pulley_size; ++k) {
        const double force = pulleys.inertia(k) *
                             (gradient.slope(at.pulley_begin() + at.pulley_size + k) - other[static_cast<std::size_t>(at.pulley_size + k)]);
        const double expected = gradient.minus_gradient(at.pulley_begin() + k, h);
        EXPECT_NEAR(force, expected, 5e-3 + 1e-6 * std::abs(expected)) << "coordinate " << k;
    }
}

TEST_P(ElasticForces, AtRestAreTheSameWithMassScaling) {
    model::Parameters p = at_level(oracle::small_scene(), GetParam());
    oracle::RandomState still = oracle::random_state(p, 22);
    const model::ChainLayout at = model::layout_of(p);
    for (int link = 0; link < at.links; ++link)
        std::fill_n(still.state.begin() + at.link_begin(link) + at.link_size(), at.link_size(), 0.0);
    std::fill_n(still.state.begin() + at.pulley_begin() + at.pulley_size, at.pulley_size, 0.0);
    const Gradient unscaled(p, still);
    p.detail.mass_scaling = 30.0;
    const Gradient slowed(p, still);
    for (int link = 0; link < at.links; ++link) {
        const auto force = unscaled.force(link), other = slowed.force(link);
        const double largest =
            std::abs(*std::max_element(force.begin(), force.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }));
        // Through accelerations and back: matrices of a condition below 3000.
        for (std::size_t k = 0; k < force.size(); ++k)
            EXPECT_NEAR(other[k], force[k], 1e-12 * largest) << "link " << link << ", coordinate " << k;
    }
}

INSTANTIATE_TEST_SUITE_P(EveryLevel, ElasticForces, testing::ValuesIn(levels()), [](const auto& level) { return level.param; });

}  // namespace
}  // namespace cvtflow::claims
