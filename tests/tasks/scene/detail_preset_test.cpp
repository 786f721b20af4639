#include <string>

#include <gtest/gtest.h>

#include "tasks/scene/scene.hpp"

namespace cvtflow::tasks {
namespace {

TEST(DetailPresets, SetFourDialsAndKeepTheOthers) {
    for (const DetailPreset& preset : detail_presets()) {
        Scene scene;
        scene.parameters.detail.friction = model::FrictionLaw::smoothed;
        scene.parameters.detail.smoothing = 0.25;
        scene.parameters.detail.stick_slip = true;
        apply_detail(scene, preset.name);
        const model::Detail expected{
            preset.pins, preset.order, preset.plates, preset.joint_points, preset.pulleys, model::FrictionLaw::smoothed, 0.25, true};
        EXPECT_EQ(scene.parameters.detail, expected) << preset.name;
        EXPECT_FALSE(preset.meaning.empty());
    }
}

TEST(DetailPresets, LeaveAbsentPulleysAbsent) {
    for (const DetailPreset& preset : detail_presets()) {
        Scene scene;
        scene.parameters.detail.pulleys = model::PulleyDetail::absent;
        apply_detail(scene, preset.name);
        EXPECT_EQ(scene.parameters.detail.pulleys, model::PulleyDetail::absent);
        EXPECT_EQ(scene.parameters.detail.order, preset.order);
    }
}

TEST(DetailPresets, FineIsTheDefault) {
    Scene scene;
    apply_detail(scene, "coarse");
    EXPECT_NE(scene.parameters.detail, model::Detail{});
    apply_detail(scene, "fine");
    EXPECT_EQ(scene.parameters.detail, model::Detail{});
}

TEST(DetailPresets, UnknownNameIsAnErrorWithASuggestion) {
    Scene scene;
    try {
        apply_detail(scene, "corse");
        FAIL();
    } catch (const SceneError& error) {
        EXPECT_STREQ(error.what(), "detail corse: not one of coarse, medium, fine, full (did you mean \"coarse\"?)");
    }
}

}  // namespace
}  // namespace cvtflow::tasks
