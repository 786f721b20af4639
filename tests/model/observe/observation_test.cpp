#include "model/observe/observation.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>

#include "model/start/start_state.hpp"
#include "tests/oracle/oracle_cases.hpp"

namespace cvtflow::model {
namespace {

/// Relative 1e-10: depths of µm are known to 1e-17 m, and energies and losses go with their squares.
void expect_same(double value, double expected, const char* what) {
    EXPECT_NEAR(value, expected, 1e-10 * std::abs(expected) + 1e-12) << what;
}

TEST(Observation, EnergiesLossesAndWorksAreTheOracles) {
    for (int order = 0; order <= 3; ++order) {
        Parameters p = oracle::small_scene();
        p.detail.order = order;
        p.control.enabled = true;
        const Variator variator(p);
        Observer observer(variator);
        const auto random = oracle::random_state(p, 11);
        const Observation& now = observer.observe(2e-3, random.state.data(), random.phases.data());
        const auto expected = oracle::right_hand_side(p, 2e-3, random.state, random.phases);
        const auto& e = expected.energies;
        expect_same(now.account[Energy::kinetic], e.kinetic, "kinetic");
        expect_same(now.account[Energy::inner], e.inner, "inner");
        expect_same(now.account[Energy::pack], e.pack, "pack");
        expect_same(now.account[Energy::plates], e.plates, "plates");
        expect_same(now.account[Energy::joints], e.joints, "joints");
        expect_same(now.account[Energy::tips], e.tips, "tips");
        expect_same(now.account[Energy::supports], e.supports, "supports");
        for (std::size_t k = 0; k < loss_kinds; ++k) expect_same(now.account.loss[k], expected.powers.losses[k], "loss");
        for (std::size_t k = 0; k < work_kinds; ++k) expect_same(now.work[k], expected.powers.works[k], "work");
    }
}

TEST(Observation, AxialForcesOfTheSheavesAreTheSumsOfTheirTips) {
    const Parameters p = oracle::small_scene();
    const Variator variator(p);
    Observer observer(variator);
    const auto random = oracle::random_state(p, 12);
    const Observation& now = observer.observe(0.0, random.state.data(), random.phases.data());
    std::array<double, 4> sums{};
    int touching = 0;
    for (int link = 0; link < p.chain.pins; ++link) {
        const int shaft = variator.chain().shaft_of(random.state.data() + variator.layout().link_begin(link));
        for (int tip = 0; tip < tips_per_link; ++tip) {
            const std::size_t number = static_cast<std::size_t>(tips_per_link * link + tip);
            sums[static_cast<std::size_t>(2 * shaft + tip % 2)] += now.tip_axial[number];
            touching += random.phases[number] == Phase::free ? 0 : 1;
        }
    }
    EXPECT_EQ(now.touching, touching);
    for (std::size_t sheave = 0; sheave < 4; ++sheave) {
        EXPECT_NEAR(now.axial_force[sheave], sums[sheave], 1e-9 * std::abs(sums[sheave]));
        EXPECT_GT(std::abs(sums[sheave]), 1.0);
        EXPECT_EQ(sums[sheave] > 0.0, sheave % 2 == 1) << "the chain spreads the sheaves apart";
    }
}

TEST(Observation, TheDeepestTipIsTheOneThatDetectionWouldFind) {
    const Parameters p = oracle::small_scene();
    const Variator variator(p);
    const ChainLayout& at = variator.layout();
    const auto random = oracle::random_state(p, 13);
    SheaveMotion sheaves[4];
    variator.pulleys().motions(random.state.data() + at.pulley_begin(), sheaves);
    double deepest = 0.0;
    for (int link = 0; link < at.links; ++link) {
        NeighbourWindow strip;
        TipProbe probe;
        variator.chain().probe(strip.of(at, random.state.data(), link), sheaves, false, probe);
        for (int tip = 0; tip < tips_per_link; ++tip) {
            const bool touching = random.phases[static_cast<std::size_t>(tips_per_link * link + tip)] != Phase::free;
            if (touching) deepest = std::max(deepest, probe.depth[tip]);
        }
    }
    Observer observer(variator);
    EXPECT_GT(deepest, 0.0);
    EXPECT_EQ(observer.observe(0.0, random.state.data(), random.phases.data()).deepest, deepest);
}

/// Moves the front half of a link so that all its plates are longer by `length` than when free.
void stretch(const Parameters& p, double length, int link, std::vector<double>& state) {
    const ChainLayout at = layout_of(p);
    double* q = state.data() + at.link_begin(link);
    const auto across = [&](int rear, int front) { return q[front] - q[rear]; };
    const double dx = across(at.x(End::rear, 0), at.x(End::front, 0)), dy = across(at.y(End::rear, 0), at.y(End::front, 0));
    const double dz = across(at.z(End::rear), at.z(End::front));
    const double share = (p.chain.pitch[0] + p.half.width + length) / std::hypot(dx, dy, dz) - 1.0;
    q[at.x(End::front, 0)] += share * dx;
    q[at.y(End::front, 0)] += share * dy;
    q[at.z(End::front)] += share * dz;
}

TEST(Observation, TensionIsPositiveWherePlatesAreStretchedAndTheUpperStrandIsTight) {
    Parameters p;
    p.drive.speed = TimeTable(0.0);  // no pre-tension
    const Variator variator(p);
    Observer observer(variator);
    StartState start = start_state(p);
    const ChainLayout& at = variator.layout();
    const auto side = [&](int link) { return start.state[static_cast<std::size_t>(at.link_begin(link) + at.y(End::rear, 0))]; };
    for (int link = 0; link < p.chain.pins; ++link) stretch(p, side(link) > 0.0 ? 3e-6 : -1e-6, link, start.state);
    const Observation& now = observer.observe(0.0, start.state.data(), start.phases.data());
    const double stiffness = p.plate.count * p.plate.stiffness;
    for (int link = 0; link < p.chain.pins; ++link) {
        // Lengths of 10 mm are known to 3e-17 m: 3e-8 N.
        EXPECT_NEAR(now.tension[static_cast<std::size_t>(link)], stiffness * (side(link) > 0.0 ? 3e-6 : -1e-6), 1e-6);
    }
    EXPECT_NEAR(now.tight, 3e-6 * stiffness, 1e-6);
    EXPECT_NEAR(now.slack, -1e-6 * stiffness, 1e-6);
}

TEST(Observation, ARingHasOneTension) {
    Parameters p;
    p.detail.pulleys = PulleyDetail::absent;
    p.start.layout = StartLayout::ring;
    const Variator variator(p);
    Observer observer(variator);
    const StartState start = start_state(p);
    const Observation& now = observer.observe(0.0, start.state.data(), start.phases.data());
    const double mean = std::accumulate(now.tension.begin(), now.tension.end(), 0.0) / p.chain.pins;
    EXPECT_NEAR(now.tight, mean, 1e-9 * mean);
    EXPECT_EQ(now.slack, now.tight);
    EXPECT_NEAR(now.chain_speed, start.speed, 1e-3 * start.speed);  // halves sit a millimetre beside the pitch line
}

TEST(Observation, SpeedsRatioSlipAndRadiusAreTheStarts) {
    Parameters p;
    p.start.ratio = 1.6;
    const Variator variator(p);
    Observer observer(variator);
    StartState start = start_state(p);
    for (int link = 0; link < p.chain.pins; ++link) {  // let everything count that lies on an arc
        const double* block = start.state.data() + variator.layout().link_begin(link);
        const double x = block[0];
        const bool on_arc = x < -0.3 * start.radii.driving || x > p.pulley.centre_distance + 0.3 * start.radii.driven;
        std::fill_n(start.phases.begin() + tips_per_link * link, tips_per_link, on_arc ? Phase::touching : Phase::free);
    }
    const Observation& now = observer.observe(-p.start.settling_time, start.state.data(), start.phases.data());
    EXPECT_NEAR(now.ratio, 1.6, 0.01 * 1.6);  // radii are in that ratio; a chain bent more strongly is a little shorter
    EXPECT_NEAR(now.radius[0], start.radii.driving, 1e-12);
    EXPECT_NEAR(now.radius[1], start.radii.driven, 1e-12);
    EXPECT_NEAR(now.slip, 0.0, 1e-4);  // the polygon of pins: their mean speed depends on which lie on the arc
    EXPECT_NEAR(now.speed[0], p.drive.speed.at(0.0), 1e-10);
    EXPECT_NEAR(now.torque[0], 0.0, 1e-6);  // the start runs at the governor's speed and angle
}

}  // namespace
}  // namespace cvtflow::model
