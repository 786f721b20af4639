/// Laws of tips: a constant table changes nothing, torque and sliding speed are those of the law, and energy balances where friction falls.

#include <gtest/gtest.h>

#include <cmath>

#include "model/law/friction.hpp"
#include "operating_point_fixture.hpp"

namespace cvtflow::claims {
namespace {

using tasks::Scene;

[[nodiscard]] std::uint64_t hash_of(const std::string& level, const std::string& method, const std::vector<std::string>& law) {
    std::vector<std::string> settings{"start.state=", "start.settling_time=0.2 ms", "start.ramp_time=0.1 ms", "run.until=0.1 ms",
                                      "run.step=0.5 us"};
    settings.insert(settings.end(), law.begin(), law.end());
    Scene scene = scene_at_level("tiny", level, settings);
    scene.run.method = method;
    tasks::Simulation simulation(scene);
    tasks::SilentObserver silent;
    const engine::Cancellation never;
    EXPECT_FALSE(simulation.advance({.until = 0.0}, silent, never));
    EXPECT_FALSE(simulation.advance({.until = scene.run.until}, silent, never));
    return simulation.hash();
}

TEST(TipLaw, AConstantTableHasTheBitsOfTheConstantLaw) {
    const std::vector<std::string> table{"tip.friction_law=table", "tip.friction_table=[[0, 0.09], [0.05, 0.09], [1, 0.09]]"};
    for (const auto& [level, method] :
         {std::pair{"rigid", "auto"}, {"medium", "auto"}, {"medium", "leapfrog-chebyshev"}, {"medium", "dopri54"}})
        EXPECT_EQ(hash_of(level, method, table), hash_of(level, method, {})) << level << " " << method;
    EXPECT_NE(hash_of("medium", "auto", {"tip.friction_law=table", "tip.friction_table=[[0, 0.09], [0.05, 0.05]]"}),
              hash_of("medium", "auto", {}));
}

/// Friction that rises with the speed has a steady sliding speed: where 2 μ(v) S_2 r_2/cos β is the load's torque. The driven side alone
/// slides, with the smaller clamping force. 4 %: the flank's share of friction, and the creep of the driving side.
TEST(TipLaw, TheChainSlidesAsFastAsRisingFrictionCarriesTheLoad) {
    const Scene scene = scene_at_level(
        "baseline", "rigid",
        {"tip.friction_law=table", "tip.friction_table=[[0.02, 0.06], [1, 0.09]]", "run.until=40 ms", "run.output_interval=50 us"});
    const Operation run(scene);
    ASSERT_FALSE(run.fault) << run.fault.message();
    EXPECT_LE(run.balance_error_ratio, 1.0);
    const double radius = run.mean(run.radius, 30e-3, 40e-3), slip = run.mean(run.slip, 30e-3, 40e-3);
    const double speed = slip * 209.44 * radius;
    const model::Parameters& p = scene.parameters;
    const double mu = 0.09 * model::tip_law(p, 0.0)->by_speed.at(speed);
    RecordProperty("sliding_speed", std::to_string(speed));
    EXPECT_GT(speed, 0.1) << "it slides";
    EXPECT_NEAR(2.0 * mu * 20e3 * radius / std::cos(p.tip.angle), 150.0, 0.04 * 150.0);
}

/// Beyond the maximum of falling friction the chain lets go. That is no error: the run ends as such, and its energy balances.
TEST(TipLaw, EnergyBalancesWhereFrictionFallsAndTheChainLetsGo) {
    for (const char* level : {"rigid", "medium"}) {
        const Operation run(scene_at_level("baseline", level,
                                           {"tip.friction_law=table", "tip.friction_table=[[0.05, 0.09], [0.6, 0.07]]", "load.torque=205",
                                            "run.until=5 ms", "start.settling_time=10 ms"}));
        ASSERT_FALSE(run.fault) << level << ": " << run.fault.message();
        EXPECT_LE(run.balance_error_ratio, 1.0) << level;
        EXPECT_GT(run.mean(run.slip, 3e-3, 5e-3), 0.01) << level;
    }
}

}  // namespace
}  // namespace cvtflow::claims
