/// Observations: energies, losses and works, forces inside the chain against the oracle's, and creep against the forces that are computed
/// otherwise.

#include "model/observe/observation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "model/observe/chain_forces.hpp"
#include "model/start/start_state.hpp"
#include "tests/oracle/friction.hpp"
#include "tests/oracle/oracle_cases.hpp"
#include "tests/oracle/system.hpp"

namespace cvtflow::model {
namespace {

using oracle::Real;

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

/// Both chains. Relative 1e-10 (rigid pins: 1e-11): depths of µm are known to 1e-17 m, and energies and losses go with their squares.
TEST(Observation, EnergiesLossesAndWorksAreTheOracles) {
    model::Parameters controlled = oracle::small_scene();
    controlled.control.enabled = true;
    std::vector<oracle::Case> cases = oracle::rigid_details(controlled);
    cases.push_back({"halves", controlled});
    for (const oracle::Case& one : cases) {
        SCOPED_TRACE(one.name);
        const Seen seen(one.parameters, 11);
        const auto expected = oracle::right_hand_side(one.parameters, 0.0, seen.random.state, seen.random.phases);
        const double relative = seen.variator.layout().rigid ? 1e-11 : 1e-10;
        const auto expect_same = [&](double value, double exact, std::size_t kind) {
            EXPECT_NEAR(value, exact, relative * std::abs(exact) + 1e-12) << kind;
        };
        const auto& e = expected.energies;
        const std::array<double, energy_kinds> energies{e.kinetic, e.inner, e.pack, e.plates, e.joints, e.tips, e.supports};
        for (std::size_t k = 0; k < energies.size(); ++k) expect_same(seen.observation.account.energy[k], energies[k], k);
        if (seen.variator.layout().rigid) {
            EXPECT_NEAR(seen.observation.account.energy[0], e.kinetic, 1e-13 * e.kinetic) << "of no depths";
        }
        for (std::size_t k = 0; k < loss_kinds; ++k) expect_same(seen.observation.account.loss[k], expected.powers.losses[k], k);
        for (std::size_t k = 0; k < work_kinds; ++k) expect_same(seen.observation.work[k], expected.powers.works[k], k);
    }
}

TEST(Observation, AxialForcesOfTheSheavesAreTheSumsOfTheirTipsAndTheDeepestTipIsTheOneThatAProbeFinds) {
    const Seen seen(oracle::small_scene(), 12);
    const Observation& now = seen.observation;
    const ChainLayout& at = seen.variator.layout();
    SheaveMotion sheaves[4];
    seen.variator.pulleys().motions(seen.random.state.data() + at.pulley_begin(), sheaves);
    std::array<double, 4> sums{};
    int touching = 0;
    double deepest = 0.0;
    for (int link = 0; link < at.links; ++link) {
        const int shaft = seen.variator.chain().shaft_of(seen.random.state.data() + at.link_begin(link));
        NeighbourWindow strip;
        TipProbe probe;
        seen.variator.chain().probe(strip.of(at, seen.random.state.data(), link), sheaves, false, probe);
        for (int tip = 0; tip < tips_per_link; ++tip) {
            const std::size_t number = static_cast<std::size_t>(tips_per_link * link + tip);
            sums[static_cast<std::size_t>(2 * shaft + tip % 2)] += now.tip_axial[number];
            if (seen.random.phases[number] == Phase::free) continue;
            ++touching;
            deepest = std::max(deepest, probe.depth[tip]);
        }
    }
    EXPECT_EQ(now.touching, touching);
    EXPECT_GT(deepest, 0.0);
    EXPECT_EQ(now.deepest, deepest);
    for (std::size_t sheave = 0; sheave < 4; ++sheave) {
        EXPECT_NEAR(now.axial_force[sheave], sums[sheave], 1e-9 * std::abs(sums[sheave]));
        EXPECT_GT(std::abs(sums[sheave]), 1.0);
        EXPECT_EQ(sums[sheave] > 0.0, sheave % 2 == 1) << "the chain spreads the sheaves apart";
    }
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

TEST(ChainForces, EveryPlateIsASpringWithADamperBetweenTheHalves) {
    for (const PlateDetail detail : {PlateDetail::each, PlateDetail::lumped}) {
        Parameters p = oracle::small_scene();
        p.chain.damping_ratio = 0.05;
        p.detail.plates = detail;
        const Seen seen(p);
        const auto springs = oracle::plate_springs(p);
        ASSERT_EQ(seen.forces.chain.plates_per_link, static_cast<int>(springs.size()));
        std::size_t plate = 0;
        double damped = 0.0;
        for (const oracle::Link& link : seen.system.links) {
            for (const auto& [xi, mass, stiffness, damping] : springs) {
                const oracle::Vec3 across =
                    in_space(link.front.at(xi) - link.rear.at(xi), link.front.z - link.rear.z + xi * (link.front.e - link.rear.e));
                const oracle::Vec3 rate = in_space(link.front.rate_at(xi) - link.rear.rate_at(xi),
                                                   link.front.z_rate - link.rear.z_rate + xi * (link.front.e_rate - link.rear.e_rate));
                const Real length = norm(across), of_damper = damping * dot(across, rate) / length;
                expect_force(seen.forces.chain.plate_tension[plate++], stiffness * (length - link.rest_length) + of_damper, 1e3, "plate");
                damped = std::max(damped, std::abs(static_cast<double>(of_damper)));
            }
        }
        EXPECT_GT(damped, 1e-3);
        EXPECT_EQ(plate, seen.forces.chain.plate_tension.size());
    }
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

/// Newton's law for shaft and sheaves together: forces of the chain less those of the bearings accelerate them. Rigid pulleys only turn and
/// close: their bearings carry all that the chain gives, less what accelerates the movable sheave.
TEST(ChainForces, BearingsCarryWhatTheChainGivesLessWhatAcceleratesTheShaft) {
    for (const bool rigid : {false, true}) {
        Parameters p = oracle::small_scene();
        p.detail.pulleys = rigid ? PulleyDetail::rigid : PulleyDetail::elastic;
        const Seen seen(p);
        const auto forces = oracle::right_hand_side(p, 0.0, seen.random.state, seen.random.phases).forces;
        const std::size_t first = static_cast<std::size_t>(p.chain.pins * seen.system.layout.link_size());
        for (std::size_t shaft = 0; shaft < 2; ++shaft) {
            const int number = static_cast<int>(shaft);
            const auto accelerating = [&](int freedom) {
                if (rigid) return freedom == 4 ? forces[first + 2 + shaft] : 0.0;
                double sum = forces[first + static_cast<std::size_t>(body_freedom(number, freedom))];
                for (int side = 0; side < 2; ++side)
                    sum += forces[first + static_cast<std::size_t>(body_freedom(sheave_body(number, side), freedom))];
                return sum;
            };
            const oracle::Vec2 chain = sum_in_plane(seen, number);
            const auto& bearing = seen.forces.bearing[shaft].force;
            const auto& axial = seen.observation.axial_force;
            expect_force(bearing[0], chain.x - Real{accelerating(0)}, 1e4, "x");
            expect_force(bearing[1], chain.y - Real{accelerating(1)}, 1e4, "y");
            expect_force(bearing[2], Real{axial[2 * shaft] + axial[2 * shaft + 1]} - Real{accelerating(4)}, 1e4, "axial");
        }
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
    Seen one(undamped(), 1);
    const auto other = oracle::random_state(undamped(), 2);
    const auto observed = [&](const oracle::RandomState& at) {
        one.observer.observe(0.0, at.state.data(), at.phases.data());
        return one.observer.forces().chain.joint_normal[0];
    };
    EXPECT_NE(observed(other), one.forces.chain.joint_normal[0]);
    EXPECT_EQ(observed(one.random), one.forces.chain.joint_normal[0]);
}

/// Rigid pulleys do not tilt: normal forces put no torque on them. Both chains.
TEST(Creep, DragIsTheTorqueOfTheChainOnRigidPulleysAndLosesAPartOfTheFrictionOfTips) {
    Parameters halves = oracle::small_scene();
    halves.detail.pulleys = PulleyDetail::rigid;
    for (const Parameters& p : {halves, oracle::with_rigid_pins(halves)}) {
        const Seen seen(p);
        const Observation& now = seen.observation;
        for (std::size_t k = 0; k < 2; ++k) {  // sums of tips in another order: rounding
            EXPECT_NE(now.chain_torque[k], 0.0);
            EXPECT_NEAR(now.creep.drag[k], now.chain_torque[k], 1e-11 * std::abs(now.chain_torque[k]) + 1e-11);
            EXPECT_NEAR(now.free_speed[k], now.speed[k] + now.chain_torque[k] / now.creep.hold[k], 1e-9 * std::abs(now.free_speed[k]));
        }
        EXPECT_GT(now.creep.power, 0.0);
        EXPECT_LT(now.creep.power, now.account[Loss::tip_friction]) << "pins slide radially as well";
    }
}

TEST(Creep, IsNoneWhereNoTipTouches) {
    const Seen seen(oracle::small_scene(), 23);
    Observer observer(seen.variator);
    const std::vector<Phase> free(seen.random.phases.size(), Phase::free);
    const Observation& now = observer.observe(0.0, seen.random.state.data(), free.data());
    EXPECT_EQ(now.free_speed, now.speed);
    EXPECT_EQ(now.creep.power, 0.0);
    EXPECT_EQ(now.friction_slip, 0.0);
}

}  // namespace
}  // namespace cvtflow::model
