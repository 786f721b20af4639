#include "tasks/scene/csv/csv_text.hpp"

#include <gtest/gtest.h>

namespace cvtflow::tasks {
namespace {

using Lines = std::vector<std::vector<std::string>>;

/// RFC 4180: quotes hold commas, line breaks, and quotes written twice.
TEST(CsvText, CellsInQuotesHoldCommasLineBreaksAndQuotes) {
    EXPECT_EQ(csv_lines("a,b\r\n\"1,5\", \"two\nlines\"\n\"say \"\"no\"\"\",\n"),
              (Lines{{"a", "b"}, {"1,5", " two\nlines"}, {"say \"no\"", ""}, {""}}));
    EXPECT_EQ(csv_lines(""), (Lines{{""}}));
}

TEST(CsvText, CellsOfOneLineAreTrimmed) {
    EXPECT_EQ(cells_of(" a ,\" b \"\t, \"c, d\"\r"), (std::vector<std::string>{"a", "b", "c, d"}));
    EXPECT_EQ(cells_of(""), (std::vector<std::string>{""}));
    EXPECT_EQ(cells_of("\"never closed, so"), (std::vector<std::string>{"never closed, so"}));
}

TEST(CsvText, SemicolonsSeparateAndCommasAreDecimal) {
    EXPECT_EQ(csv_separator("t [ms];torque [N*m]"), ';');
    EXPECT_EQ(csv_separator("t [ms],torque [N*m]"), ',');
    EXPECT_EQ(csv_separator("t [ms]\ttorque"), '\t');
    EXPECT_EQ(csv_lines("t;x\n1,5;-2,5e3\n1.5;1,2,3", ';'), (Lines{{"t", "x"}, {"1.5", "-2.5e3"}, {"1.5", "1,2,3"}}));
    EXPECT_EQ(cells_of(" 0,25 ; \"a;b\"", ';'), (std::vector<std::string>{"0.25", "a;b"}));
}

TEST(CsvText, HeadingsHaveUnitsInBrackets) {
    EXPECT_EQ(heading_of("load.torque [N*m]").name, "load.torque");
    EXPECT_EQ(heading_of("load.torque [N*m]").unit, "N*m");
    EXPECT_EQ(heading_of("slip").unit, "");
    EXPECT_TRUE(is_blank("  # a comment"));
    EXPECT_FALSE(is_blank("1 # no comment"));
}

}  // namespace
}  // namespace cvtflow::tasks
