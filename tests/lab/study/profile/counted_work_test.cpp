#include "bench/study/profile/counted_work.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>

#include "bench/count/instructions.hpp"
#include "tests/claims/operating_point_fixture.hpp"

namespace cvtflow::bench {

using namespace tasks;
namespace {

constexpr auto idle = [](void*, int) noexcept {};

/// Three tasks side by side, then one that waits for all of them.
engine::TaskGraph three_and_one() {
    engine::TaskGraph graph;
    for (int item = 0; item < 3; ++item) graph.add({.name = "part", .cycle = 0, .code = idle, .item = item, .accesses = {}});
    graph.add({.name = "close", .cycle = 0, .code = idle, .item = 0, .accesses = {}});
    for (int part = 0; part < 3; ++part) graph.order(part, 3);
    graph.freeze();
    return graph;
}

TEST(CountedWork, ThreadsTakeTheNextTaskThatIsReady) {
    const engine::TaskGraph graph = three_and_one();
    const std::array work{3.0, 4.0, 2.0, 1.0};
    EXPECT_DOUBLE_EQ(makespan(graph, 0, work, 1), 10.0);
    EXPECT_DOUBLE_EQ(makespan(graph, 0, work, 2), 6.0);  // 3 + 2 beside 4, then 1
    EXPECT_DOUBLE_EQ(makespan(graph, 0, work, 3), 5.0);
    EXPECT_DOUBLE_EQ(makespan(graph, 0, work, 9), 5.0) << "threads without a task";
}

/// The numbers of threads at which the published speed-up of the forces rises.
TEST(CountedWork, SegmentsShortenAtThePublishedNumbers) {
    const std::vector<int> numbers = shortening_segments(84);
    EXPECT_EQ(numbers, (std::vector<int>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 14, 17, 21, 28, 42, 84}));
    EXPECT_EQ(shortening_segments(1), std::vector<int>{1});
}

#if defined(__linux__) && defined(__x86_64__)
TEST(CountedWork, CountsInstructionsOneByOne) {
    const std::array<std::function<void()>, 3> bodies{[] { asm volatile("nop"); }, [] { asm volatile("nop; nop; nop; nop"); }, [] {}};
    const std::vector<Counted> counted = count_each(bodies);
    ASSERT_EQ(counted.size(), 3u);
    EXPECT_EQ(counted[1].instructions - counted[0].instructions, 3);
    EXPECT_EQ(counted[2].instructions, 0) << "the call itself does not count";
    const std::array<std::function<void()>, 1> fatal{[] { _exit(3); }};
    EXPECT_TRUE(count_each(fatal).empty());
}

/// A smaller share of the work for every segment, and no more than there is.
TEST(CountedWork, OfAStepShrinksWithTheSegments) {
    const CountedWork counted = count_work(claims::ready_scene("tiny", {"run.method=rk4", "run.step=50ns"}), {1, 2});
    ASSERT_GE(counted.rows.size(), 3u);
    EXPECT_DOUBLE_EQ(counted.step, 50e-9);
    EXPECT_DOUBLE_EQ(counted.rows[0].fixed, 1.0);
    EXPECT_GT(counted.rows[1].fixed, 1.3);
    EXPECT_LE(counted.rows[1].fixed, 2.0);
    EXPECT_EQ(counted.rows[2].segments, 2) << "not counted: the next lower number";
    EXPECT_DOUBLE_EQ(counted.rows[2].claimed, counted.rows[1].claimed);
    EXPECT_LE(counted.rows[1].step_fixed, counted.rows[1].fixed) << "sequential tasks do not shrink";
    double evaluation = 0.0;
    for (const StageWork& stage : counted.stages) evaluation = std::max(evaluation, stage.instructions);
    EXPECT_GE(evaluation, counted.rows[1].longest / 2.0);
}
#endif

}  // namespace
}  // namespace cvtflow::bench
