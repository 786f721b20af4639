#include "bench/study/profile/busy_neighbours.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <iterator>

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

}  // namespace
}  // namespace cvtflow::bench
