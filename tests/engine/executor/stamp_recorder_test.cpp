#include "bench/executor/further_executors.hpp"
#include "bench/executor/span_recorder.hpp"
#include "engine/thread/worker_threads.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <stdexcept>
#include <thread>

#include "executor_fixture.hpp"
#include "tests/engine/allocation_fixture.hpp"

namespace cvtflow::engine {
namespace {

using testing::ElementsAre;

std::vector<int> kinds(const std::vector<bench::Span>& spans) {
    std::vector<int> result;
    for (const bench::Span& span : spans) result.push_back(span.what);
    return result;
}

TEST(StampRecorder, FillsWhatLiesBetween) {
    bench::SpanRecorder recorder(2, 100);
    recorder.mark_all(span_enter);
    const std::int64_t t = ticks();
    recorder.add(0, 3, t + 1000, t + 2000);
    recorder.add(0, span_controller, t + 2000, t + 3000);
    recorder.add(0, 4, t + 5000, t + 6000);
    while (ticks() < t + 100000) {}
    recorder.mark_all(span_exit);
    const std::vector<bench::Span> spans = recorder.spans(0);
    EXPECT_THAT(kinds(spans), ElementsAre(span_enter, 3, span_controller, span_wait, 4, span_exit));
    for (std::size_t i = 1; i < spans.size(); ++i) EXPECT_EQ(spans[i].begin, spans[i - 1].end) << i;
    EXPECT_THAT(kinds(recorder.spans(1)), ElementsAre(span_enter, span_exit)) << "a thread that never came";
}

TEST(StampRecorder, CountsNanoseconds) {
    bench::SpanRecorder recorder(1, 4);
    const auto begin = std::chrono::steady_clock::now();
    const std::int64_t first = ticks();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    recorder.add(0, 0, first, ticks());
    const auto passed = std::chrono::steady_clock::now() - begin;
    const bench::Span span = recorder.spans(0).at(0);
    EXPECT_GE(span.end - span.begin, 19'990'000);
    EXPECT_LE(span.end - span.begin, std::chrono::nanoseconds(passed).count() + 20'000);
}

TEST(StampRecorder, KeepsTheLatest) {
    bench::SpanRecorder recorder(1, 3);
    for (int task = 0; task < 5; ++task) recorder.add(0, task, 10 * task, 10 * task + 10);
    EXPECT_THAT(kinds(recorder.spans(0)), ElementsAre(2, 3, 4));
    EXPECT_EQ(recorder.lost(0), 2);
    recorder.clear();
    EXPECT_TRUE(recorder.spans(0).empty());
    EXPECT_EQ(recorder.lost(0), 0);
}

TEST(StampRecorder, RefusesToHoldNothing) {
    EXPECT_THROW(StampRecorder(0, 1), std::invalid_argument);
    EXPECT_THROW(StampRecorder(1, 0), std::invalid_argument);
}

TEST(Recorded, EveryTaskAndDecisionHasOneSpan) {
    test::for_each(test::pairs(), [&](const test::Case& each) {
        constexpr long cycles = 300;
        bench::SpanRecorder recorder(2, 10000);
        const auto executor = each.row->make({.threads = 2, .recorder = &recorder});
        test::World world({{5, 2}});
        world.run(*executor, cycles);
        world.run(*executor, cycles);
        std::map<int, long> seen;
        for (int thread = 0; thread < recorder.threads(); ++thread) {
            EXPECT_EQ(recorder.lost(thread), 0);
            const std::vector<bench::Span> spans = recorder.spans(thread);
            for (std::size_t i = 0; i < spans.size(); ++i) {
                ++seen[spans[i].what];
                EXPECT_LE(spans[i].begin, spans[i].end);
                if (i > 0) {
                    EXPECT_LE(spans[i - 1].end, spans[i].begin);
                }
            }
        }
        for (int task = 0; task < 7; ++task) EXPECT_EQ(seen[task], 2 * cycles) << task;
        EXPECT_EQ(seen[span_controller], 2 * (cycles + 1));
        EXPECT_EQ(seen[span_enter], 4);
        EXPECT_EQ(seen[span_exit], 4);
    });
}

TEST(StampRecorder, AllocatesNothingWhileRecording) {
    if (test::allocation_count() < 0) GTEST_SKIP() << "a sanitizer owns malloc";
    bench::SpanRecorder recorder(1, 100);
    const auto executor = find_executor("serial")->make({.recorder = &recorder});
    test::World world({{5, 2}});
    world.run(*executor, 10);
    const long before = test::allocation_count();
    world.run(*executor, 1000);
    EXPECT_EQ(test::allocation_count(), before);
}

/// Threads with OMP_WAIT_POLICY=active would wait on their processors for ever, and the next measurement would have one processor less.
TEST(OpenMpExecutors, KeepNoThreadThatIsReleased) {
    if (test::thread_sanitizer) GTEST_SKIP() << "it sees no synchronisation of OpenMP";
    int parallel = 0;
    for (const ExecutorRow& row : executors()) {
        if (row.waiting != Waiting::environment) continue;  // the others' threads sleep between runs
        for (const int threads : {1, 2, 4, 8}) {
            const auto executor = row.make({.threads = threads});
            test::World world(test::mixed_cycles());
            executor->release_threads();
            const int before = test::thread_count();
            for (int repetition = 0; repetition < 3; ++repetition) {
                world.run(*executor, 10);
                parallel += test::thread_count() > before;
                executor->release_threads();
                EXPECT_TRUE(test::falls_to_threads(before)) << row.name << ", " << threads << " threads";
            }
        }
    }
    EXPECT_TRUE(parallel > 0 || find_executor("omp_region") == nullptr);
}

TEST(Runtimes, OfTheLaboratoryAreNamedAndTeamsAreGranted) {
    EXPECT_EQ(bench::openmp_version() == "none", find_executor("omp_region") == nullptr);
    for (const auto& [runtime, name] :
         {std::pair{"oneTBB", "flow"}, {"OpenMP", "omp_region"}, {"Boost", "asio_pool"}, {"Taskflow", "taskflow"}})
        EXPECT_EQ(bench::runtime_versions().find(runtime) != std::string::npos, find_executor(name) != nullptr) << runtime;
    const WorkerGrant five(5);
    EXPECT_EQ(bench::team_grant(4), 4);
}

}  // namespace
}  // namespace cvtflow::engine
