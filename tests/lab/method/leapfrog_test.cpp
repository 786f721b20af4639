/// Tables of the stages of leapfrogs, of the laboratory and of the product.

#include <gtest/gtest.h>

#include <algorithm>

#include "bench/method/laboratory_methods.hpp"
#include "tasks/method/friction/kick_tables.hpp"

namespace cvtflow::tasks {
namespace {

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
