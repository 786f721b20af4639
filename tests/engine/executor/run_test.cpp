#include "engine/executor/run.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

namespace cvtflow::engine {
namespace {

TEST(Share, SharesFollowEachOtherAndDifferByOneAtMost) {
    for (int tasks = 0; tasks < 30; ++tasks) {
        std::vector<int> numbers(static_cast<std::size_t>(tasks));
        std::iota(numbers.begin(), numbers.end(), 0);
        for (int parts = 1; parts < 10; ++parts) {
            int next = 0;
            for (int part = 0; part < parts; ++part) {
                const auto own = share(numbers, part, parts);
                EXPECT_EQ(static_cast<int>(own.size()), (tasks + parts - 1 - part) / parts) << tasks << " in " << parts;
                for (const int task : own) EXPECT_EQ(task, next++);
            }
            EXPECT_EQ(next, tasks);
        }
    }
}

}  // namespace
}  // namespace cvtflow::engine
