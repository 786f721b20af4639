#include "engine/executor/runtimes.hpp"

#include <gtest/gtest.h>

#include "bench/executor/further_executors.hpp"
#include "engine/executor/catalogue.hpp"

namespace cvtflow::engine {
namespace {

TEST(Runtimes, AreNamed) {
    EXPECT_EQ(tbb_version().substr(0, 2), "20") << "year and release";
    EXPECT_NE(tbb_version().find("interface 12"), std::string::npos);
    EXPECT_EQ(bench::openmp_version() == "none", find_executor("omp_region") == nullptr);
    EXPECT_EQ(bench::asio_version() == "none", find_executor("asio_pool") == nullptr);
    EXPECT_EQ(bench::taskflow_version() == "none", find_executor("taskflow") == nullptr);
    for (const std::string& version : {tbb_version(), bench::openmp_version(), bench::asio_version(), bench::taskflow_version()})
        EXPECT_EQ(bench::runtime_versions().find(version) != std::string::npos, version != "none") << version;
    EXPECT_GE(usable_processors(), 1);
}

}  // namespace
}  // namespace cvtflow::engine
