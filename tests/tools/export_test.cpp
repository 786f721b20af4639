/// Files for other programs: `cvtflow export RECORD --vtk FILE` and `cvtflow export-fmu`.

#include <gmock/gmock.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <numeric>
#include <regex>
#include <sstream>

#include "tests/tools/program_fixture.hpp"

namespace cvtflow::tools {
namespace {

using testing::HasSubstr;
using testing::Not;

// `cvtflow export RECORD --vtk FILE`.

class Export : public Program {
protected:
    /// Outputs at every state, so that channels and pictures are of the same instants.
    void SetUp() override {
        made_once("a record of plates and tips", [this] {
            const Words settings{"record.channels=[\"plates/*\", \"tips/*\"]", "run.output_interval=5 us", "run.state_interval=5 us"};
            ASSERT_EQ(run_briefly(Words{"-q", "-o", "run.h5"} + set_all(settings)).status, 0);
        });
    }
};

/// Sums over a row of a channel.
double sum_of(const engine::RunReader& record, const std::string& channel, std::size_t row, bool magnitudes) {
    const auto values = record.channel(channel);
    const std::size_t width = values.size() / record.rows();
    double sum = 0.0;
    for (std::size_t k = row * width; k < (row + 1) * width; ++k) sum += magnitudes ? std::abs(values[k]) : values[k];
    return sum;
}

/// Sum of the magnitudes of the tips' forces in the plane.
double sum_in_plane(const engine::RunReader& record, std::size_t row) {
    const auto radial = record.channel("tips/radial_force"), tangential = record.channel("tips/tangential_force");
    const std::size_t width = radial.size() / record.rows();
    double sum = 0.0;
    for (std::size_t k = row * width; k < (row + 1) * width; ++k) sum += std::hypot(radial[k], tangential[k]);
    return sum;
}

/// Every time step: tensions, tip forces and places are those of the record, to the seven digits of its numbers.
TEST_F(Export, IsReadBackByVtkWithTheRecordsForcesAndPlaces) {
    const Outcome outcome = run({"export", "run.h5", "--vtk", "run.pvd"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("run.pvd"));
    const std::string command = "/usr/bin/env python3 '" CVTFLOW_SOURCE_DIR "/tests/tools/read_vtk.py' '" + (folder_ / "run.pvd").string() +
                                "' > '" + (folder_ / "vtk.txt").string() + "'";
    int status = std::system(command.c_str());
    if (WEXITSTATUS(status) == 77) status = std::system(("/usr/bin/python3" + command.substr(command.find(" '"))).c_str());
    if (WEXITSTATUS(status) == 77 || WEXITSTATUS(status) == 127) GTEST_SKIP() << "needs VTK for Python (Debian: python3-vtk9)";
    ASSERT_EQ(status, 0);
    const engine::RunReader record = Export::record("run.h5");
    std::istringstream lines(read("vtk.txt"));
    const std::vector<double> times = record.state_times();
    ASSERT_GT(times.size(), 3u);
    for (std::size_t step = 0; step < times.size(); ++step) {
        double time = 0.0, tension = 0.0, axial = 0.0, plane = 0.0, x = 0.0, y = 0.0, z = 0.0;
        std::size_t cells = 0;
        lines >> time >> cells >> tension >> axial >> plane >> x >> y >> z;
        ASSERT_TRUE(lines) << step;
        EXPECT_EQ(time, times[step]);
        EXPECT_NEAR(tension, sum_of(record, "plates/tension", step, false), 1e-6 * sum_of(record, "plates/tension", step, true));
        const double forces = sum_of(record, "tips/axial_force", step, true);
        EXPECT_NEAR(axial, forces, 1e-6 * forces);
        EXPECT_NEAR(plane, sum_in_plane(record, step), 1e-6 * forces);
        const auto state = record.state(step).state;  // of the rear half of link 0; P_2(0) = -1/2
        EXPECT_NEAR(x, state[0] - 0.5 * state[2], 1e-7 * std::abs(state[0]));
    }
    std::string more;
    EXPECT_FALSE(lines >> more) << "more states than the record has";
}

TEST_F(Export, TakesEveryNthState) {
    EXPECT_THAT(run({"export", "run.h5", "--vtk", "run.pvd", "--every", "2"}).out, HasSubstr("3 states"));
    EXPECT_THAT(read("run.pvd"), HasSubstr("<DataSet timestep=\"1e-05\" file=\"run/run_000001.vtu\"/>"));
    EXPECT_FALSE(exists("run/run_000003.vtu"));
}

TEST_F(Export, WritesChannelsAsOneTableWithUnits) {
    ASSERT_EQ(run({"export", "run.h5", "--csv", "all.csv"}).status, 0);
    EXPECT_THAT(read("all.csv"), testing::StartsWith("time [s],"));
    EXPECT_THAT(read("all.csv"), HasSubstr(",shaft_1/speed [rad/s],"));
    ASSERT_EQ(run({"export", "run.h5", "ratio", "links/tension", "--csv", "some.csv"}).status, 0);
    const engine::RunReader record = Export::record("run.h5");
    const std::vector<double> ratio = record.channel("ratio"), tension = record.channel("links/tension"), times = record.times();
    const std::size_t links = tension.size() / times.size();
    std::istringstream lines(read("some.csv"));
    std::string line;
    ASSERT_TRUE(std::getline(lines, line));
    EXPECT_THAT(line, testing::StartsWith("time [s],ratio [1],links/tension[0] [N],links/tension[1] [N],"));
    for (std::size_t row = 0; row < times.size(); ++row) {
        ASSERT_TRUE(std::getline(lines, line));
        std::istringstream cells(line);
        std::vector<double> numbers;
        for (std::string cell; std::getline(cells, cell, ',');) numbers.push_back(std::stod(cell));
        ASSERT_EQ(numbers.size(), 2 + links);
        EXPECT_EQ(numbers[0], times[row]);
        EXPECT_EQ(numbers[1], ratio[row]);
        EXPECT_EQ(numbers.back(), tension[row * links + links - 1]);
    }
    EXPECT_EQ(run({"export", "run.h5", "slp", "--csv", "x.csv"}).status, 2);
}

TEST_F(Export, ReportsWhatItCannotWrite) {
    EXPECT_EQ(run({"export", "run.h5"}).status, 2);
    EXPECT_EQ(run({"export", "run.h5", "--vtk", "x.vtk"}).status, 2);
    EXPECT_EQ(run({"export", "none.h5", "--vtk", "x.pvd"}).status, 1);
    EXPECT_EQ(run({"export", "run.h5", "--vtk", "none/x.pvd"}).status, 1);
    EXPECT_EQ(run({"export", "run.h5", "--vtk", "x.pvd", "--every", "0"}).status, 2);
    EXPECT_FALSE(exists("x.pvd"));
}

// Terminals of FMUs.

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
    std::vector<std::pair<std::string, std::string>> rows{{"1 ms", "0.0001"}, {"40 us", "4e-05"}, {"10 s", "0.001"}};
    rows.resize(test::depth(1, 3));
    for (const auto& [until, step] : rows) {
        ASSERT_EQ(run({"export-fmu", "tiny", "-q", "-o", "t.fmu", "--force", "--set", "run.until=" + until}).status, 0);
        EXPECT_THAT(read("t.fmu"), HasSubstr("stepSize=\"" + step + "\"")) << until;
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
