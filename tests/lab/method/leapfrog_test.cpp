/// Leapfrogs of the laboratory beside those of the product: tables of their stages, and stages in double precision.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "bench/method/stability/program_stability.hpp"
#include "tasks/method/friction/kick_tables.hpp"
#include "tasks/run/simulation.hpp"
#include "tests/claims/operating_point_fixture.hpp"

namespace cvtflow::tasks {
namespace {

const engine::Cancellation uncancelled;

/// Velocities change by rounding of what the stages add, 6e-8 of it each: after 30 steps they differ, and by less than 1e-6 of the fastest.
TEST(FrictionLeapfrog, StagesInSinglePrecisionDifferFromDoubleByRoundingAlone) {
    const auto state_after = [](const std::string& method) {
        Simulation simulation(claims::ready_scene("baseline", {"run.method=" + method, "run.step=2us", "run.schedule=serial"}));
        SilentObserver silent;
        EXPECT_FALSE(simulation.advance({.until = 60e-6}, silent, uncancelled)) << method;
        const Workspace& w = simulation.workspace();
        return std::vector<double>(w.state(), w.state() + w.layout().size());
    };
    for (const std::string method : {"leapfrog-rkc", "leapfrog-chebyshev"}) {
        const std::vector<double> single = state_after(method), twice = state_after(method + "-double");
        double largest = 0.0, difference = 0.0;
        for (std::size_t k = 0; k < single.size(); ++k) {
            largest = std::max(largest, std::abs(twice[k]));
            difference = std::max(difference, std::abs(single[k] - twice[k]));
        }
        EXPECT_GT(difference, 0.0) << method;
        EXPECT_LT(difference, 1e-6 * largest) << method;
    }
}

TEST(KickTables, ReachFurtherTheMoreStagesTheyHaveAndTheCheapestIsTaken) {
    for (const Kick& kick : {chebyshev_kick, bench::rkc_kick}) {
        const KickTables tables(kick);
        int stages = 0;
        for (const double z : {1.0, 10.0, 100.0, 1000.0, 10000.0}) {
            const KickTable* table = tables.reaching(z);
            ASSERT_NE(table, nullptr) << z;
            EXPECT_GE(table->reach, z);
            EXPECT_GT(table->plan.stages(), stages);
            stages = table->plan.stages();
            double sum = 0.0;
            for (const double weight : table->weights) sum += weight;
            EXPECT_NEAR(sum, 1.0, 1e-12);  // the impulse of a constant force is exact
            for (int stage = 0; stage < stages; ++stage) {
                const int here = std::max(0, table->row(stage).here.keep);
                EXPECT_NE(table->row(stage).next.keep, here) << "neighbours read it in this stage: " << stage << " of " << stages;
            }
        }
        EXPECT_EQ(tables.reaching(1.01 * tables.longest_reach()), nullptr);
    }
}

}  // namespace
}  // namespace cvtflow::tasks
