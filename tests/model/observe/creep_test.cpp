/// How friction couples pins to their pulleys, against the forces that are computed otherwise.

#include "model/observe/creep.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "model/observe/observation.hpp"
#include "tests/oracle/oracle_cases.hpp"

namespace cvtflow::model {
namespace {

/// Halves of every order on rigid pulleys, which do not tilt: normal forces put no torque on them.
std::vector<oracle::Case> machines() {
    std::vector<oracle::Case> cases;
    for (int order = 0; order <= 3; ++order) {
        Parameters p = oracle::small_scene();
        p.detail.order = order;
        p.detail.pulleys = PulleyDetail::rigid;
        cases.push_back({"order " + std::to_string(order), p});
    }
    return cases;
}

TEST(Creep, DragIsTheTorqueOfTheChainOnRigidPulleys) {
    for (const oracle::Case& one : machines()) {
        const Variator variator(one.parameters);
        Observer observer(variator);
        const auto random = oracle::random_state(one.parameters, 21);
        const Observation& now = observer.observe(0.0, random.state.data(), random.phases.data());
        SheaveMotion sheaves[4];
        variator.pulleys().motions(random.state.data() + variator.layout().pulley_begin(), sheaves);
        const Creep creep = observe_creep(variator.chain(), random.state.data(), sheaves, random.phases.data());
        for (std::size_t k = 0; k < 2; ++k) {  // sums of tips in another order: rounding
            EXPECT_NE(now.chain_torque[k], 0.0) << one.name;
            EXPECT_NEAR(creep.drag[k], now.chain_torque[k], 1e-11 * std::abs(now.chain_torque[k]) + 1e-11) << one.name;
            EXPECT_NEAR(now.free_speed[k], now.speed[k] + now.chain_torque[k] / creep.hold[k], 1e-9 * std::abs(now.free_speed[k]));
        }
    }
}

TEST(Creep, LosesAPartOfWhatTheFrictionOfTipsLoses) {
    for (const oracle::Case& one : machines()) {
        const Variator variator(one.parameters);
        Observer observer(variator);
        const auto random = oracle::random_state(one.parameters, 22);
        const Observation& now = observer.observe(0.0, random.state.data(), random.phases.data());
        EXPECT_GT(now.creep_power, 0.0) << one.name;
        EXPECT_LT(now.creep_power, now.account[Loss::tip_friction]) << one.name << ": pins slide radially as well";
    }
}

TEST(Creep, IsNoneWhereNoTipTouches) {
    const Parameters p = oracle::small_scene();
    const Variator variator(p);
    Observer observer(variator);
    auto random = oracle::random_state(p, 23);
    std::fill(random.phases.begin(), random.phases.end(), Phase::free);
    const Observation& now = observer.observe(0.0, random.state.data(), random.phases.data());
    EXPECT_EQ(now.free_speed, now.speed);
    EXPECT_EQ(now.creep_power, 0.0);
    EXPECT_EQ(now.friction_slip, 0.0);
}

}  // namespace
}  // namespace cvtflow::model
