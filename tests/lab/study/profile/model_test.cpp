#include "bench/study/profile/model.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace cvtflow::bench {

using namespace tasks;
namespace {

TEST(ProfileModel, EvenSpeedUpCountsTheLongestSegment) {
    EXPECT_DOUBLE_EQ(even_speed_up(84, 1), 1.0);
    EXPECT_DOUBLE_EQ(even_speed_up(84, 7), 7.0);
    EXPECT_DOUBLE_EQ(even_speed_up(84, 8), 84.0 / 11.0);  // 10 or 11 links each
    EXPECT_DOUBLE_EQ(even_speed_up(84, 64), 42.0);        // some segments have two links
}

TEST(ProfileModel, Amdahl) {
    EXPECT_DOUBLE_EQ(amdahl_speed_up(0.0, 8), 8.0);
    EXPECT_DOUBLE_EQ(amdahl_speed_up(1.0, 8), 1.0);
    EXPECT_DOUBLE_EQ(amdahl_speed_up(0.5, 4), 1.6);  // 1 / (0.5 + 0.5/4)
}

/// Six links, the first two touch: with two segments of three links the first takes 2·3 + 1·1 + 0.5, the second 3·1 + 0.5.
class CriticalPath : public testing::Test {
protected:
    PathCosts costs_{.free = 1.0,
                     .touching = 3.0,
                     .border = 0.5,
                     .detect = 0.25,
                     .controller = 0.1,
                     .synchronisation = 0.2,
                     .per_thread = 0.05,
                     .evaluations = 4.0};
    std::vector<bool> touching_{true, true, false, false, false, false};
};

TEST_F(CriticalPath, OfOneSegmentHasNoSynchronisation) {
    // 4 evaluations of 2·3 + 4·1 and a controller, a detection of 6·0.25 and a controller.
    EXPECT_DOUBLE_EQ(step_time(costs_, Partition::equal(6, 1), 1, touching_, 0.0), 4.0 * (10.0 + 0.1) + 1.5 + 0.1);
}

TEST_F(CriticalPath, TakesTheSlowestSegmentOfEveryCycle) {
    const double meeting = 0.2 + 2 * 0.05;
    EXPECT_DOUBLE_EQ(step_time(costs_, Partition::equal(6, 2), 2, touching_, meeting), 4.0 * (7.5 + 0.1 + meeting) + 0.75 + 0.1 + meeting);
    // Unequal segments, of one link and of five: the slowest in evaluation is 1·3 + 4·1 + 0.5.
    EXPECT_DOUBLE_EQ(step_time(costs_, Partition::at({0, 1, 6}), 2, touching_, meeting),
                     4.0 * (7.5 + 0.1 + meeting) + 1.25 + 0.1 + meeting);
}

TEST_F(CriticalPath, SpeedUpIsTheRatio) {
    EXPECT_DOUBLE_EQ(predicted_speed_up(costs_, 1, touching_), 1.0);
    EXPECT_DOUBLE_EQ(predicted_speed_up(costs_, 2, touching_), (4.0 * 10.1 + 1.6) / (4.0 * 7.9 + 1.15));
}

TEST_F(CriticalPath, IsIdealForEvenLinksAndFreeMeetings) {
    const PathCosts even{.free = 1.0, .touching = 1.0, .detect = 0.2, .evaluations = 4.0};
    EXPECT_DOUBLE_EQ(predicted_speed_up(even, 3, touching_), 3.0);
    EXPECT_DOUBLE_EQ(predicted_speed_up(even, 4, touching_), 3.0);  // two links in the longest segment
}

TEST_F(CriticalPath, GivesEveryThreadAContiguousShareOfTheSegments) {
    // Three segments of two links on two threads: the first has two of them.
    EXPECT_DOUBLE_EQ(step_time(costs_, Partition::equal(6, 3), 2, touching_, 0.3),
                     4.0 * ((6.0 + 2.0 + 2 * 0.5) + 0.1 + 0.3) + 4 * 0.25 + 0.1 + 0.3);
    // All on one thread: borders cost, meetings do not.
    EXPECT_DOUBLE_EQ(step_time(costs_, Partition::equal(6, 3), 1, touching_, 0.3), 4.0 * ((10.0 + 3 * 0.5) + 0.1) + 1.5 + 0.1);
}

TEST_F(CriticalPath, StretchesTasksOfSeveralThreadsAndWaitsForTheLatest) {
    costs_.stretch = 1.1;
    costs_.jitter = 0.2;
    costs_.other_cycles = 0.5;
    const double between = 0.1 + 0.3, late = 0.2 * std::sqrt(3.0) * expected_largest(2);
    EXPECT_DOUBLE_EQ(step_time(costs_, Partition::equal(6, 2), 2, touching_, 0.3),
                     4.0 * (1.1 * 7.5 + late + between) + 1.1 * 0.75 + between + 0.5 * between);
    EXPECT_DOUBLE_EQ(step_time(costs_, Partition::equal(6, 1), 1, touching_, 0.0), 4.0 * 10.1 + 1.6 + 0.5 * 0.1);
}

TEST(ProfileModel, LargestOfNormalNumbers) {
    EXPECT_EQ(expected_largest(1), 0.0);
    EXPECT_NEAR(expected_largest(2), 0.5642, 0.03);    // 1 / sqrt(pi); Blom's approximation is good to 0.03
    EXPECT_NEAR(expected_largest(3), 0.8463, 0.03);    // 3 / (2 sqrt(pi))
    EXPECT_NEAR(expected_largest(100), 2.5076, 0.03);  // tables
}

TEST(ProfileModel, MeetingsFollowTheirLaw) {
    PathCosts costs;
    fit_synchronisation(std::vector<ThreadCost>{{1, 0.1}, {2, 0.2}}, costs);
    EXPECT_EQ(meeting(costs, 1, MeetingLaw::linear), 0.0);
    for (const MeetingLaw law : {MeetingLaw::linear, MeetingLaw::logarithmic}) EXPECT_NEAR(meeting(costs, 2, law), 0.2, 1e-12);
    EXPECT_NEAR(meeting(costs, 8, MeetingLaw::linear), 0.8, 1e-12);
    EXPECT_NEAR(meeting(costs, 8, MeetingLaw::logarithmic), 0.4, 1e-12);
}

TEST_F(CriticalPath, LiesBetweenItsBounds) {
    costs_.jitter = 0.05;
    costs_.synchronisation_tree = 0.25, costs_.per_doubling = 0.05;  // as the linear law at two threads
    const auto rows = speed_up_curves(costs_, 0.1, touching_, 2, 64);
    for (const SpeedUpRow& row : rows) {
        EXPECT_LE(row.low, row.predicted) << row.threads;
        EXPECT_LE(row.predicted, row.high) << row.threads;
    }
    EXPECT_EQ(rows[1].low, rows[1].predicted);  // measured there
    EXPECT_LT(rows[5].low, rows[5].predicted);
}

TEST(ProfileModel, FitFindsTheCostsOfLinks) {
    PathCosts costs;
    std::vector<SegmentCost> samples;
    for (const auto& [free, touching] : {std::pair{4, 0}, {3, 1}, {0, 4}, {7, 5}, {2, 9}})
        samples.push_back({free, touching, 0.2 * free + 0.3 * touching + 0.06});
    fit_links(samples, costs);
    EXPECT_NEAR(costs.free, 0.2, 1e-12);
    EXPECT_NEAR(costs.touching, 0.3, 1e-12);
    EXPECT_NEAR(costs.border, 0.06, 1e-12);
}

TEST(ProfileModel, LinksThatCannotBeDistinguishedCostTheSame) {
    PathCosts costs;
    fit_links(std::vector<SegmentCost>{{3, 0, 3.5}, {5, 0, 5.5}}, costs);
    EXPECT_NEAR(costs.free, 1.0, 1e-12);
    EXPECT_NEAR(costs.touching, 1.0, 1e-12);
    EXPECT_NEAR(costs.border, 0.5, 1e-12);
}

TEST(ProfileModel, FitsTheSynchronisation) {
    PathCosts costs;
    fit_synchronisation(std::vector<ThreadCost>{{1, 0.3}, {2, 0.4}, {4, 0.6}}, costs);
    EXPECT_NEAR(costs.synchronisation, 0.2, 1e-12);
    EXPECT_NEAR(costs.per_thread, 0.1, 1e-12);
    fit_synchronisation(std::vector<ThreadCost>{{2, 0.3}}, costs);
    EXPECT_EQ(costs.synchronisation, 0.3);
    EXPECT_EQ(costs.per_thread, 0.0);
    fit_synchronisation(std::vector<ThreadCost>{{1, 0.5}, {2, 0.4}}, costs);  // noise: no thread makes it cheaper
    EXPECT_EQ(costs.per_thread, 0.0);
}

TEST_F(CriticalPath, CurvesEndWithOneLinkPerSegment) {
    const auto rows = speed_up_curves(costs_, 0.5, touching_, 2, 64);
    ASSERT_EQ(rows.size(), 6u);
    EXPECT_EQ(rows[3].threads, 4);
    EXPECT_EQ(rows[3].ideal, 4.0);
    EXPECT_EQ(rows[3].even, 3.0);
    EXPECT_EQ(rows[3].amdahl, 1.6);
    EXPECT_EQ(rows[3].predicted, predicted_speed_up(costs_, 4, touching_));
}

}  // namespace
}  // namespace cvtflow::bench
