/// Terminals of FMUs.

#include <gmock/gmock.h>

#include <cstdlib>
#include <regex>

#include "tests/tools/program_fixture.hpp"

namespace cvtflow::tools {
namespace {

using testing::HasSubstr;
using testing::Not;

class FmuTerminals : public Program {
protected:
    /// terminalsAndIcons.xml of an FMU in the test's folder; the description alone is stored uncompressed.
    [[nodiscard]] std::string terminals(const std::string& fmu) const {
        const std::string unpack = "cd '" + folder_.string() + "' && python3 -m zipfile -e " + fmu + " parts";
        EXPECT_EQ(std::system(unpack.c_str()), 0);
        return read("parts/terminalsAndIcons/terminalsAndIcons.xml");
    }
};

/// Outputs every 10 us are for pictures; importers took them for the communication step, at three times the cost.
TEST_F(FmuTerminals, AndTheDefaultExperimentHasCommunicationStepsThatCostLittle) {
    for (const auto& [until, step] : {std::pair{"1 ms", "0.0001"}, {"40 us", "4e-05"}, {"10 s", "0.001"}}) {
        ASSERT_EQ(run({"export-fmu", "tiny", "-q", "-o", "t.fmu", "--force", "--set", "run.until=" + std::string(until)}).status, 0);
        EXPECT_THAT(read("t.fmu"), HasSubstr("stepSize=\"" + std::string(step) + "\"")) << until;
    }
}

TEST_F(FmuTerminals, GatherInputsAndOutputsByShaft) {
    ASSERT_EQ(run({"export-fmu", "tiny", "-q", "-o", "t.fmu", "--outputs", "ratio,shaft_1/speed,shaft_2/speed"}).status, 0);
    const std::string fmu = terminals("t.fmu");
    const auto member = [](const char* variable, const char* name) {
        return HasSubstr("variableName=\"" + std::string(variable) + "\" memberName=\"" + name + "\" variableKind=\"signal\"");
    };
    const auto begin = fmu.find("<fmiTerminalsAndIcons fmiVersion=\"3.0\">"), driven = fmu.find("<Terminal name=\"shaft_2\"", begin);
    ASSERT_NE(begin, std::string::npos);
    ASSERT_NE(driven, std::string::npos);
    const std::string first = fmu.substr(begin, driven - begin), second = fmu.substr(driven, fmu.find("</fmiTerminalsAndIcons>") - driven);
    EXPECT_THAT(first, testing::AllOf(member("shaft_1.speed", "speed"), member("clamping_driving", "clamping_driving"),
                                      member("drive_speed", "drive_speed"), Not(HasSubstr("load_torque")), Not(HasSubstr("ratio"))));
    EXPECT_THAT(second, testing::AllOf(member("shaft_2.speed", "speed"), member("load_torque", "load_torque"),
                                       member("clamping_driven", "clamping_driven"), Not(HasSubstr("shaft_1"))));
}

TEST_F(FmuTerminals, NameOnlyVariablesThatTheFmuHas) {
    ASSERT_EQ(run({"export-fmu", "tiny", "-q", "-o", "t.fmu", "--inputs", "load_torque", "--outputs", "ratio"}).status, 0);
    const std::string fmu = terminals("t.fmu");
    EXPECT_THAT(fmu, Not(HasSubstr("<Terminal name=\"shaft_1\"")));
    const std::regex used("TerminalMemberVariable variableName=\"([^\"]*)\"");
    const std::string from = fmu.substr(fmu.find("<fmiTerminalsAndIcons"));
    const auto count = std::distance(std::sregex_iterator(from.begin(), from.end(), used), std::sregex_iterator());
    EXPECT_EQ(count, 1) << "the load alone";
    EXPECT_THAT(fmu, HasSubstr("variableName=\"load_torque\""));
}

TEST_F(FmuTerminals, AreNotPartOfTheSecondVersionOfTheStandard) {
    ASSERT_EQ(run({"export-fmu", "tiny", "-q", "-o", "t.fmu", "--fmi", "2"}).status, 0);
    EXPECT_THAT(read("t.fmu"), Not(HasSubstr("terminalsAndIcons/")));
}

}  // namespace
}  // namespace cvtflow::tools
