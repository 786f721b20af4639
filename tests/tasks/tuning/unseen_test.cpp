/// Choices of a tuner hold at operating points that it has not tried: at most one in twenty misses the target.

#include <gtest/gtest.h>

#include <iostream>

#include "tasks/scene/ready_scenes.hpp"
#include "tasks/tuning/tuned_scene.hpp"
#include "tests/tasks/tiny_fixture.hpp"

namespace cvtflow::tasks {
namespace {

const engine::Cancellation on_and_on;

struct Tally {
    long points = 0, missed = 0;
};

/// Tunes, tries further points, and prints the results on stdout.
void try_unseen(Tuner& tuner, const std::vector<OperatingPoint>& points, double accuracy, const std::string& name, Tally& tally) {
    const TuneResult result = tuner.tune(accuracy);
    if (!result.chosen) {
        std::cout << name << " " << accuracy << ": nothing is within it\n";
        return;
    }
    const TunedChoice& chosen = result.choices[*result.chosen];
    std::cout << name << " " << accuracy << ": " << chosen.choice.text() << ", " << chosen.error() << " at " << result.points.size()
              << " points, " << result.wall << " s;";
    for (const OperatingPoint& point : points) {
        std::string why;
        const auto errors = tuner.errors_at(chosen.choice, point, accuracy, why);
        std::cout << " " << (errors.empty() ? why : std::to_string(largest(errors)));
        tally.points += !errors.empty();
        tally.missed += !errors.empty() && !(largest(errors) <= accuracy);
    }
    std::cout << std::endl;
}

TEST(UnseenPoints, OfTheSmallestSceneAreWithinFivePerCent) {
    TuneSettings settings;
    settings.same_everywhere = true;
    settings.times = {12e-3, 8e-3};
    const Scene scene = ready_tiny();
    Tuner tuner(scene, settings, on_and_on);
    Tally tally;
    try_unseen(tuner, unseen_points(scene, settings.times, 2, 11), 0.05, "tiny", tally);
    EXPECT_EQ(tally.points, 2);
    EXPECT_EQ(tally.missed, 0);
}

TEST(NightlyUnseenPoints, OfAllReadyScenesAndTwoSweepsAreWithinTheTargetInNineteenOfTwenty) {
    Tally tally;
    for (const ReadyScene& ready : ready_scenes()) {
        const Scene scene = read_scene(ready.path);
        const TuneSettings settings;
        Tuner tuner(scene, settings, on_and_on);
        for (const double accuracy : {0.05, 0.01, 0.002})
            try_unseen(tuner, unseen_points(scene, settings.times, 3, 11), accuracy, ready.name, tally);
    }
    for (const std::size_t part : {0U, 1U}) {  // two sweeps: either half of the cases of the ready one
        Sweep sweep = read_sweep(std::string(CVTFLOW_SOURCE_DIR) + "/scenes/sweeps/slip_efficiency.toml", find_scene);
        sweep.scalars.resize(1);
        Axis& axis = sweep.axes.front();
        const std::size_t half = axis.rows() / 2 * axis.keys.size(), begin = part * half;
        axis.values = {axis.values.begin() + static_cast<std::ptrdiff_t>(begin),
                       axis.values.begin() + static_cast<std::ptrdiff_t>(begin + half)};
        TuneSettings settings;
        Tuner tuner(sweep, settings, on_and_on);
        std::vector<OperatingPoint> points;
        for (const long number : {sweep.cases() / 3, sweep.cases() / 2}) points.push_back(point_of_case(sweep, number));
        for (const double accuracy : {0.05, 0.01}) try_unseen(tuner, points, accuracy, "slip_efficiency", tally);
    }
    std::cout << tally.missed << " of " << tally.points << " points miss their target\n";
    EXPECT_GE(tally.points, 60);
    EXPECT_LE(20 * tally.missed, tally.points);
}

}  // namespace
}  // namespace cvtflow::tasks
