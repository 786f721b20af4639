/// Observations: energies, losses and works, forces inside the chain against the oracle's, and creep against the forces that are computed
/// otherwise.

#include "model/observe/observation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "model/observe/chain_forces.hpp"
#include "model/start/start_state.hpp"
#include "tests/oracle/friction.hpp"
#include "tests/oracle/oracle_cases.hpp"
#include "tests/oracle/system.hpp"

namespace cvtflow::model {
namespace {

using oracle::Real;

/// Relative 1e-10: depths of µm are known to 1e-17 m, and energies and losses go with their squares.
void expect_same(double value, double expected, const char* what) {
    EXPECT_NEAR(value, expected, 1e-10 * std::abs(expected) + 1e-12) << what;
}

TEST(Observation, EnergiesLossesAndWorksAreTheOracles) {
    Parameters p = oracle::small_scene();
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

/// A random state as production observes it and as the oracle unpacks it. Without damping, forces follow from positions and slip alone.
struct Seen {
    explicit Seen(const Parameters& p, std::uint64_t seed = 21)
        : parameters(p),
          variator(p),
          observer(variator),
          random(oracle::random_state(p, seed)),
          exact(random.state.begin(), random.state.end()),
          system(oracle::unpack(parameters, 0.0, exact, random.phases)) {
        observation = observer.observe(0.0, random.state.data(), random.phases.data());
        forces = observer.forces();
    }

    Parameters parameters;
    Variator variator;
    Observer observer;
    oracle::RandomState random;
    std::vector<Real> exact;
    oracle::System system;
    Observation observation;
    ForceObservation forces;
};

Parameters undamped() {
    Parameters p = oracle::small_scene();
    p.chain.damping_ratio = 0.0;
    return p;
}

/// Relative 1e-9 of the largest force around: depths of µm are known to 1e-17 m.
void expect_force(double value, Real expected, double scale, const char* what) {
    EXPECT_NEAR(value, static_cast<double>(expected), 1e-9 * scale) << what;
}

TEST(ChainForces, TipsPressAndRubAsTheOraclesContactsDo) {
    Parameters p = undamped();
    const Seen seen(p);
    int touching = 0;
    for (int tip = 0; tip < tips_per_link * p.chain.pins; ++tip) {
        const std::size_t n = static_cast<std::size_t>(tip);
        const End end = tip / 2 % 2 == 0 ? End::rear : End::front;
        const oracle::Link& link = seen.system.links[n / tips_per_link];
        const auto contact = oracle::tip_contact(seen.system, link, end, tip % 2);
        if (seen.random.phases[n] == Phase::free || contact.depth <= 0.0L) {
            EXPECT_EQ(seen.forces.chain.tip_normal[n], 0.0);
            continue;
        }
        const Real normal = p.tip.hertz * contact.depth * std::sqrt(contact.depth);
        const auto sliding = oracle::tip_sliding(seen.system, link, end, contact).tangential;
        const Real grip = p.tip.friction.coefficient * normal * oracle::friction_slope(p.detail, p.tip.friction, norm(sliding));
        const oracle::Vec3 on_sheave = -(normal * contact.normal) + grip * sliding;
        const oracle::Vec3 point = contact.centre - Real{p.tip.radius} * contact.normal;
        const oracle::Vec2 outward = unit(in_plane(point) - oracle::Vec2{contact.shaft * Real{p.pulley.centre_distance}, 0.0L});
        expect_force(seen.forces.chain.tip_normal[n], normal, 1e3, "normal");
        expect_force(seen.forces.chain.tip_radial[n], dot(outward, in_plane(on_sheave)), 1e3, "radial");
        expect_force(seen.forces.chain.tip_tangential[n], cross(outward, in_plane(on_sheave)), 1e3, "tangential");
        ++touching;
    }
    EXPECT_GT(touching, 5);
}

TEST(ChainForces, EveryPlateIsASpringBetweenTheHalves) {
    for (const PlateDetail detail : {PlateDetail::each, PlateDetail::lumped}) {
        Parameters p = undamped();
        p.detail.plates = detail;
        const Seen seen(p);
        const auto springs = oracle::plate_springs(p);
        ASSERT_EQ(seen.forces.chain.plates_per_link, static_cast<int>(springs.size()));
        std::size_t plate = 0;
        for (const oracle::Link& link : seen.system.links) {
            for (const oracle::PlateSpring& spring : springs) {
                const oracle::Vec2 across = link.front.at(spring.xi) - link.rear.at(spring.xi);
                const Real along = link.front.z - link.rear.z + spring.xi * (link.front.e - link.rear.e);
                const Real length = norm(in_space(across, along));
                expect_force(seen.forces.chain.plate_tension[plate++], spring.stiffness * (length - link.rest_length), 1e3, "plate");
            }
        }
        EXPECT_EQ(plate, seen.forces.chain.plate_tension.size());
    }
}

TEST(ChainForces, DampingOfPlatesAddsTheirRateOfLengthening) {
    Parameters p = undamped();
    const Seen without(p);
    p.chain.damping_ratio = 0.05;
    const Seen with(p);
    const auto springs = oracle::plate_springs(p);
    const oracle::Link& link = with.system.links.front();
    const Real xi = springs.front().xi;
    const oracle::Vec3 across =
        in_space(link.front.at(xi) - link.rear.at(xi), link.front.z - link.rear.z + xi * (link.front.e - link.rear.e));
    const oracle::Vec3 rate = in_space(link.front.rate_at(xi) - link.rear.rate_at(xi),
                                       link.front.z_rate - link.rear.z_rate + xi * (link.front.e_rate - link.rear.e_rate));
    const Real lengthening = dot(across, rate) / norm(across);
    ASSERT_GT(std::abs(static_cast<double>(springs.front().damping * lengthening)), 1e-3);
    expect_force(with.forces.chain.plate_tension[0] - without.forces.chain.plate_tension[0], springs.front().damping * lengthening, 1e3,
                 "plate");
}

TEST(ChainForces, JointsPressWithTheirDepthAndRubWithTheirSlip) {
    Parameters p = undamped();
    p.detail.joint_points = 1;  // in the middle, with all of the stiffness
    const Seen seen(p);
    const Real arm = Real{p.joint.radius} - Real{p.half.width} / 2.0L;
    int pressed = 0;
    for (int pin = 0; pin < p.chain.pins; ++pin) {
        const std::size_t n = static_cast<std::size_t>(pin);
        const oracle::Link& before = seen.system.links[static_cast<std::size_t>(seen.system.layout.previous(pin))];
        const oracle::Link& after = seen.system.links[n];
        const oracle::Vec2 delta = before.front.at(0.0L) + arm * before.t - (after.rear.at(0.0L) - arm * after.t);
        const oracle::Vec2 normal = unit(delta);
        const Real press = Real{p.joint.stiffness} * std::max(0.0L, 2.0L * Real{p.joint.radius} - norm(delta));
        const oracle::Vec2 point = after.rear.at(0.0L) - arm * after.t + (norm(delta) / 2.0L) * normal;
        const oracle::Vec2 of_before = before.front.rate_at(0.0L) + before.turning * left_of(point - before.front.at(0.0L));
        const oracle::Vec2 of_after = after.rear.rate_at(0.0L) + after.turning * left_of(point - after.rear.at(0.0L));
        const Real slip = dot(of_before - of_after, left_of(normal)), axial = before.front.z_rate - after.rear.z_rate;
        const Real grip = p.joint.friction.coefficient * press *
                          oracle::friction_slope(p.detail, p.joint.friction, std::sqrt(slip * slip + axial * axial));
        expect_force(seen.forces.chain.joint_normal[n], press, 1e4, "normal");
        expect_force(seen.forces.chain.joint_friction[n], -grip * slip, 1e4, "friction");
        expect_force(seen.forces.chain.joint_axial[n], -grip * axial, 1e4, "axial friction");
        pressed += press > 0.0L ? 1 : 0;
    }
    EXPECT_GT(pressed, 3);
}

TEST(ChainForces, BendingMomentIsRigidityTimesCurvatureAndAxialForceAreaTimesStress) {
    Parameters p = undamped();
    const Seen seen(p);
    std::size_t half = 0;
    for (const oracle::Link& link : seen.system.links) {
        for (const oracle::Half* of : {&link.rear, &link.front}) {
            const Real h = 0.5L, step = h * of->length / 2.0L;  // a cubic's second difference is exact
            const oracle::Vec2 curvature = (1.0L / (step * step)) * (of->at(h) - 2.0L * of->at(0.0L) + of->at(-h));
            const Real travel = p.half.bending_travel * dot(curvature, link.t);
            const Real height = p.half.bending_height * dot(curvature, link.n);
            expect_force(seen.forces.chain.bending_travel[half], travel, 1.0, "travel");
            expect_force(seen.forces.chain.bending_height[half], height, 1.0, "height");
            const Real stretched = 2.0L * (of->length / 2.0L + of->e);
            expect_force(seen.forces.chain.half_axial[half], p.chain.young_modulus * p.half.area * (stretched / of->length - 1.0L), 1e3,
                         "axial");
            ++half;
        }
    }
}

/// Forces of the tips on one shaft's sheaves in the plane, from their radial and tangential parts at the oracle's contact points.
oracle::Vec2 sum_in_plane(const Seen& seen, int shaft) {
    oracle::Vec2 sum;
    for (int tip = 0; tip < tips_per_link * seen.parameters.chain.pins; ++tip) {
        const std::size_t n = static_cast<std::size_t>(tip);
        const auto contact =
            oracle::tip_contact(seen.system, seen.system.links[n / tips_per_link], tip / 2 % 2 == 0 ? End::rear : End::front, tip % 2);
        if (contact.shaft != shaft) continue;
        const oracle::Vec3 point = contact.centre - Real{seen.parameters.tip.radius} * contact.normal;
        const oracle::Vec2 outward = unit(in_plane(point) - oracle::Vec2{shaft * Real{seen.parameters.pulley.centre_distance}, 0.0L});
        sum += Real{seen.forces.chain.tip_radial[n]} * outward + Real{seen.forces.chain.tip_tangential[n]} * left_of(outward);
    }
    return sum;
}

/// Newton's law for shaft and sheaves together: forces of the chain less those of the bearings accelerate them.
TEST(ChainForces, BearingsCarryWhatTheChainGivesLessWhatAcceleratesTheShaft) {
    Parameters p = oracle::small_scene();
    const Seen seen(p);
    const auto forces = oracle::right_hand_side(p, 0.0, seen.random.state, seen.random.phases).forces;
    const std::size_t first = static_cast<std::size_t>(p.chain.pins * seen.system.layout.link_size());
    for (int shaft = 0; shaft < 2; ++shaft) {
        const auto total = [&](int freedom) {
            double sum = forces[first + static_cast<std::size_t>(body_freedom(shaft, freedom))];
            for (int side = 0; side < 2; ++side)
                sum += forces[first + static_cast<std::size_t>(body_freedom(sheave_body(shaft, side), freedom))];
            return sum;
        };
        const oracle::Vec2 chain = sum_in_plane(seen, shaft);
        const std::size_t k = static_cast<std::size_t>(shaft);
        const auto& bearing = seen.forces.bearing[k].force;
        expect_force(bearing[0], chain.x - Real{total(0)}, 1e4, "x");
        expect_force(bearing[1], chain.y - Real{total(1)}, 1e4, "y");
        const auto& axial = seen.observation.axial_force;
        expect_force(bearing[2], Real{axial[2 * k] + axial[2 * k + 1]} - Real{total(4)}, 1e4, "axial");
    }
}

TEST(ChainForces, BearingsOfRigidPulleysCarryAllThatTheChainGives) {
    Parameters p = oracle::small_scene();
    p.detail.pulleys = PulleyDetail::rigid;
    const Seen seen(p);
    const auto forces = oracle::right_hand_side(p, 0.0, seen.random.state, seen.random.phases).forces;
    const std::size_t first = static_cast<std::size_t>(p.chain.pins * seen.system.layout.link_size());
    for (std::size_t shaft = 0; shaft < 2; ++shaft) {
        const oracle::Vec2 chain = sum_in_plane(seen, static_cast<int>(shaft));
        const auto& bearing = seen.forces.bearing[shaft].force;
        expect_force(bearing[0], chain.x, 1e4, "x");
        expect_force(bearing[1], chain.y, 1e4, "y");
        const auto& axial = seen.observation.axial_force;  // less what accelerates the movable sheave
        expect_force(bearing[2], Real{axial[2 * shaft] + axial[2 * shaft + 1]} - Real{forces[first + 2 + shaft]}, 1e4, "axial");
    }
}

/// The chain runs in the middle of both grooves: pins on one pulley lie beside those on the other.
TEST(ChainForces, MisalignmentIsTheDistanceOfTheGrooves) {
    const Seen seen(oracle::small_scene());
    const auto& body = seen.system.body;
    const Real expected = 0.5L * (body[2].w + body[3].w) - 0.5L * (body[4].w + body[5].w);
    EXPECT_NEAR(seen.forces.misalignment, static_cast<double>(expected), 1e-16);  // rounding of coordinates of 18 mm
    EXPECT_NE(seen.forces.misalignment, 0.0);
}

TEST(ChainForces, AreOfTheInstantThatWasObservedLast) {
    const Parameters p = undamped();
    Variator variator(p);
    Observer observer(variator);
    const auto one = oracle::random_state(p, 1), other = oracle::random_state(p, 2);
    observer.observe(0.0, one.state.data(), one.phases.data());
    const double first = observer.forces().chain.joint_normal[0];
    observer.observe(0.0, other.state.data(), other.phases.data());
    EXPECT_NE(observer.forces().chain.joint_normal[0], first);
    observer.observe(0.0, one.state.data(), one.phases.data());
    EXPECT_EQ(observer.forces().chain.joint_normal[0], first);
}

/// Halves on rigid pulleys, which do not tilt: normal forces put no torque on them.
Parameters on_rigid_pulleys() {
    Parameters p = oracle::small_scene();
    p.detail.pulleys = PulleyDetail::rigid;
    return p;
}

TEST(Creep, DragIsTheTorqueOfTheChainOnRigidPulleys) {
    const Parameters p = on_rigid_pulleys();
    const Variator variator(p);
    Observer observer(variator);
    const auto random = oracle::random_state(p, 21);
    const Observation& now = observer.observe(0.0, random.state.data(), random.phases.data());
    const Creep& creep = now.creep;
    for (std::size_t k = 0; k < 2; ++k) {  // sums of tips in another order: rounding
        EXPECT_NE(now.chain_torque[k], 0.0);
        EXPECT_NEAR(creep.drag[k], now.chain_torque[k], 1e-11 * std::abs(now.chain_torque[k]) + 1e-11);
        EXPECT_NEAR(now.free_speed[k], now.speed[k] + now.chain_torque[k] / creep.hold[k], 1e-9 * std::abs(now.free_speed[k]));
    }
}

TEST(Creep, LosesAPartOfWhatTheFrictionOfTipsLoses) {
    const Parameters p = on_rigid_pulleys();
    const Variator variator(p);
    Observer observer(variator);
    const auto random = oracle::random_state(p, 22);
    const Observation& now = observer.observe(0.0, random.state.data(), random.phases.data());
    EXPECT_GT(now.creep.power, 0.0);
    EXPECT_LT(now.creep.power, now.account[Loss::tip_friction]) << ": pins slide radially as well";
}

TEST(Creep, IsNoneWhereNoTipTouches) {
    const Parameters p = oracle::small_scene();
    const Variator variator(p);
    Observer observer(variator);
    auto random = oracle::random_state(p, 23);
    std::fill(random.phases.begin(), random.phases.end(), Phase::free);
    const Observation& now = observer.observe(0.0, random.state.data(), random.phases.data());
    EXPECT_EQ(now.free_speed, now.speed);
    EXPECT_EQ(now.creep.power, 0.0);
    EXPECT_EQ(now.friction_slip, 0.0);
}

}  // namespace
}  // namespace cvtflow::model
