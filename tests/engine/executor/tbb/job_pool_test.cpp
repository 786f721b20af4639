#include "engine/executor/tbb/job_pool.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstring>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>

namespace cvtflow::engine {
namespace {

TEST(RunJobs, RunsEveryJobOnceForAnyNumberOfThreads) {
    for (const int threads : {1, 2, 5}) {
        std::vector<std::atomic<int>> runs(200);
        long next = 0;
        run_jobs(
            threads, false, [&](int) { return next < 200 ? std::optional(next++) : std::nullopt; },
            [&](int worker, long job) {
                EXPECT_TRUE(worker >= 0 && worker < threads);
                ++runs[static_cast<std::size_t>(job)];
            });
        for (const auto& count : runs) EXPECT_EQ(count.load(), 1);
    }
}

TEST(RunJobs, EndsWithWhatAJobThrows) {
    long next = 0;
    const auto run = [&] {
        run_jobs(
            2, false, [&](int) { return next < 1000 ? std::optional(next++) : std::nullopt; },
            [](int, long job) {
                if (job == 3) throw std::runtime_error("job 3");
                // All others together take a second, longer than throwing.
                if (job > 3) std::this_thread::sleep_for(std::chrono::milliseconds(1));
            });
    };
    EXPECT_THROW(run(), std::runtime_error);
    EXPECT_LT(next, 1000);
}

TEST(OnceEach, IsMadeByOneWhileOthersWait) {
    OnceEach once;
    std::atomic<int> makers{0};
    long next = 0;
    run_jobs(
        4, false, [&](int) { return next < 40 ? std::optional(next++) : std::nullopt; },
        [&](int, long job) {
            const auto key = static_cast<std::uint64_t>(job % 3);
            if (!once.claim(key)) return;
            ++makers;
            once.made(key);
        });
    EXPECT_EQ(makers.load(), 3);
}

}  // namespace
}  // namespace cvtflow::engine
