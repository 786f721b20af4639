#include "tasks/tuning/point_measure.hpp"

#include <gmock/gmock.h>

#include "tasks/scene/ready_scenes.hpp"

namespace cvtflow::tasks {
namespace {

const engine::Cancellation uncancelled;

/// Of `baseline` with settings, at rigid.
bool unsteady(const std::vector<std::string>& settings) {
    Scene scene = read_scene(find_scene("baseline"));
    set_values(scene, settings);
    const auto outputs = tuned_outputs({"slip"}, true);
    PointMeasure measure(points_of(scene, {}).front(), "rigid", outputs, uncancelled);
    return measure.run({"rigid", RunSettings{}.method, 1.0}).unsteady;
}

/// A start state of another speed: 20 ms later the machine still accelerates, and errors are those of that.
TEST(PointMeasure, FindsMeansThatStillChange) {
    EXPECT_FALSE(unsteady({}));
    EXPECT_TRUE(unsteady({"drive.speed=3000 rpm", "load.torque=90", "clamping.driving=25.5 kN"}));
}

/// The shortest window has no mean over a pin period.
TEST(PointMeasure, ReferencesStateMeansThatStillChange) {
    const Scene scene = read_scene(find_scene("baseline"));
    const auto outputs = tuned_outputs({"tight_tension"}, true);
    PointMeasure brief(points_of(scene, {1e-3, 0.2e-3}).front(), "rigid", outputs, uncancelled);
    ASSERT_NE(brief.reference(0.5), nullptr);
    EXPECT_THAT(brief.reference_text(), testing::HasSubstr("unsteady: its means still change"));
}

}  // namespace
}  // namespace cvtflow::tasks
