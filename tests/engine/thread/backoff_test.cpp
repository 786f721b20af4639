#include <gtest/gtest.h>
#include <cstdint>
#include <ctime>
#include <thread>

#include "engine/thread/backoff.hpp"
#include "engine/thread/pinning.hpp"

namespace cvtflow::engine {

namespace {

/// Processor time that the calling thread or this process has used [s].
double processor_time(clockid_t of) {
    timespec time{};
    clock_gettime(of, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

using namespace std::chrono_literals;

TEST(Backoff, ReturnsTheNewValueAtOnceIfThereIsOne) {
    const std::atomic<std::uint64_t> word{7};
    for (const Wait wait : {Wait::spin, Wait::balanced, Wait::passive}) {
        Backoff backoff({.threads = 1, .wait = wait});
        EXPECT_EQ(backoff.change(word, std::uint64_t{6}), 7u);
    }
}

TEST(Backoff, SeesWhatWasWrittenBefore) {
    for (const Wait wait : {Wait::spin, Wait::balanced, Wait::passive}) {
        for (const auto delay : {0us, 10us, 1000us, 5000us}) {
            std::atomic<std::uint64_t> word{0};
            int plain = 0;
            std::jthread other([&] {
                std::this_thread::sleep_for(delay);
                plain = 1;
                word.store(1, std::memory_order_release);
            });
            Backoff backoff({.threads = 2, .wait = wait});
            EXPECT_EQ(backoff.change(word, std::uint64_t{0}), 1u);
            EXPECT_EQ(plain, 1);
        }
    }
}

/// Two threads on one processor hand a word to and fro: they must not pause in each other's time.
TEST(Backoff, LearnsThatPausesDoNotHelp) {
    constexpr std::uint64_t rounds = 400;
    std::atomic<std::uint64_t> word{0};
    const Processors processors;
    const Backoff untried({.threads = 1, .wait = Wait::spin});
    const auto play = [&](std::uint64_t first) {
        const Pin pin(true, processors, 0);
        Backoff backoff = untried;
        for (std::uint64_t round = first; round < rounds; round += 2) {
            if (round > 0) static_cast<void>(backoff.change(word, round - 1));
            word.store(round + 1, std::memory_order_release);
        }
    };
    const double before = processor_time(CLOCK_PROCESS_CPUTIME_ID);
    {
        std::jthread other([&] { play(1); });
        play(0);
    }
    // Processor time: a busy machine makes it last, and makes it no dearer.
    EXPECT_LT(processor_time(CLOCK_PROCESS_CPUTIME_ID) - before, rounds * 2e-3 / 4) << "2 ms is what an untaught wait takes";
}

TEST(Backoff, LeavesTheProcessorToOthersIfPassive) {
    std::atomic<std::uint64_t> word{0};
    std::jthread other([&] {
        std::this_thread::sleep_for(100ms);
        word.store(1, std::memory_order_release);
    });
    const double before = processor_time(CLOCK_THREAD_CPUTIME_ID);
    Backoff backoff({.threads = 2, .wait = Wait::passive});
    EXPECT_EQ(backoff.change(word, std::uint64_t{0}), 1u);
    EXPECT_LT(processor_time(CLOCK_THREAD_CPUTIME_ID) - before, 0.05);
}

using namespace std::chrono_literals;

/// A worker with given uses of the processor, one window after the other.
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
    for (int i = 0; i < 100; ++i) ASSERT_FALSE(window(2ms, 20us, 1)) << "a short interruption is no other load";
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
