#include "bench/study/granularity/granularity.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "tasks/scene/scene.hpp"

namespace cvtflow::bench {

using namespace tasks;
namespace {

std::vector<GranularityPoint> curve_of(const std::vector<double>& efficiencies) {
    std::vector<GranularityPoint> curve;
    double length = 1e-6;
    for (const double efficiency : efficiencies) {
        GranularityPoint point;
        point.length = length;
        point.efficiency.median = efficiency;
        curve.push_back(point);
        length *= 10.0;
    }
    return curve;
}

TEST(StencilGraph, HasTheEdgesOfARing) {
    const engine::TaskGraph graph = stencil_graph(3, 4);
    EXPECT_EQ(graph.size(), 12);
    EXPECT_EQ(graph.levels(0), 3);
    for (int task = 0; task < 4; ++task) {
        EXPECT_EQ(graph.predecessor_count(task), 0);
        EXPECT_EQ(graph.predecessor_count(4 + task), 3) << "itself and two neighbours";
    }
    EXPECT_EQ(std::vector<int>(graph.successors(0).begin(), graph.successors(0).end()), (std::vector<int>{4, 5, 7}));
    EXPECT_EQ(stencil_graph(2, 1).predecessor_count(1), 1) << "is its own neighbour";
    EXPECT_THROW(static_cast<void>(stencil_graph(0, 4)), std::invalid_argument);
}

TEST(IdealShare, TakesWholeTasks) {
    EXPECT_DOUBLE_EQ(ideal_share(4, 2), 0.5);
    EXPECT_DOUBLE_EQ(ideal_share(1, 2), 1.0) << "one task keeps one thread busy";
    EXPECT_DOUBLE_EQ(ideal_share(3, 2), 2.0 / 3.0);
    EXPECT_DOUBLE_EQ(ideal_share(7, 1), 1.0);
}

/// Tasks of length l with an overhead o each have the efficiency l/(l + o): half at l = o.
TEST(EffectiveGranularity, IsTheOverheadOfATask) {
    constexpr double overhead = 3e-6;
    std::vector<GranularityPoint> curve;
    for (double length = 1e-7; length < 1.1e-4; length *= std::pow(10.0, 0.1)) {
        GranularityPoint point;
        point.length = length;
        point.efficiency.median = length / (length + overhead);
        curve.push_back(point);
    }
    EXPECT_NEAR(effective_granularity(curve) / overhead, 1.0, 1e-3);  // a tenth of a decade apart, odd around the middle: O(0.1^3)
    EXPECT_NEAR(effective_granularity(curve, 0.75) / overhead, 3.0, 0.02);
}

TEST(EffectiveGranularity, NamesTheEndsIfTheCurveDoesNotCross) {
    EXPECT_DOUBLE_EQ(effective_granularity(curve_of({0.6, 0.7, 0.9})), 1e-6);
    EXPECT_TRUE(std::isinf(effective_granularity(curve_of({0.1, 0.2, 0.4}))));
}

TEST(EffectiveGranularity, CountsFromTheLastLengthThatIsTooShort) {
    EXPECT_NEAR(effective_granularity(curve_of({0.6, 0.25, 0.75})), 1e-5 * std::sqrt(10.0), 1e-9);  // halfway on both scales
}

TEST(Granularity, MeasuresEveryExecutorOnEveryNumberAndLength) {
    GranularityOptions options;
    options.executors = {"serial", "flow"};
    options.threads = 2;
    options.tasks = {1, 3};
    options.lengths = {1e-6, 50e-6};
    options.rounds = 2;
    const Granularity result = measure_granularity(options);
    EXPECT_EQ(result.executors(), options.executors);
    EXPECT_EQ(result.tasks(), options.tasks);
    ASSERT_EQ(result.points.size(), 8u);
    for (const GranularityPoint& point : result.points) {
        EXPECT_GT(point.cycle, 0.0);
        EXPECT_GT(point.efficiency.median, 0.0);
        EXPECT_EQ(point.threads, point.executor == "serial" ? 1 : 2);
    }
    EXPECT_EQ(result.curve("flow", 3).size(), 2u);
    EXPECT_GT(result.calibrated, 0.0);
}

/// A task takes its length on an idle processor; neighbours and slower clocks only make it longer. A calibration whose work had been left
/// out made tasks a thousand times too long.
TEST(Granularity, TasksAreAsLongAsTheyAreSaidToBe) {
    GranularityOptions options;
    options.executors = {"serial"};
    options.tasks = {1};
    options.lengths = {20e-6};
    double least = 1.0;
    for (int attempt = 0; attempt < 5; ++attempt) {  // another process may disturb each
        const Granularity result = measure_granularity(options);
        least = std::min(least, result.points.at(0).ideal / (options.levels * options.lengths[0]));
    }
    EXPECT_GT(least, 0.8);
    EXPECT_LT(least, 20.0);  // a dozen neighbours
}

TEST(Granularity, RefusesWhatThereIsNot) {
    GranularityOptions options;
    options.executors = {"flaw"};
    EXPECT_THROW(static_cast<void>(measure_granularity(options)), SceneError);
    options.executors = {"serial"};
    options.lengths = {0.0};
    EXPECT_THROW(static_cast<void>(measure_granularity(options)), std::invalid_argument);
}

}  // namespace
}  // namespace cvtflow::bench
