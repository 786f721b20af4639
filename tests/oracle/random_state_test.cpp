#include "tests/oracle/oracle_cases.hpp"
#include "tests/oracle/rigid_pins.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>

namespace cvtflow::oracle {
namespace {

/// How often each state of a contact or a link occurs.
using Counts = std::map<std::string, int>;

void expect_at_least(const Counts& least, Counts found, double ratio) {
    for (const auto& [what, count] : least) EXPECT_GT(found[what], count) << what << " at ratio " << ratio;
}

Counts counts_of_halves(const model::Parameters& parameters) {
    const ExactState at = exact_random_state(parameters, 21);
    const System system = unpack(parameters, 0.0, at.state, at.phases);
    const auto& joint = parameters.joint;
    const Real arm = joint.radius - parameters.half.width / 2.0L;
    Counts counts;
    for (int pin = 0; pin < system.layout.links; ++pin) {
        const Link &before = system.links[system.layout.previous(pin)], &after = system.links[pin];
        const Vec2 delta = before.front.at(0.0L) + arm * before.t - after.rear.at(0.0L) + arm * after.t;
        const Real depth = 2.0L * joint.radius - norm(delta);
        EXPECT_LT(depth, 2e-5L);
        counts["pressed"] += depth > 0.0L;
        counts["open"] += std::abs(cross(unit(before.t + after.t), delta)) > joint.clearance;
        counts["stretched"] += after.length > after.rest_length;
        for (const auto end : {model::End::rear, model::End::front}) {
            for (const int side : {0, 1}) {
                const TipContact contact = tip_contact(system, after, end, side);
                EXPECT_LT(contact.depth, 16e-6L);
                counts["deep " + std::to_string(contact.shaft) + std::to_string(side)] += contact.depth > 4e-6L;
            }
        }
    }
    return counts;
}

Counts counts_of_rigid_pins(const model::Parameters& parameters) {
    const ExactState at = exact_random_state(parameters, 23);
    const System system = unpack(parameters, 0.0, at.state, at.phases);
    const PinChain chain(system);
    Counts counts;
    for (int pin = 0; pin < system.layout.links; ++pin) {
        for (const auto end : {model::End::rear, model::End::front}) {
            for (const int side : {0, 1}) {
                const Real depth = chain.tip(chain.half(pin, end), side).depth;
                EXPECT_LT(depth, 3e-5L);
                counts["pressed"] += depth > 0.0L;
                counts["free"] += depth <= 0.0L && depth > -1e-5L;
            }
        }
        const bool slow = std::abs(chain.pin(pin).slide_rate) < parameters.joint.friction.saturation_speed;
        ++counts[slow ? "slow" : "fast"];
        const Vec2 across = chain.half(pin + 1, model::End::front).at - chain.half(pin, model::End::rear).at;
        ++counts[norm(across) > parameters.chain.pitch[0] + Real{parameters.half.width} ? "pulling" : "pushing"];
    }
    return counts;
}

TEST(RandomState, HasContactsAndLinksInEveryState) {
    for (const double ratio : {0.6, 1.0, 1.7}) {
        model::Parameters p;
        p.start.ratio = ratio;
        const Counts halves = counts_of_halves(p);
        expect_at_least({{"pressed", 60}, {"open", 8}, {"stretched", 75}, {"deep 00", 9}, {"deep 01", 9}, {"deep 10", 9}, {"deep 11", 9}},
                        halves, ratio);
        EXPECT_LT(halves.at("open"), 40);
        expect_at_least({{"pressed", 40}, {"free", 8}, {"slow", 5}, {"fast", 20}, {"pulling", 40}, {"pushing", 3}},
                        counts_of_rigid_pins(with_rigid_pins(p)), ratio);
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
