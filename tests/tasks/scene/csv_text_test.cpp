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

/// What is doubtful in a file of one column beside the time, or "".
std::string doubt(const std::string& numbers) {
    std::string text = "# measured\nt;x";
    for (const char c : numbers) text += c == ' ' ? std::string("\n0;") : std::string(1, c);
    const auto found = doubtful_number(text);
    return found ? std::to_string(found->line) + ": " + found->problem : "";
}

TEST(CsvText, ANumberWithThreeDigitsBehindACommaIsDoubtful) {
    EXPECT_EQ(doubt(" 12,000"), "3: \"12,000\" can be 12 or 12000: write it without the comma, or with a different number of decimals");
    EXPECT_NE(doubt(" 1 -1,250 7"), "");
    const auto by_tabs = doubtful_number("t\tx\n0\t12,000\n");
    ASSERT_TRUE(by_tabs);
    EXPECT_EQ(by_tabs->line, 2);
    EXPECT_FALSE(doubtful_number("t,x\n0,\"12,000\"\n"));  // is no number there
}

TEST(CsvText, OtherNumbersOfTheFileShowWhichMarkIsDecimal) {
    for (const char* decimal_comma : {" 12,000 0,5", " 0,125 12,000", " 12,000 1.234,5", " 1,25e3 12,000", " 1.234.567 12,000"})
        EXPECT_EQ(doubt(decimal_comma), "") << decimal_comma;
    for (const char* decimal_point : {" 12,000 0.5", " 12,000 1,234.5", " 12,000 1,234,567"})
        EXPECT_NE(doubt(decimal_point), "") << decimal_point;
    EXPECT_EQ(doubt(" 1.234 1.5"), "");
    EXPECT_EQ(doubt(" 1.234"), "");
    EXPECT_EQ(doubt(" 1.234 0,5"), "3: \"1.234\" can be 1.234 or 1234: write it without the point, or with a different number of decimals");
    for (const char* plain : {" 12 1200 1e3", " 0,125", " 1234,567", " 12,00", " 12,0000", " 1,250e3", " a,123"})
        EXPECT_EQ(doubt(plain), "") << plain;
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
