#include "engine/executor/runtimes.hpp"

#include <gtest/gtest.h>

#include "engine/executor/catalogue.hpp"

namespace cvtflow::engine {
namespace {

TEST(Runtimes, AreNamed) {
    EXPECT_EQ(tbb_version().substr(0, 2), "20") << "year and release";
    EXPECT_NE(tbb_version().find("interface 12"), std::string::npos);
    EXPECT_EQ(openmp_version() == "none", find_executor("omp_fork") == nullptr);
    EXPECT_GE(usable_processors(), 1);
}

}  // namespace
}  // namespace cvtflow::engine
