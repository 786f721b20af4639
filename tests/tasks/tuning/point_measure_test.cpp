#include <gmock/gmock.h>

#include "tasks/scene/ready_scenes.hpp"
#include "tasks/tuning/point_measure.hpp"
#include "tests/tasks/settled_tiny_fixture.hpp"
#include "tests/tasks/tiny_fixture.hpp"

namespace cvtflow::tasks {

namespace {

const engine::Cancellation uncancelled;

/// Whether means of `baseline` with settings, at rigid, are unsteady.
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

std::vector<std::string> names(const std::vector<OperatingPoint>& points) {
    std::vector<std::string> found;
    for (const OperatingPoint& point : points) found.push_back(point.name);
    return found;
}

Scene with(const std::vector<std::string>& settings) {
    Scene scene = ready_tiny();
    set_values(scene, settings);
    return scene;
}

TEST(OperatingPoints, OfASceneWithConstantInputsAreItsStart) {
    const auto points = points_of(ready_tiny(), {1e-3, 2e-3});
    EXPECT_THAT(names(points), testing::ElementsAre("start"));
    EXPECT_EQ(points[0].from, 1e-3);
    EXPECT_EQ(points[0].until, 3e-3);
    EXPECT_EQ(points[0].scene.run.until.value, 3e-3);
}

/// As a run does: else levels are compared from one settled state, and the run of the cheaper one settles to another.
TEST(OperatingPoints, OfASceneWithoutAStateThatFitsSettleByThemselves) {
    Scene scene = test::settled_tiny();
    EXPECT_FALSE(points_of(scene, {}).front().settles);
    scene.state_file.clear();
    EXPECT_TRUE(points_of(scene, {}).front().settles);
    EXPECT_TRUE(unseen_points(scene, {}, 1, 1).front().settles);
}

TEST(OperatingPoints, HoldEveryTableAtItsEndsAndTheOthersAsTheyBegin) {
    const Scene scene = with({"load.torque=[[0, 10], [1, 16], [2, 4]]", "clamping.driven=[[0, 5000], [1, 6000]]"});
    const auto points = points_of(scene, {});
    EXPECT_THAT(names(points),
                testing::UnorderedElementsAre("start", "load.torque = 4 N*m", "load.torque = 16 N*m", "clamping.driven = 6000 N"));
    for (const OperatingPoint& point : points) {
        EXPECT_EQ(point.scene.parameters.load.torque.value.size(), 1u) << point.name;
        const bool own = point.name.starts_with("load");
        EXPECT_EQ(point.scene.parameters.load.torque.at(0.0) == 10.0, !own) << point.name;
    }
}

TEST(OperatingPoints, ThatAreUnseenLieBetweenThoseEnds) {
    const Scene scene = with({"load.torque=[[0, 10], [1, 16], [2, 4]]"});
    const auto points = unseen_points(scene, {}, 20, 7);
    double low = 1e9, high = 0.0;
    for (const OperatingPoint& point : points) {
        const double torque = point.scene.parameters.load.torque.at(0.0), driving = point.scene.parameters.clamping.driving.at(0.0);
        EXPECT_TRUE(torque > 4.0 && torque < 16.0) << point.name;
        EXPECT_NEAR(driving, 7700.0, 0.05 * 7700.0);
        EXPECT_NE(driving, 7700.0);
        low = std::min(low, torque), high = std::max(high, torque);
    }
    EXPECT_GT(high - low, 6.0) << "twenty of twelve N m";
    EXPECT_EQ(names(points), names(unseen_points(scene, {}, 20, 7)));
    EXPECT_NE(names(points), names(unseen_points(scene, {}, 20, 8)));
}

Sweep sweep_over(std::vector<Axis> axes) {
    Sweep sweep;
    sweep.scene = ready_tiny();
    sweep.axes = std::move(axes);
    return sweep;
}

TEST(CornerCases, CombineTheRowsInWhichAKeyIsLowestOrHighest) {
    const Axis torque{"list", {find_parameter("load.torque")}, {8.0, 14.0, 6.0, 10.0}};
    const Axis speed{"list", {find_parameter("drive.speed")}, {100.0, 150.0, 200.0}};
    // rows 0, 1, 2 and 3 of the torques: first, highest, lowest, last; rows 0 and 2 of the speeds
    EXPECT_THAT(corner_cases(sweep_over({torque, speed})), testing::ElementsAre(0, 2, 3, 5, 6, 8, 9, 11));
    EXPECT_THAT(corner_cases(sweep_over({torque, speed}), 3), testing::ElementsAre(0, 5, 11));
}

TEST(CornerCases, LeaveOutWhatContradictsItself) {
    const Axis inner{"list", {find_parameter("pulley.innermost")}, {10e-3, 11e-3, 30e-3}};
    const auto corners = corner_cases(sweep_over({inner}));
    EXPECT_THAT(corners, testing::ElementsAre(0)) << "30 mm are beyond pulley.outermost";
}

}  // namespace

}  // namespace cvtflow::tasks
