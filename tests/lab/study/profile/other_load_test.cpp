#include "bench/study/profile/other_load.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <iterator>

#include "engine/thread/pinning.hpp"

namespace cvtflow::bench {
namespace {

std::ptrdiff_t thread_count() { return std::distance(std::filesystem::directory_iterator("/proc/self/task"), {}); }

TEST(BusyNeighbours, BurnTimeAndLeave) {
    const std::ptrdiff_t before = thread_count();
    {
        const BusyNeighbours two(2);
        EXPECT_EQ(thread_count(), before + 2);
        while (two.processor_seconds() < 0.005) {}
    }
    EXPECT_EQ(thread_count(), before);
    const BusyNeighbours none(0);
    EXPECT_EQ(none.processor_seconds(), 0.0);
}

TEST(Crowding, OneThreadGetsOneProcessorAtMost) {
    const double got = processors_got(1, 0.02);
    EXPECT_GT(got, 0.0);
    EXPECT_LE(got, 1.0);
}

TEST(Crowding, ThreadsCannotGetMoreThanThereIs) {
    const int processors = engine::Processors().count();
    EXPECT_LE(processors_got(2 * processors, 0.05), 1.15 * processors);  // pieces run at different speeds where processors differ
}

/// Beside twice as many threads that do nothing but spin, a third of the machine is left. Half would be a lot: time slices are some
/// milliseconds.
TEST(Crowding, BusyNeighboursShow) {
    const int processors = engine::Processors().count();
    const BusyNeighbours neighbours(2 * processors);
    EXPECT_LT(processors_got(processors, 0.3), 0.75 * processors);
}

}  // namespace
}  // namespace cvtflow::bench
