#include "tasks/batch/start_states.hpp"

#include <gtest/gtest.h>

#include "tests/claims/operating_point_fixture.hpp"

namespace cvtflow::tasks {
namespace {

model::StartState start_with(const std::string& setting) { return model::start_state(claims::ready_scene("tiny", {setting}).parameters); }

TEST(StartStates, PlacingDoesNotDependOnWhatIsDoneToTheVariatorOnceItStands) {
    const model::StartState plain = model::start_state(claims::ready_scene("tiny").parameters);
    for (const std::string setting :
         {"load.torque=3 N*m", "load.inertia=0.1 kg*m^2", "clamping.driving=7 kN", "clamping.driven=6 kN", "run.step=1 us", "run.until=1 s",
          "run.method=leapfrog-rkc", "run.seed=7", "run.output_interval=3 us", "run.tolerance=2"}) {
        ASSERT_FALSE(matters_for_placing(*find_parameter(setting.substr(0, setting.find('='))))) << setting;
        const model::StartState start = start_with(setting);
        EXPECT_EQ(start.state, plain.state) << setting;
        EXPECT_EQ(start.phases, plain.phases) << setting;
    }
}

TEST(StartStates, PlacingDependsOnMachineSpeedAndStart) {
    const model::StartState plain = model::start_state(claims::ready_scene("tiny").parameters);
    for (const char* section : {"detail", "chain", "half", "plate", "joint", "tip", "pulley", "drive", "control", "start", "record"}) {
        for (const Parameter& parameter : parameter_table()) {
            if (parameter.section() != section) continue;
            EXPECT_TRUE(matters_for_placing(parameter)) << parameter.key;
        }
    }
    for (const char* setting : {"start.ratio=1.2", "drive.speed=100 rad/s", "tip.radius=100 mm", "control.enabled=true"}) {
        EXPECT_NE(start_with(setting).state, plain.state) << setting;
    }
}

}  // namespace
}  // namespace cvtflow::tasks
