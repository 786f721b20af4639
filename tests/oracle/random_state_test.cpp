#include "tests/oracle/oracle_cases.hpp"
#include "tests/oracle/rigid_pins.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace cvtflow::oracle {
namespace {

struct JointCounts {
    int pressed = 0;  ///< joints with a positive depth at the middle
    int apart = 0;
    int beyond = 0;  ///< joints opened beyond the clearance
};

JointCounts count_joints(const System& system) {
    const auto& joint = system.parameters.joint;
    const Real arm = joint.radius - system.parameters.half.width / 2.0L;
    JointCounts counts;
    for (int pin = 0; pin < system.layout.links; ++pin) {
        const Link& before = system.links[system.layout.previous(pin)];
        const Link& after = system.links[pin];
        const Vec2 delta = before.front.at(0.0L) + arm * before.t - after.rear.at(0.0L) + arm * after.t;
        const Real depth = 2.0L * joint.radius - norm(delta);
        EXPECT_LT(depth, 2e-5L);
        ++(depth > 0.0L ? counts.pressed : counts.apart);
        if (std::abs(cross(unit(before.t + after.t), delta)) > joint.clearance) ++counts.beyond;
    }
    return counts;
}

TEST(RandomState, PressesJointsStretchesPlatesAndOpensSomeJoints) {
    for (const auto pulleys : {model::PulleyDetail::elastic, model::PulleyDetail::absent}) {
        model::Parameters parameters;
        parameters.detail.pulleys = pulleys;
        const ExactState at = exact_random_state(parameters, 12);
        const System system = unpack(parameters, 0.0, at.state, at.phases);
        const JointCounts counts = count_joints(system);
        EXPECT_GT(counts.pressed, 60);
        EXPECT_GT(counts.beyond, 8);
        EXPECT_LT(counts.beyond, 40);
        int stretched = 0;
        for (const Link& link : system.links) stretched += link.length > link.rest_length ? 1 : 0;
        EXPECT_GT(stretched, 75);
    }
}

TEST(RandomState, HoldsTipsInBothPulleysSomeMicrometresDeep) {
    for (const double ratio : {0.6, 1.0, 1.7}) {
        model::Parameters parameters;
        parameters.start.ratio = ratio;
        const ExactState at = exact_random_state(parameters, 21);
        const System system = unpack(parameters, 0.0, at.state, at.phases);
        int deep[2][2] = {};
        for (const Link& link : system.links) {
            for (const auto end : {model::End::rear, model::End::front}) {
                for (const int side : {0, 1}) {
                    const TipContact contact = tip_contact(system, link, end, side);
                    EXPECT_LT(contact.depth, 16e-6L);
                    if (contact.depth > 4e-6L) ++deep[contact.shaft][side];
                }
            }
        }
        for (const auto& of_shaft : deep) {
            for (const int count : of_shaft) EXPECT_GT(count, 9) << "ratio " << ratio;
        }
    }
}

TEST(RandomState, UsesEveryPhaseAndIsTheSameForTheSameSeed) {
    model::Parameters parameters;
    parameters.detail.stick_slip = true;
    const RandomState first = random_state(parameters, 8);
    const RandomState again = random_state(parameters, 8);
    EXPECT_EQ(first.state, again.state);
    EXPECT_EQ(first.phases, again.phases);
    EXPECT_NE(first.state, random_state(parameters, 9).state);
    for (const auto phase : {model::Phase::free, model::Phase::touching, model::Phase::stick, model::Phase::slip}) {
        EXPECT_GT(std::count(first.phases.begin(), first.phases.end(), phase), 3);
    }
}

struct RigidCounts {
    int pressed = 0, free = 0;     ///< tips inside the arcs, by their depth
    int slow = 0, fast = 0;        ///< half slides and tips, against the saturation speed
    int pulling = 0, pushing = 0;  ///< links
};

RigidCounts count_rigid(const model::Parameters& parameters, std::uint64_t seed) {
    const ExactState at = exact_random_state(parameters, seed);
    const System system = unpack(parameters, 0.0, at.state, at.phases);
    const PinChain chain(system);
    RigidCounts counts;
    for (int pin = 0; pin < system.layout.links; ++pin) {
        for (const auto end : {model::End::rear, model::End::front}) {
            for (const int side : {0, 1}) {
                const Real depth = chain.tip(chain.half(pin, end), side).depth;
                EXPECT_LT(depth, 3e-5L);
                if (depth > 0.0L) ++counts.pressed;
                if (depth <= 0.0L && depth > -1e-5L) ++counts.free;
            }
        }
        const bool slow = std::abs(chain.pin(pin).slide_rate) < parameters.joint.friction.saturation_speed;
        ++(slow ? counts.slow : counts.fast);
        const Vec2 across = chain.half(pin + 1, model::End::front).at - chain.half(pin, model::End::rear).at;
        const Real rest = parameters.chain.pitch[0] + Real{parameters.half.width};
        ++(norm(across) > rest ? counts.pulling : counts.pushing);
    }
    return counts;
}

TEST(RandomState, OfRigidPinsHasTipsInAndOutOfContactAndLinksThatPullAndPush) {
    for (const double ratio : {0.6, 1.0, 1.7}) {
        model::Parameters parameters = with_rigid_pins({});
        parameters.start.ratio = ratio;
        const RigidCounts counts = count_rigid(parameters, 23);
        EXPECT_GT(counts.pressed, 40) << "ratio " << ratio;
        EXPECT_GT(counts.free, 8) << "ratio " << ratio;
        EXPECT_GT(counts.slow, 5) << "ratio " << ratio;
        EXPECT_GT(counts.fast, 20) << "ratio " << ratio;
        EXPECT_GT(counts.pulling, 40) << "ratio " << ratio;
        EXPECT_GT(counts.pushing, 3) << "ratio " << ratio;
    }
}

/// Powers and energies of random states are watts and millijoules; below a milliwatt and a microjoule nothing moves or is deformed.
TEST(RandomState, MakesEveryLossAndEnergyPositive) {
    for (model::Parameters parameters : {model::Parameters{}, with_rigid_pins({})}) {
        const bool rigid = parameters.detail.pins == model::PinDetail::rigid;
        parameters.guide = {.stiffness = 1e6, .clearance = 0.0};
        const RandomState at = random_state(parameters, 2);
        const Result result = right_hand_side(parameters, 0.0, at.state, at.phases);
        for (int k = 0; k < model::loss_kinds; ++k) {
            if (rigid && static_cast<model::Loss>(k) == model::Loss::joint_damping) continue;  // of joints between halves
            EXPECT_GT(result.powers.losses[k], 1e-3) << "loss " << k;
        }
        const Energies& e = result.energies;
        for (const double energy : {e.kinetic, e.inner, e.pack, e.plates, rigid ? 1.0 : e.joints, e.tips, e.supports})
            EXPECT_GT(energy, 1e-6);
    }
}

}  // namespace
}  // namespace cvtflow::oracle
