#include "engine/executor/runtimes.hpp"

#include <gtest/gtest.h>

#include "engine/executor/catalogue.hpp"

namespace cvtflow::engine {
namespace {

TEST(Runtimes, AreNamed) {
    EXPECT_EQ(tbb_version().substr(0, 2), "20") << "year and release";
    EXPECT_NE(tbb_version().find("interface 12"), std::string::npos);
    EXPECT_EQ(openmp_version() == "none", find_executor("omp_fork") == nullptr);
    EXPECT_EQ(asio_version() == "none", find_executor("asio_pool") == nullptr);
    EXPECT_EQ(taskflow_version() == "none", find_executor("taskflow") == nullptr);
    for (const std::string& version : {tbb_version(), openmp_version(), asio_version(), taskflow_version()})
        EXPECT_EQ(runtime_versions().find(version) != std::string::npos, version != "none") << version;
    EXPECT_GE(usable_processors(), 1);
}

}  // namespace
}  // namespace cvtflow::engine
