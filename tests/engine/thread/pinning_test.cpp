#include "engine/thread/pinning.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "tests/engine/executor/executor_fixture.hpp"

namespace cvtflow::engine {
namespace {

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

class Pinned : public testing::TestWithParam<test::Case> {};
INSTANTIATE_TEST_SUITE_P(Catalogue, Pinned, testing::ValuesIn(test::parallel_pairs()), test::case_name);

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

TEST_P(Pinned, RestoresTheMasksOfAllThreads) {
    const cpu_set_t all = mask_of(0);
    for (int repetition = 0; repetition < 20; ++repetition) {
        const auto executor = GetParam().row->make({.threads = 2, .pin = true});
        Asking asking;
        TaskGraph graph;
        for (int task = 0; task < 4; ++task) graph.add({"t", 0, [](void*, int) noexcept {}, task, {}});
        graph.freeze();
        executor->run(graph, nullptr, asking);
        EXPECT_GE(asking.pinned, 500);  // all but the first question, which comes before anything starts
        ASSERT_EQ(narrowed(all), 0);
    }
}

}  // namespace
}  // namespace cvtflow::engine
