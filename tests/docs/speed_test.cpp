/// One table contains the default's speed (docs/performance.md); the first page repeats one figure of it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "tests/docs/page_fixture.hpp"

namespace cvtflow::docs {
namespace {

TEST(SpeedOfTheDefault, IsInTheReadmeAsInItsTable) {
    const std::string readme = page("README.md").text, table = page("docs/performance.md").text;
    std::smatch said, measured;
    ASSERT_TRUE(std::regex_search(readme, said, std::regex(R"(\| default method and RK4 \(longest right step\) \| (\d+) times faster)")));
    ASSERT_TRUE(std::regex_search(table, measured, std::regex(R"(\n\| `rk4` at 45 ns \| [^|]+ \| (\d+) )")));
    EXPECT_EQ(said[1], measured[1]);
}

}  // namespace
}  // namespace cvtflow::docs
