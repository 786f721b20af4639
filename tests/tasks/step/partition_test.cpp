#include "tasks/step/workspace.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

namespace cvtflow::tasks {
namespace {

TEST(Partition, CoversAllLinksOnceInOrder) {
    for (const int links : {3, 24, 84, 85}) {
        for (int segments = 1; segments <= links; ++segments) {
            const Partition partition = Partition::equal(links, segments);
            ASSERT_EQ(partition.size(), segments);
            int next = 0;
            for (const Segment& segment : partition.segments()) {
                EXPECT_EQ(segment.first, next);
                EXPECT_GT(segment.size(), 0);
                next = segment.last;
            }
            EXPECT_EQ(next, links);
        }
    }
}

TEST(Partition, SegmentsDifferByOneLinkAtMost) {
    for (int segments = 1; segments <= 84; ++segments) {
        const Partition partition = Partition::equal(84, segments);
        const auto [least, most] = std::minmax_element(partition.segments().begin(), partition.segments().end(),
                                                       [](const Segment& a, const Segment& b) { return a.size() < b.size(); });
        EXPECT_LE(most->size() - least->size(), 1);
    }
}

TEST(Partition, RefusesNoSegmentsAndMoreSegmentsThanLinks) {
    EXPECT_THROW(static_cast<void>(Partition::equal(24, 0)), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(Partition::equal(24, -1)), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(Partition::equal(24, 25)), std::invalid_argument);
}

}  // namespace
}  // namespace cvtflow::tasks
