/// Recipe "a force element": the strut of strut.hpp, compiled into the kernels of both chains and into the exact Jacobian, and written a
/// second time for the oracle.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "bench/method/jacobian/jacobian.hpp"
#include "model/observe/observation.hpp"
#include "model/variator/variator.hpp"
#include "tests/oracle/oracle_cases.hpp"
#include "tests/oracle/rigid_pins.hpp"
#include "tests/recipes/strut.hpp"

namespace cvtflow::recipes {
namespace {

using model::Energy;
using model::FurtherElement;
using model::Loss;
using oracle::Real;

// The second, plain implementation (tests/oracle).

struct PlainStrut {
    oracle::Vec2 force;  ///< force on the front half
    PlainStrut(oracle::Vec2 apart, oracle::Vec2 rate, oracle::Totals& totals) {
        const Real distance = norm(apart), beyond = distance - Real{FurtherElement::length};
        const oracle::Vec2 along = (1.0L / distance) * apart;
        const Real opening = dot(along, rate);
        force = -(FurtherElement::stiffness * beyond + FurtherElement::damping * opening) * along;
        totals.energies.pack += 0.5L * FurtherElement::stiffness * beyond * beyond;
        totals.loss(Loss::inner) += FurtherElement::damping * opening * opening;
    }
};

void add_to_halves(const oracle::System& system, oracle::Totals& totals) {
    for (std::size_t i = 0; i < system.links.size(); ++i) {
        const oracle::Half &rear = system.links[i].rear, &front = system.links[i].front;
        const PlainStrut strut(front.shape[0] - rear.shape[0], front.shape_rate[0] - rear.shape_rate[0], totals);
        totals.link[i].front.shape[0] += strut.force;
        totals.link[i].rear.shape[0] += -strut.force;
    }
}

void add_to_rigid_link(oracle::PinForces& forces, int link) {
    const oracle::PinHalf rear = forces.chain.half(link, model::End::rear), front = forces.chain.half(link + 1, model::End::front);
    const PlainStrut strut(front.at - rear.at, front.rate - rear.rate, forces.totals);
    forces.push(front, strut.force, 0.0L);
    forces.push(rear, -strut.force, 0.0L);
    forces.pull[static_cast<std::size_t>(link)] += strut.force;
}

/// Both chains, with the strut in the oracle while a test runs.
class ForceRecipe : public ::testing::TestWithParam<model::PinDetail> {
protected:
    ForceRecipe() { oracle::further_element() = {add_to_halves, add_to_rigid_link}; }
    ~ForceRecipe() override { oracle::further_element() = {}; }

    [[nodiscard]] model::Parameters machine() const {
        const model::Parameters p = oracle::small_scene();
        return GetParam() == model::PinDetail::rigid ? oracle::with_rigid_pins(p) : p;
    }
    /// The chain alone, as a ring.
    [[nodiscard]] model::Parameters ring() const {
        model::Parameters p = machine();
        p.detail.pulleys = model::PulleyDetail::absent;
        p.start.layout = model::StartLayout::ring;
        return p;
    }
};

std::vector<double> slope_of(const model::Variator& variator, const std::vector<double>& y, const std::vector<model::Phase>& phases) {
    model::EvaluationScratch scratch(variator.layout());
    std::vector<double> slope(y.size());
    model::right_hand_side(variator, 1e-3, y.data(), phases.data(), slope.data(), scratch);
    return slope;
}

/// Largest number, or difference of two, among the accelerations of the chain.
double largest(const model::ChainLayout& at, const std::vector<double>& a, const std::vector<double>& b) {
    double most = 0.0;
    for (int k = 0; k < at.pulley_begin(); ++k) {
        const std::size_t place = static_cast<std::size_t>(k);
        if (k % at.link_block() >= at.link_size()) most = std::max(most, std::abs(a[place] - b[place]));
    }
    return most;
}

TEST_P(ForceRecipe, KernelsAgreeWithTheOracleAndEnergyAndLossAreObserved) {
    const model::Parameters p = machine();
    const model::Variator variator(p, model::CVTFLOW_FURTHER_ISA);
    const oracle::RandomState random = oracle::random_state(p, 11);
    const auto expected = oracle::right_hand_side(p, 1e-3, random.state, random.phases);
    oracle::further_element() = {};
    const auto without = oracle::right_hand_side(p, 1e-3, random.state, random.phases);
    const auto found = slope_of(variator, random.state, random.phases);
    const double size = largest(variator.layout(), expected.slope, std::vector<double>(expected.slope.size()));
    EXPECT_LT(largest(variator.layout(), found, expected.slope), 1e-12 * size);  // as of all elements (variator_test.cpp)
    EXPECT_GT(largest(variator.layout(), found, without.slope), 1e-3 * size);
    model::Observer observer(variator);
    const model::Account account = observer.observe(1e-3, random.state.data(), random.phases.data()).account;
    const std::size_t inner = static_cast<std::size_t>(Loss::inner);
    EXPECT_NEAR(account[Energy::pack] / expected.energies.pack, 1.0,
                1e-10);  // squares of deflections, which are differences: 1e-16 m/1e-6 m
    EXPECT_NEAR(account[Loss::inner] / expected.powers.losses[inner], 1.0, 1e-10);
    EXPECT_GT(expected.energies.pack, 1.001 * without.energies.pack);
    EXPECT_GT(expected.powers.losses[inner], 1.001 * without.powers.losses[inner]);
}

/// The ledger of a run adds up the observed rates: the power of all forces is the change of energy and the loss.
TEST_P(ForceRecipe, PowerIsChangeOfEnergyAndLoss) {
    const model::Parameters p = ring();
    const model::Variator variator(p, model::CVTFLOW_FURTHER_ISA);
    const oracle::RandomState random = oracle::random_state(p, 13);
    const auto slope = slope_of(variator, random.state, random.phases);
    model::Observer observer(variator);
    const auto stored = [&](double time) {
        std::vector<double> y = random.state;
        for (std::size_t k = 0; k < y.size(); ++k) y[k] += time * slope[k];
        const model::Account& account = observer.observe(0.0, y.data(), random.phases.data()).account;
        return std::accumulate(account.energy.begin(), account.energy.end(), 0.0);
    };
    const model::Account account = observer.observe(0.0, random.state.data(), random.phases.data()).account;
    const double lost = std::accumulate(account.loss.begin(), account.loss.end(), 0.0);
    constexpr double step = 1e-9;  // s
    EXPECT_NEAR((stored(step) - stored(-step)) / (2.0 * step) / lost, -1.0, 1e-4);
    EXPECT_GT(account[Loss::inner], 1e-3 * lost);
}

/// Accelerations of a link by one of its coordinates, by differences of the oracle.
std::vector<double> oracle_column(const model::Parameters& p, const oracle::RandomState& random, int begin, int size, int coordinate) {
    const auto moved = [&](Real by) {
        std::vector<Real> y(random.state.begin(), random.state.end());
        y[static_cast<std::size_t>(begin + coordinate)] += by;
        return oracle::exact_right_hand_side(p, 0.0, y, random.phases).slope;
    };
    constexpr Real step = 1e-9L;  // m
    const auto up = moved(step), down = moved(-step);
    std::vector<double> column(static_cast<std::size_t>(size));
    for (int row = 0; row < size; ++row) {
        const std::size_t place = static_cast<std::size_t>(begin + size + row);
        column[static_cast<std::size_t>(row)] = static_cast<double>((up[place] - down[place]) / (2.0L * step));
    }
    return column;
}

/// Halves: the exact Jacobian. Rigid pins have none: bench/method/jacobian takes differences of their kernels.
TEST_P(ForceRecipe, JacobianAgreesWithDifferencesOfTheOracle) {
    model::Parameters p = ring();
    oracle::make_conservative(p);
    const model::Variator variator(p, model::CVTFLOW_FURTHER_ISA);
    const model::ChainLayout& at = variator.layout();
    const oracle::RandomState random = oracle::random_state(p, 14);
    const int size = at.link_size(), begin = at.link_begin(2);
    bench::AccelerationJacobian exact(at);
    std::vector<double> differences;
    if (GetParam() == model::PinDetail::rigid)
        differences = bench::difference_jacobian(variator, 0.0, random.state, random.phases);
    else
        bench::ExactJacobian(variator).links(random.state.data(), random.phases.data(), 0, at.links, exact);
    const auto entry = [&](int row, int column) {
        if (GetParam() != model::PinDetail::rigid) return exact.link(2, bench::Near::same, bench::With::position)[row * size + column];
        return differences[static_cast<std::size_t>(begin + column) * static_cast<std::size_t>(at.size()) +
                           static_cast<std::size_t>(begin + size + row)];
    };
    double error = 0.0, most = 0.0, change = 0.0;
    for (int column = 0; column < size; ++column) {
        oracle::further_element() = {add_to_halves, add_to_rigid_link};
        const auto expected = oracle_column(p, random, begin, size, column);
        oracle::further_element() = {};
        const auto without = oracle_column(p, random, begin, size, column);
        for (int row = 0; row < size; ++row) {
            const std::size_t place = static_cast<std::size_t>(row);
            error = std::max(error, std::abs(entry(row, column) - expected[place]));
            most = std::max(most, std::abs(expected[place]));
            change = std::max(change, std::abs(expected[place] - without[place]));
        }
    }
    EXPECT_LT(error, 1e-5 * most);  // differences of doubles: rounding 1e-16 over steps of 1e-9
    EXPECT_GT(change, 1e-4 * most);
}

INSTANTIATE_TEST_SUITE_P(BothChains, ForceRecipe, ::testing::Values(model::PinDetail::halves, model::PinDetail::rigid),
                         [](const auto& of) { return std::string(name_of(of.param)); });

}  // namespace
}  // namespace cvtflow::recipes
