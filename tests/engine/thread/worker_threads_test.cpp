#include "engine/thread/worker_threads.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "bench/executor/further_executors.hpp"
#include "engine/base/provenance.hpp"
#include "engine/executor/catalogue.hpp"
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
    EXPECT_EQ(bench::team_grant(4), 4);
    EXPECT_EQ(thread_shortage().requested, 0);
}

TEST(BareBarrier, TakesTimeAndIsGivenUpWhereAThreadKeepsTheCallerWaiting) {
    const int before = test::thread_count();
    EXPECT_GT(bare_barrier_cycle(1, 1e-3, 1.0), 0.0);
    const double two = bare_barrier_cycle(2, 1e-3, 10.0);
    EXPECT_GT(two, 1e-9);
    EXPECT_LT(two, 10.0);
    const int crowd = 2 * usable_processors() + 2;  // one of them always waits for a processor
    EXPECT_EQ(bare_barrier_cycle(crowd, 1e-3, 0.2e-3), std::numeric_limits<double>::infinity());
    EXPECT_TRUE(test::falls_to_threads(before)) << "all have left";
}

TEST(ThreadShortage, KeepsTheLargerOne) {
    ThreadShortage shortage;
    shortage.note(4, 2);
    shortage.note(2, 1);
    EXPECT_EQ(shortage.requested, 4);
    EXPECT_EQ(shortage.had, 2);
    shortage.note(8, 1);
    EXPECT_EQ(shortage.requested, 8);
}

TEST(Runtimes, AreNamed) {
    EXPECT_EQ(tbb_version().substr(0, 2), "20") << "year and release";
    EXPECT_NE(tbb_version().find("interface 12"), std::string::npos);
    EXPECT_EQ(bench::openmp_version() == "none", find_executor("omp_region") == nullptr);
    EXPECT_EQ(bench::asio_version() == "none", find_executor("asio_pool") == nullptr);
    EXPECT_EQ(bench::taskflow_version() == "none", find_executor("taskflow") == nullptr);
    for (const std::string& version : {tbb_version(), bench::openmp_version(), bench::asio_version(), bench::taskflow_version()})
        EXPECT_EQ(bench::runtime_versions().find(version) != std::string::npos, version != "none") << version;
}

}  // namespace
}  // namespace cvtflow::engine
