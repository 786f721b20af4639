#include <gtest/gtest.h>

#include <cfenv>
#include <chrono>
#include <cstdint>
#include <ctime>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "engine/thread/backoff.hpp"
#include "engine/thread/floating_mode.hpp"
#include "engine/thread/pinning.hpp"
#include "engine/thread/worker_threads.hpp"
#include "tests/engine/executor/executor_fixture.hpp"

namespace cvtflow::engine {
namespace {

TEST(WorkerGrant, TriesThreadsAndLetsThemGo) {
    const int before = test::thread_count();
    EXPECT_EQ(startable_threads(5), 5);
    EXPECT_EQ(startable_threads(0), 0);
    EXPECT_EQ(startable_threads(-1), 0);
    EXPECT_EQ(test::thread_count(), before);
}

TEST(WorkerGrant, GivesTheRequestedThreadsWithoutShortageAndTriesOnlyNewOnes) {
    forget_workers();
    {
        const WorkerGrant first(3), second(2);  // side by side: three workers in all
        EXPECT_EQ(first.threads(), 3);
        EXPECT_EQ(second.threads(), 2);
        EXPECT_TRUE(first.fresh());
        EXPECT_TRUE(second.fresh());
    }
    EXPECT_FALSE(WorkerGrant(4).fresh());
    EXPECT_TRUE(WorkerGrant(5).fresh());
    EXPECT_EQ(thread_shortage().requested, 0);
}

TEST(Runtimes, OfTbbIsNamed) {
    EXPECT_EQ(tbb_version().substr(0, 2), "20") << "year and release";
    EXPECT_NE(tbb_version().find("interface 12"), std::string::npos);
}

cpu_set_t mask_of(pid_t thread) {
    cpu_set_t mask;
    CPU_ZERO(&mask);
    sched_getaffinity(thread, sizeof mask, &mask);
    return mask;
}

TEST(Pin, KeepsTheThreadOnOneProcessorAndLetsGo) {
    const cpu_set_t before = mask_of(0);
    const Processors processors;
    EXPECT_EQ(processors.count(), CPU_COUNT(&before));
    for (int number = 0; number < 2 * processors.count(); ++number) {
        const Pin pin(true, processors, number);
        const cpu_set_t now = mask_of(0), requested = processors.only(number % processors.count());
        EXPECT_EQ(CPU_COUNT(&now), 1);
        EXPECT_TRUE(CPU_EQUAL(&now, &requested));
    }
    const cpu_set_t after = mask_of(0);
    EXPECT_TRUE(CPU_EQUAL(&after, &before));
}

TEST(Pin, DoesNothingUnlessRequested) {
    const cpu_set_t before = mask_of(0);
    const Pin pin(false, Processors(), 0);
    const cpu_set_t now = mask_of(0);
    EXPECT_TRUE(CPU_EQUAL(&now, &before));
}

/// Threads of this process that may not use all of the processors.
int narrowed_now(const cpu_set_t& all) {
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task")) {
        cpu_set_t mask;
        if (sched_getaffinity(std::stoi(entry.path().filename()), sizeof mask, &mask) != 0) continue;
        count += CPU_EQUAL(&mask, &all) ? 0 : 1;
    }
    return count;
}

/// Number of threads that stay narrowed: one that was joined is listed with its last mask until the system has taken it away.
int narrowed(const cpu_set_t& all) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(2);
    while (narrowed_now(all) != 0 && std::chrono::steady_clock::now() < end) std::this_thread::yield();
    return narrowed_now(all);
}

/// Asks, between cycles, whether the asking thread is pinned.
class Asking final : public Controller {
public:
    int next() noexcept override {
        const cpu_set_t mask = mask_of(0);
        if (CPU_COUNT(&mask) == 1) ++pinned;
        return left-- > 0 ? 0 : stop;
    }
    int left = 500;
    int pinned = 0;
};

TEST(Pinned, RestoresTheMasksOfAllThreads) {
    test::for_each(test::parallel_pairs(), [&](const test::Case& each) {
        const cpu_set_t all = mask_of(0);
        for (int repetition = 0; repetition < 20; ++repetition) {
            const auto executor = each.row->make({.threads = 2, .pin = true});
            Asking asking;
            TaskGraph graph;
            for (int task = 0; task < 4; ++task) graph.add({"t", 0, [](void*, int) noexcept {}, task, {}});
            graph.freeze();
            executor->run(graph, nullptr, asking);
            EXPECT_GE(asking.pinned, 500);  // all but the first question, which comes before anything starts
            ASSERT_EQ(narrowed(all), 0);
        }
    });
}

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

/// A third, as the thread rounds it that runs the task.
double third() noexcept {
    const volatile double one = 1.0, three = 3.0;
    return one / three;
}

void divide(void* context, int item) noexcept { (*static_cast<std::vector<double>*>(context))[static_cast<std::size_t>(item)] = third(); }

struct Times final : Controller {
    explicit Times(int count) : left(count) {}
    int next() noexcept override { return left-- > 0 ? 0 : stop; }
    int left;
};

TEST(Rounding, IsTheCallersOnEveryThread) {
    test::for_each(test::all_cases(), [&](const test::Case& each) {
        TaskGraph graph;
        for (int task = 0; task < 8; ++task) graph.add({"t", 0, divide, task, {}});
        graph.freeze();
        const auto executor = each.make();
        for (const int mode : {FE_TONEAREST, FE_DOWNWARD, FE_UPWARD}) {
            std::fesetround(mode);
            const double expected = third();
            std::vector<double> seen(8, 0.0);
            Times hundred(100);
            executor->run(graph, &seen, hundred);
            EXPECT_EQ(seen, std::vector<double>(8, expected));
            EXPECT_EQ(std::fegetround(), mode);
        }
        std::fesetround(FE_TONEAREST);
    });
}

TEST(FloatingScope, GivesTheThreadItsOwnModeBack) {
    const double nearest = third();
    std::fesetround(FE_UPWARD);
    const FloatingMode upward;
    const double more = third();
    std::fesetround(FE_TONEAREST);
    {
        const FloatingScope scope(upward);
        EXPECT_EQ(third(), more);
    }
    EXPECT_EQ(third(), nearest);
    EXPECT_NE(more, nearest);
}

}  // namespace
}  // namespace cvtflow::engine
