#include "engine/executor/tbb/contention_backoff.hpp"

#include <gtest/gtest.h>

#include <ctime>

namespace cvtflow::engine {
namespace {

using namespace std::chrono_literals;

/// A worker whose uses of the processor are told, one window after the other.
class RetreatOf : public testing::Test {
protected:
    bool window(std::chrono::nanoseconds wall, std::chrono::nanoseconds lost, int taken_away) {
        use_.wall += wall;
        use_.processor += wall - lost;
        use_.taken_away += taken_away;
        return contention_.due(use_);
    }
    void stay_away() {
        use_.wall += contention_.length();
        ++use_.taken_away;
        contention_.returned(use_);
    }
    ProcessorUse use_;
    ContentionBackoff contention_{use_};
};

TEST_F(RetreatOf, AWorkerWithAProcessorOfItsOwnStays) {
    for (int i = 0; i < 100; ++i) ASSERT_FALSE(window(2ms, 20us, 1)) << "a short interruption is nobody's neighbour";
}

TEST_F(RetreatOf, ALostSliceIsSeenInTheNextWindow) {
    EXPECT_FALSE(window(2ms, 0us, 0));
    EXPECT_TRUE(window(5ms, 4ms, 1));
}

TEST_F(RetreatOf, SleepOfOnesOwnWillIsNoLoss) { EXPECT_FALSE(window(5ms, 4ms, 0)); }

TEST_F(RetreatOf, StaysAwayLongerEachTimeAndForgetsWhenLeftInPeace) {
    auto expected = ContentionBackoff::shortest;
    for (int i = 0; i < 8; ++i) {
        ASSERT_TRUE(window(5ms, 4ms, 1));
        ASSERT_EQ(contention_.length(), expected);
        stay_away();
        expected = std::min(ContentionBackoff::longest, 2 * expected);
    }
    EXPECT_EQ(contention_.length(), ContentionBackoff::longest);
    for (int i = 0; i <= 2 * ContentionBackoff::longest / 2ms; ++i) EXPECT_FALSE(window(2ms, 0us, 0));
    EXPECT_EQ(contention_.length(), ContentionBackoff::shortest);
}

TEST(ProcessorUse, CountsTimeOnTheProcessorAndNotTimeAsleep) {
    const ProcessorUse begin = ProcessorUse::now();
    const timespec pause{.tv_sec = 0, .tv_nsec = 20'000'000};
    ASSERT_EQ(nanosleep(&pause, nullptr), 0);
    const ProcessorUse slept = ProcessorUse::now();
    EXPECT_GE(slept.wall - begin.wall, 20ms);
    EXPECT_LT(slept.processor - begin.processor, 10ms);
    while (ProcessorUse::now().processor - slept.processor < 5ms) {}
    EXPECT_GE(ProcessorUse::now().wall - slept.wall, 4ms) << "the two clocks differ by some microseconds";
}

}  // namespace
}  // namespace cvtflow::engine
