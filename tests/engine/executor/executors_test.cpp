/// Guarantees of every executor, for every number of threads (executor.hpp states them), and of the serial one; their catalogue,
/// cancellation and the shares of a run.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/executor/cancellation.hpp"
#include "engine/executor/catalogue.hpp"
#include "engine/executor/run.hpp"
#include "engine/executor/stamp_recorder.hpp"
#include "executor_fixture.hpp"
#include "tests/engine/allocation_fixture.hpp"

namespace cvtflow::engine {
namespace {

using test::Case;
using test::mixed_cycles;
using test::World;

/// Cycles to be run, some of them over and over.
struct Worklist {
    std::vector<std::vector<int>> cycles;
    long count;
    unsigned seed = 1;
    int repetitions = 1;
    long task_time = 0;  ///< [ns]
};

/// All sorts of cycles, none at all, often, random graphs of three levels, and tasks that take time.
std::vector<Worklist> worklists() {
    std::vector<Worklist> all{
        {mixed_cycles(), 3000}, {mixed_cycles(), 0}, {mixed_cycles(), 20, 1, 100}, {{{7}, {2, 1, 2}}, 300, 1, 1, 3000}};
    for (unsigned seed = 1; seed <= 10; ++seed) {
        const int a = 1 + static_cast<int>(seed * 5 % 13), b = 1 + static_cast<int>(seed * 7 % 11), c = 1 + static_cast<int>(seed * 3 % 7);
        all.push_back({{{a, b, c}, {c, a, b}}, 200, seed});
    }
    return all;
}

TEST(Executors, DoWhatSerialDoes) {
    test::for_each(test::all_cases(), [&](const Case& each) {
        for (const Worklist& work : worklists()) {
            const auto executor = each.make();
            World world(work.cycles, work.seed);
            world.task_time(work.task_time);
            const std::uint64_t expected = test::serial_hash(work.cycles, work.count, work.seed);
            for (int repetition = 0; repetition < work.repetitions; ++repetition) {
                world.run(*executor, work.count);
                ASSERT_EQ(world.faults(), 0) << repetition;
                ASSERT_EQ(world.cycles(), work.count);
                ASSERT_EQ(world.hash(), expected) << repetition << ", seed " << work.seed;
            }
        }
    });
}

TEST(Executors, RejectGraphsThatAreNotFrozenAndUnknownCyclesAtTheStartAndLater) {
    test::for_each(test::all_cases(), [&](const Case& each) {
        const auto executor = each.make();
        World world(mixed_cycles());
        EXPECT_THROW(executor->run(TaskGraph(), &world, world), std::logic_error);
        EXPECT_EQ(world.cycles(), 0);
        for (const long after : {0L, 1L, 50L}) {
            for (const int cycle : {-2, static_cast<int>(mixed_cycles().size())}) {
                world.name_after(after, cycle);
                EXPECT_THROW(world.run(*executor, 100), std::out_of_range);
                EXPECT_EQ(world.cycles(), after);
            }
        }
        world.name_after(-1, 0);
        world.run(*executor, 100);
        EXPECT_EQ(world.hash(), test::serial_hash(mixed_cycles(), 100)) << "usable afterwards";
    });
}

void nothing(void* /*context*/, int /*item*/) noexcept {}

TEST(Executors, AskAgainAfterCyclesWithoutTasks) {
    test::for_each(test::all_cases(), [&](const Case& each) {
        struct Once final : Controller {
            int next() noexcept override { return asked < 3 ? cycles[asked++] : stop; }
            int cycles[3] = {0, 1, 0};  // NOLINT: cycle 0 has no tasks
            int asked = 0;
        } once;
        TaskGraph graph;
        graph.add({"only", 1, nothing, 0, {}});
        graph.freeze();
        each.make()->run(graph, nullptr, once);
        EXPECT_EQ(once.asked, 3);
    });
}

/// Runtimes that may allocate now and then while a run lasts, with what we grant them; all else allocates when a run begins and never
/// while it lasts. Messages of flow graphs come from oneTBB's pool, which grows when memory is freed by another thread than the one that
/// took it; std_par's chunks as well. OpenMP allocates every explicit task and its dependences, LLVM's every parallel loop.
long granted(const ExecutorRow& row, long cycles) {
    if (row.name == "flow_messages" || row.name == "flow_per_cycle" || row.name == "std_par") return cycles / 10;
    if (row.name == "omp_tasks") return 100 * cycles;
#ifdef __clang__
    if (row.name == "omp_fork") return 100 * cycles;
#endif
    return 0;
}

TEST(Executors, AllocateNothingPerCycle) {
    if (test::allocation_count() < 0) GTEST_SKIP() << "a sanitizer owns malloc";
    test::for_each(test::all_cases(), [&](const Case& each) {
        const auto executor = each.make();
        World world(mixed_cycles());
        const long cycles = each.threads > 2 ? 300 : 2000;  // spinning threads that outnumber the processors take 6 ms a cycle
        const auto allocations = [&](long count) {
            const long before = test::allocation_count();
            world.run(*executor, count);
            return test::allocation_count() - before;
        };
        allocations(cycles);  // pools of the runtimes
        long beginning = 0, fewest = std::numeric_limits<long>::max();
        for (int repetition = 0; repetition < 5; ++repetition) {
            beginning = std::max(beginning, allocations(10));
            fewest = std::min(fewest, allocations(cycles));
        }
        EXPECT_LE(fewest, beginning + granted(*each.row, cycles));
    });
}

TEST(ExecutorOptions, AreChecked) {
    StampRecorder recorder(1, 10);
    for (const ExecutorRow& row : executors()) {
        EXPECT_THROW(row.make({.threads = 0}), std::invalid_argument) << row.name;
        EXPECT_THROW(row.make({.threads = 2, .recorder = &recorder}), std::invalid_argument) << row.name;
    }
}

TEST(World, SeesWhenAnExecutorDoesWrong) {
    struct Backwards final : Executor {
        void run(const TaskGraph& graph, void* context, Controller& controller) override {
            for (int cycle = controller.next(); cycle != Controller::stop; cycle = controller.next()) {
                const auto order = graph.topological(cycle);
                for (std::size_t i = order.size(); i-- > 0;) graph.call(order[i])(context);
            }
        }
        [[nodiscard]] std::string_view name() const noexcept override { return "backwards"; }
    } backwards;
    World world({{1, 2, 1}});
    world.run(backwards, 10);
    EXPECT_GT(world.faults(), 0);
    EXPECT_NE(world.hash(), test::serial_hash({{1, 2, 1}}, 10));
}

TEST(ExecutorCatalogue, EveryRowMakesAnExecutorOfItsNameByWhichItIsFound) {
    std::set<std::string_view> names;
    for (const ExecutorRow& row : executors()) {
        EXPECT_TRUE(names.insert(row.name).second) << row.name;
        EXPECT_EQ(find_executor(row.name), &row);
        EXPECT_EQ(row.make({.threads = 2})->name(), row.name);
        EXPECT_FALSE(row.description.empty()) << row.name;
    }
}

TEST(ExecutorCatalogue, AbsentOnesSayWhatTheyNeedAndAreNotFound) {
    EXPECT_EQ(find_executor("magic"), nullptr);
    for (const ExecutorRow& row : absent_executors()) {
        EXPECT_FALSE(row.needs.empty()) << row.name << " is absent for no reason";
        EXPECT_EQ(row.make, nullptr) << row.name;
        EXPECT_EQ(find_executor(row.name), nullptr) << row.name;
        EXPECT_NE(missing_executor(row.name).find("requires " + std::string(row.needs)), std::string::npos) << row.name;
    }
    EXPECT_EQ(missing_executor("fow"), " (did you mean \"flow\"?)");
    EXPECT_EQ(missing_executor("quite another thing"), "");
}

TEST(Cancellation, AsksUntilTheAnswerIsYes) {
    int asked = 0;
    const std::function<bool()> third = [&] { return ++asked == 3; };
    Cancellation cancel(third);
    EXPECT_FALSE(cancel.requested());
    EXPECT_FALSE(cancel.requested());
    EXPECT_TRUE(cancel.requested());
    EXPECT_TRUE(cancel.requested()) << "although the answer would be no again";
    EXPECT_EQ(asked, 3);
    EXPECT_TRUE(cancel.withdraw());
    EXPECT_FALSE(cancel.requested());
}

TEST(Cancellation, AsksNoFunctionWhereThereIsNone) {
    const std::function<bool()> none;
    Cancellation cancel(none);
    EXPECT_FALSE(cancel.requested());
    cancel.request();
    EXPECT_TRUE(cancel.requested());
}

TEST(Share, SharesFollowEachOtherAndDifferByOneAtMost) {
    for (int tasks = 0; tasks < 30; ++tasks) {
        std::vector<int> numbers(static_cast<std::size_t>(tasks));
        std::iota(numbers.begin(), numbers.end(), 0);
        for (int parts = 1; parts < 10; ++parts) {
            int next = 0;
            for (int part = 0; part < parts; ++part) {
                const auto of_part = share(numbers, part, parts);
                EXPECT_EQ(static_cast<int>(of_part.size()), (tasks + parts - 1 - part) / parts) << tasks << " in " << parts;
                for (const int task : of_part) EXPECT_EQ(task, next++);
            }
            EXPECT_EQ(next, tasks);
        }
    }
}

}  // namespace
}  // namespace cvtflow::engine
