/// One page contains speeds (docs/speeds.md), drawn from a committed table; other pages link to it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "tests/docs/page_fixture.hpp"

namespace cvtflow::docs {
namespace {

/// Seconds per simulated second of a row of bench/results/speeds.csv, by a regular expression for the fields before the median.
double seconds(const std::string& row) {
    std::ifstream file(CVTFLOW_SOURCE_DIR "/bench/results/speeds.csv");
    std::stringstream text;
    text << file.rdbuf();
    const std::string table = text.str();
    std::smatch found;
    if (!std::regex_search(table, found, std::regex("\n" + row + ",([0-9.]+),"))) ADD_FAILURE() << row;
    return found.empty() ? 0.0 : std::stod(found[1]);
}

/// Lines that state how fast the default is, or how long a simulated second takes.
std::vector<std::string> speeds(const Page& page) {
    static const std::regex factor(R"(\d+ (times (as fast|faster)|s/s)|\d+(\.\d+)? (s|seconds)( of processor time)? per simulated second)");
    static const std::regex column(R"(\|[^|]*(seconds per simulated second|faster than RK4)[^|]*\|)");
    static const std::regex share(R"((twentieth|thirtieth|nineteenth|eightieth) of (the cost|RK4|its time))");
    std::vector<std::string> found;
    for (const Line& line : page.text_lines())
        for (const std::regex* pattern : {&factor, &column, &share})
            if (std::regex_search(line.text, *pattern)) found.push_back(page.path + ":" + std::to_string(line.number) + ": " + line.text);
    return found;
}

/// Pages of reasons and of research compare methods of the laboratory and published figures with each other.
bool is_research(const std::string& path) {
    return path.starts_with("docs/decisions/") || path.starts_with("docs/laboratory/") || path == "docs/paper.md" || path == "CHANGELOG.md";
}

TEST(SpeedOfTheDefault, IsInTheReadmeAsInItsTable) {
    const std::string readme = page("README.md").text;
    std::smatch stated;
    ASSERT_TRUE(std::regex_search(readme, stated, std::regex(R"(\| default method and RK4 \(longest right step\) \| (\d+) times faster)")));
    const double ratio = seconds("method,`rk4` at 45 ns") / seconds("method,\"default [^\"]*\"");
    EXPECT_EQ(std::stol(stated[1]), std::lround(ratio));
}

TEST(PagesOfSpeed, AreDrawnFromTheCommittedTable) {
    EXPECT_EQ(std::system("python3 " CVTFLOW_SOURCE_DIR "/tools/documents/speeds --check"), 0);
}

TEST(PagesOfSpeed, AreNotRepeatedElsewhere) {
    for (const Page& each : pages()) {
        if (is_research(each.path) || each.path == "docs/speeds.md" || each.path == "README.md") continue;
        EXPECT_THAT(speeds(each), testing::IsEmpty());
    }
    EXPECT_THAT(speeds(page("README.md")), testing::SizeIs(1));
    EXPECT_THAT(speeds(page("docs/speeds.md")), testing::SizeIs(2));
}

TEST(PagesOfSpeed, AreRecognised) {
    const Page sample{"sample.md",
                      "It is 71 times faster.\nIt takes 1.4 s of processor time per simulated second.\n| `rk4` | 713 s/s |\n"
                      "| scene | seconds per simulated second |\na nineteenth of the cost\nThe summary contains seconds per "
                      "simulated second.\n\n```text\n71 times faster\n```\n"};
    EXPECT_THAT(speeds(sample), testing::SizeIs(5));
}

}  // namespace
}  // namespace cvtflow::docs
