#include <gtest/gtest.h>
#include <filesystem>
#include <fstream>
#include <utility>

#include "tasks/scene/csv.hpp"
#include "tests/tasks/tiny_fixture.hpp"
#include "tests/temporary_file_fixture.hpp"

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

/// Doubtful number in a file of one column beside the time, or "".
std::string doubt(const std::string& numbers) {
    std::string text = "# measured\nt;x";
    for (const char c : numbers) text += c == ' ' ? std::string("\n0;") : std::string(1, c);
    const auto found = doubtful_number(text);
    return found ? std::to_string(found->position.line) + ": " + found->message : "";
}

TEST(CsvText, ANumberWithThreeDigitsBehindACommaIsDoubtful) {
    EXPECT_EQ(doubt(" 12,000"), "3: \"12,000\" can be 12 or 12000: write it without the comma, or with a different number of decimals");
    EXPECT_NE(doubt(" 1 -1,250 7"), "");
    const auto by_tabs = doubtful_number("t\tx\n0\t12,000\n");
    ASSERT_TRUE(by_tabs);
    EXPECT_EQ(by_tabs->position.line, 2);
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

class CsvPoints : public testing::Test {
protected:
    void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
    /// The load's torque of a scene that has this value for it.
    [[nodiscard]] model::TimeTable load(const std::string& value) const {
        return parse_scene("[load]\ntorque = " + value + "\n", folder_ / "scene.toml").parameters.load.torque;
    }
    [[nodiscard]] std::string problem(const std::string& value) const {
        const std::string text = message_of([&] { return load(value); });
        return text.empty() ? "none" : text.substr(text.find("load.torque"));
    }

    const tests::TemporaryFolder folder_{"csv"};
};

TEST_F(CsvPoints, AreColumnsByTheirNamesWithUnitsOfTheHeadingOrTheCells) {
    write("drive.csv", "# measured\nspeed, t [ms] ,torque [kN*m]\n1,0,0.15\n\n2, 10 ,0.2\n3,30.5,1.25e-1\n");
    const model::TimeTable expected({0.0, 0.010, 0.0305}, {150.0, 200.0, 125.0});
    EXPECT_EQ(load(R"({csv = "drive.csv", time = "t", value = "torque"})"), expected);
    write("cells.csv", "t,M\n0 s,150 N*m\n\"10 ms\",200 N*m\n0.0305,0.125 kN*m\n");
    EXPECT_EQ(load(R"({csv = "cells.csv"})"), expected);
}

/// What an engineer writes first: the name of the file alone, a decimal comma, "-" as the unit of a plain number.
TEST_F(CsvPoints, AreTheFirstTwoColumnsOfAFileThatIsNamedAlone) {
    write("oil.csv", "v [mm/s];friction [-]\n20;0,09\n300;0,05\n");
    const model::SpeedTable expected{{0.02, 0.3}, {0.09, 0.05}};
    for (const char* table : {"\"oil.csv\"", "{csv = \"oil.csv\", speed = \"v\", value = \"friction\"}"}) {
        const Scene scene =
            parse_scene("[tip]\nfriction_law = \"table\"\nfriction_table = " + std::string(table) + "\n", folder_ / "scene.toml");
        EXPECT_EQ(scene.parameters.tip.friction_table, expected) << table;
    }
}

TEST_F(CsvPoints, AreRefusedWhereACommaMayBeOfThousands) {
    write("drive.csv", "t;M\n0;12,000\n1;13,500\n");
    EXPECT_EQ(problem(R"({csv = "drive.csv"})").substr(0, 58), "load.torque: drive.csv:2: \"12,000\" can be 12 or 12000: wri");
    write("drive.csv", "t;M\n0,000;12,000\n1,000;13,500\n");
    EXPECT_EQ(load(R"({csv = "drive.csv"})"), model::TimeTable({0.0, 1.0}, {12.0, 13.5}));
}

TEST_F(CsvPoints, CountFromTheScenesFolderAndForASettingFromTheWorkingOne) {
    write("drive.csv", "t,M\n0,1\n1,2\n");
    Scene scene = parse_scene("", folder_ / "scene.toml");
    const auto before = std::filesystem::current_path();
    std::filesystem::current_path(folder_ / "");
    set_value(scene, R"(load.torque={csv = "drive.csv"})");
    const model::TimeTable by_key = std::exchange(scene.parameters.load.torque, {});
    set_value(scene, "load.torque=drive.csv");
    std::filesystem::current_path(before);
    EXPECT_EQ(scene.parameters.load.torque, by_key);
    EXPECT_EQ(scene.parameters.load.torque, model::TimeTable({0.0, 1.0}, {1.0, 2.0}));
}

/// A stranger's record or checkpoint contains a scene; it must not make this program read other files.
TEST_F(CsvPoints, AreNotReadForARecordedScene) {
    write("drive.csv", "t,M\n0,1\n1,2\n");
    const std::string text = "[load]\ntorque = {csv = \"drive.csv\"}\n";
    EXPECT_NO_THROW((void)parse_scene(text, folder_ / "scene.toml", StartState::ignored));
    EXPECT_EQ(message_of([&] { return parse_scene(text, folder_ / "scene.toml", StartState::recorded); }),
              folder_ / "scene.toml:2:10: load.torque: a recorded scene has the points of its tables; it names no file");
}

TEST_F(CsvPoints, AreKeptWithTheSceneWithoutTheFile) {
    write("drive.csv", "t,M\n0,1\n0.25,2\n");
    const Scene scene = parse_scene("[load]\ntorque = {csv = \"drive.csv\"}\n", folder_ / "scene.toml");
    std::filesystem::remove(folder_ / "drive.csv");
    EXPECT_EQ(parse_scene(write_scene(scene), "again.toml").parameters, scene.parameters);
}

TEST_F(CsvPoints, SayWhatIsWrongAndWhere) {
    for (const auto& [name, text] : {std::pair{"good", "t,torque\n0,1\n1,2\n"},
                                     {"range", "t,torque\n0,1\n1,2e9\n"},
                                     {"late", "t,torque\n1,1\n1,2\n"},
                                     {"text", "t,torque\n0,a lot\n"},
                                     {"ragged", "t,torque\n0,1\n1\n"},
                                     {"unit", "t [ms],torque [kg]\n0,1\n"},
                                     {"one", "t\n0\n"},
                                     {"empty", "t,torque\n"}})
        write(std::string(name) + ".csv", text);
    for (const auto& [value, message] :
         {std::pair{R"(csv = "none.csv")", "no file \"none.csv\""},
          {R"(time = "t")", "csv = \"FILE\" is missing"},
          {R"(csv = "good.csv", valeu = "t")", "valeu: unknown key (did you mean \"value\"?)"},
          {R"(csv = "good.csv", value = 3)", "value is not a text"},
          {R"(csv = "good.csv", value = "torqe")", "\"good.csv\" has no column \"torqe\" (did you mean \"torque\"?)"},
          {R"(csv = "range.csv")", "2e9 N*m is outside [-1e5, 1e5] N*m (range.csv:3:2)"},
          {R"(csv = "late.csv")", "time 1 s is not later than 1 s (late.csv:3:1)"},
          {R"(csv = "ragged.csv")", "ragged.csv:3: 1 cells, not 2"},
          {R"(csv = "one.csv")", "one.csv:1: one column, not time and value"},
          {R"(csv = "empty.csv")", "\"empty.csv\" has no rows"},
          {R"(csv = ".")", "\".\" cannot be read: a folder, not a file"}})
        EXPECT_EQ(problem(std::string("{") + value + "}"), std::string("load.torque: ") + message);
    EXPECT_NE(problem(R"({csv = "text.csv"})").find("(text.csv:2:2)"), std::string::npos);
    EXPECT_NE(problem(R"({csv = "unit.csv"})").find("expected a torque (N*m) (unit.csv:2:2)"), std::string::npos);
}

}  // namespace

}  // namespace cvtflow::tasks
