/// The page of exit statuses has the rows of the program's help.

#include <gtest/gtest.h>

#include <regex>
#include <sstream>

#include "tests/docs/page_fixture.hpp"
#include "tools/program/guard.hpp"

namespace cvtflow::docs {
namespace {

TEST(ExitStatusPage, HasARowForEveryStatusOfTheHelp) {
    const std::string text = page("docs/exit_status.md").text;
    std::istringstream help{std::string(tools::exit_status_table)};
    std::size_t rows = 0;
    for (std::string line; std::getline(help, line);) {
        std::smatch match;
        if (!std::regex_match(line, match, std::regex("  ([0-9]+) .*"))) continue;
        EXPECT_NE(text.find("\n| " + match[1].str() + " | "), std::string::npos) << line;
        ++rows;
    }
    EXPECT_GE(rows, 8u);
}

}  // namespace
}  // namespace cvtflow::docs
