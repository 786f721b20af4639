#pragma once
/// A world of tasks in which every fault of an executor shows, and everything that the tests of executors share.

#include <gtest/gtest.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "engine/executor/catalogue.hpp"

namespace cvtflow::engine::test {

/// ThreadSanitizer does not understand the synchronisation of oneTBB and OpenMP and takes it for races.
#if defined(__SANITIZE_THREAD__)
inline constexpr bool thread_sanitizer = true;
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
inline constexpr bool thread_sanitizer = true;
#else
inline constexpr bool thread_sanitizer = false;
#endif
#else
inline constexpr bool thread_sanitizer = false;
#endif

/// A parallel executor for tests of other things: the product's, or the laboratory's where ThreadSanitizer needs one that it understands.
inline constexpr const char* parallel_executor = thread_sanitizer ? "barrier" : "flow";

/// Tasks whose numbers depend on those of their predecessors, and a controller whose decisions depend on the numbers of all tasks.
/// All data are plain, as in the step: a task that runs twice, too early, at the same time as another whose result it needs, or in another
/// cycle's time changes numbers or is counted, and is a race for ThreadSanitizer.
class World final : public Controller {
public:
    /// @param graph levels of each cycle, as widths: {{3, 1}, {7}} has a cycle of a level of 3 and one of 1, and a cycle of 7
    /// @param edges each task waits for a random choice of the level before (0 < edges ≤ 1), for one at least
    explicit World(const std::vector<std::vector<int>>& cycles, unsigned seed = 1, double edges = 0.5);

    /// Runs that many cycles from the beginning. @throws as the executor
    void run(Executor& executor, long cycles);
    int next() noexcept override;

    /// Everything that happened, as one number: the sequence of cycles and the numbers of all tasks.
    [[nodiscard]] std::uint64_t hash() const noexcept;
    [[nodiscard]] long cycles() const noexcept { return epoch_; }
    /// Tasks that ran too early or twice in a cycle, or not at all when a cycle had ended.
    [[nodiscard]] long faults() const noexcept { return faults_.load(); }
    /// A cycle named once, after `cycles` others.
    void name_after(long cycles, int cycle) { odd_after_ = cycles, odd_cycle_ = cycle; }
    /// Each task takes that long [ns].
    void task_time(long nanoseconds) { task_time_ = nanoseconds; }
    [[nodiscard]] const TaskGraph& graph() const noexcept { return graph_; }

private:
    struct Cell {
        long epoch = 0;
        std::uint64_t number = 0;
    };
    void add_level(int cycle, const std::vector<int>& before, std::vector<int>& level, int width, double edges);
    static void body(void* world, int task) noexcept;
    void run_task(std::size_t task) noexcept;
    void check_cycle() noexcept;

    TaskGraph graph_;
    std::vector<std::vector<std::size_t>> predecessors_;  // [task]
    std::vector<Cell> cells_;                             // [task]
    std::atomic<long> faults_{0};
    std::uint64_t random_;
    std::uint64_t sequence_ = 0;  // hash of the cycles named
    long epoch_ = 0;              // cycles begun
    long left_ = 0;
    int cycle_ = stop;
    long odd_after_ = -1;
    int odd_cycle_ = stop;
    long task_time_ = 0;
};

/// Hash of a serial run of a world of these cycles.
[[nodiscard]] std::uint64_t serial_hash(const std::vector<std::vector<int>>& cycles, long count, unsigned seed = 1);

/// Cycles that all tests of agreement run: one task, fewer tasks than threads, several levels, many tasks.
[[nodiscard]] const std::vector<std::vector<int>>& mixed_cycles();

/// Executor and number of threads.
struct Case {
    const ExecutorRow* row;
    int threads;
    [[nodiscard]] std::unique_ptr<Executor> make() const { return row->make({.threads = threads}); }
};
/// Quick: `serial`, `flow` and, in a laboratory build, `barrier`, times 1, 2 and 4 threads; deep: the catalogue times 1, 2, 4 and 8. Under
/// ThreadSanitizer only cases that it understands.
[[nodiscard]] std::vector<Case> all_cases();
/// One of each executor, the parallel ones with 2 threads.
[[nodiscard]] std::vector<Case> pairs();
/// Parallel cases only.
[[nodiscard]] std::vector<Case> parallel_pairs();
/// Calls `check` for each case and adds its name to every failure.
template <class Check>
void for_each(const std::vector<Case>& cases, const Check& check) {
    EXPECT_FALSE(cases.empty());
    for (const Case& each : cases) {
        const testing::ScopedTrace trace(__FILE__, __LINE__,
                                         std::string(each.row->name) + ", " + std::to_string(each.threads) + " threads");
        check(each);
    }
}

/// Threads of this process, by the kernel's count.
[[nodiscard]] int thread_count();

/// Waits up to 10 s until the process has this many threads: the OpenMP runtime lets its threads end by themselves.
[[nodiscard]] bool falls_to_threads(int count);

}  // namespace cvtflow::engine::test
