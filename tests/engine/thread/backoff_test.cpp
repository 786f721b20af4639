#include "engine/thread/backoff.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <ctime>
#include <thread>

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

}  // namespace
}  // namespace cvtflow::engine
