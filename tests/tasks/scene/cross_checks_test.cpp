
#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tasks/scene/parameter_table.hpp"

namespace cvtflow::tasks {
namespace {

TEST(CrossChecks, DefaultsPassAll) {
    for (const CrossCheck& check : cross_checks()) EXPECT_EQ(check.violation(Scene{}), std::nullopt);
}

TEST(CrossChecks, KeysExist) {
    for (const CrossCheck& check : cross_checks()) {
        EXPECT_FALSE(check.keys.empty());
        for (const auto key : check.keys) EXPECT_NE(find_parameter(key), nullptr) << key;
    }
}

TEST(CrossChecks, AStateToStartFromNeedsNoGeometricStart) {
    Scene scene;
    scene.parameters.start.ratio = 10.0;
    const auto violated = [&] {
        return std::ranges::any_of(cross_checks(), [&](const CrossCheck& check) { return check.violation(scene).has_value(); });
    };
    EXPECT_TRUE(violated());
    scene.state_file = "/some/state.h5";
    EXPECT_FALSE(violated());
}

TEST(CrossChecks, WithoutSettlingTheRampDoesNotMatter) {
    Scene scene;
    scene.parameters.start.settling_time = 0.0;
    for (const CrossCheck& check : cross_checks()) EXPECT_EQ(check.violation(scene), std::nullopt);
}

}  // namespace
}  // namespace cvtflow::tasks
