/// Pages of `cvtflow report`, and the hashes by which they permit their scripts.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <sstream>
#include <string>

#include "tests/tools/forgery_fixture.hpp"
#include "tests/tools/program_fixture.hpp"
#include "tools/program/text/markup.hpp"

namespace cvtflow::tools {
namespace {

using testing::HasSubstr;
using testing::Not;

class ReportCommand : public Program {
protected:
    void SetUp() override {
        made_once("a record for reports", [this] {
            const Outcome outcome = run_briefly({"-o", "run.h5", "--set", "run.output_interval=1 us", "--set", "load.torque=7 N*m"});
            ASSERT_EQ(outcome.status, 0) << outcome.err;
        });
        static const std::string said = run({"report", "run.h5"}).err;
        if (said.find("libjs-dygraphs") != std::string::npos) GTEST_SKIP() << "built without libjs-dygraphs and libjs-three";
    }
};

TEST_F(ReportCommand, IsOneFileThatAsksForNoOther) {
    ASSERT_EQ(run({"report", "run.h5", "-o", "page.html"}).status, 0);
    const std::string page = read("page.html");
    EXPECT_FALSE(std::regex_search(page, std::regex(R"(<(script|link|img|iframe)[^>]*(src|href)="(?!data:))")));
    EXPECT_THAT(page, HasSubstr("default-src 'none'"));
    EXPECT_LT(page.size(), 5000000U);
}

/// Debian's three.min.js has no notice of its own, dygraphs' only a link.
TEST_F(ReportCommand, ContainsTheLicencesOfItsScripts) {
    ASSERT_EQ(run({"report", "run.h5", "-o", "page.html"}).status, 0);
    const std::string page = read("page.html");
    const std::string notice = page.substr(page.rfind("<!--"));
    for (const char* part : {"three.js authors", "Dan Vanderkam", "Permission is hereby granted", "OTHER DEALINGS IN THE"})
        EXPECT_THAT(notice, HasSubstr(part));
    EXPECT_THAT(notice.substr(4, notice.size() - 8), Not(HasSubstr("--"))) << "which would end a comment";
    EXPECT_THAT(run({"list", "licenses"}).out, testing::AllOf(HasSubstr("three.js authors"), HasSubstr("CLI11"), HasSubstr("toml++"),
                                                              HasSubstr("JSON for Modern C++"), HasSubstr("Eigen"), HasSubstr("pybind11")));
}

TEST_F(ReportCommand, ReportsWhatWasSimulatedAndWhatIsNotTheDefault) {
    ASSERT_EQ(run({"report", "run.h5"}).status, 0);
    const std::string page = read("run.html");
    EXPECT_LT(page.find("class=\"status\""), page.find("\">Key figures</h2>"));
    EXPECT_LT(page.find("\">Key figures</h2>"), page.find("\">What was simulated</h2>"));
    EXPECT_LT(page.find("\">What was simulated</h2>"), page.find("\">Curves</h2>"));
    EXPECT_THAT(page, HasSubstr("<td><code>load.torque</code></td><td>7 N*m</td>"));
    EXPECT_THAT(page, Not(HasSubstr("<td><code>chain.pitch</code></td>")));
    EXPECT_THAT(page, HasSubstr("shaft 1 drives ("));
}

TEST_F(ReportCommand, GivesKeysInTheUnitsOfTheirTable) {
    ASSERT_EQ(run_briefly({"-o", "own.h5", "--set", "tip.angle=10 deg", "--set", "drive.speed=1800 rpm"}).status, 0);
    ASSERT_EQ(run({"report", "own.h5"}).status, 0);
    EXPECT_THAT(read("own.html"), testing::AllOf(HasSubstr("<td><code>tip.angle</code></td><td>10 deg</td><td>11 deg</td>"),
                                                 HasSubstr("<td><code>drive.speed</code></td><td>1800 rpm</td>")));
}

TEST_F(ReportCommand, HasTheStepThatWasTakenInItsProvenance) {
    ASSERT_EQ(run({"report", "run.h5"}).status, 0);
    EXPECT_THAT(read("run.html"), testing::AllOf(HasSubstr("<th scope=\"row\">step</th><td>50 ns</td>"), Not(HasSubstr("step_taken"))));
}

/// Pins of tiny pass every 2.5 ms.
TEST_F(ReportCommand, HasNoSpectraOfOutputsThatPinsOvertake) {
    const Words slow{"--until", "20 ms", "--step", "200 ns", "--set", "run.output_interval=2 ms", "--set", "run.state_interval=2 ms"};
    const Outcome outcome = run_briefly(Words{"-o", "slow.h5"} + slow);
    ASSERT_THAT(outcome.status, testing::AnyOf(0, 6)) << outcome.err;
    change_record((folder_ / "slow.h5").string(), [](hid_t file) { put_text(file, "/", "notes", ""); });
    ASSERT_EQ(run({"report", "slow.h5"}).status, 0);
    EXPECT_THAT(read("slow.html"), HasSubstr("No spectra: slow.h5: outputs are 2 ms apart, and pins pass at "));
    ASSERT_EQ(run({"plot", "slow.h5", "slip", "-o", "slow.svg"}).status, 0);
    EXPECT_THAT(read("slow.svg"), testing::ContainsRegex("outputs are 2 ms apart, and pins pass at [0-9.]+ Hz: curves are samples"));
    const Outcome orders = run({"plot", "slow.h5", "slip", "--orders"});
    EXPECT_EQ(orders.status, 2);
    EXPECT_THAT(orders.err, HasSubstr("spectra require run.output_interval below "));
    change_record((folder_ / "slow.h5").string(), [](hid_t file) { put_text(file, "/", "notes", "unsteady"); });
    ASSERT_EQ(run({"report", "slow.h5"}).status, 0);
    EXPECT_THAT(read("slow.html"), HasSubstr("No spectra: slow.h5: the run is unsteady"));
}

TEST_F(ReportCommand, WarnsFirstOfWhatIsNotFinished) {
    cut("run.h5", "cut.h5", std::filesystem::file_size(folder_ / "run.h5") - 32);  // without its seal
    ASSERT_EQ(run({"report", "cut.h5"}).status, 0);
    EXPECT_THAT(read("cut.html"), HasSubstr("has no seal"));
}

TEST_F(ReportCommand, OfAMachineThatIsGoneReportsWhyThePageShowsNoChain) {
    change_record((folder_ / "run.h5").string(), [](hid_t file) { put_text(file, "/", "parameters", "[detail]\npins = \"whole\"\n"); });
    const Outcome outcome = run({"report", "run.h5"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_THAT(outcome.err,
                HasSubstr("run.h5: the page shows no chain: cannot read the parameters of its machine: scene:2:8: detail.pins: "
                          "\"whole\" is not one of halves, rigid"));
}

TEST_F(ReportCommand, ContainsEnergiesByKindAndTheWearThatWasRecorded) {
    ASSERT_EQ(run({"report", "run.h5"}).status, 0);
    EXPECT_THAT(read("run.html"), testing::AllOf(HasSubstr("<td>dissipated/tip_friction</td>"), Not(HasSubstr("id=\"wear\""))));
    for (const auto& [channels, shown] : std::map<std::string, bool>{{"wear/*", true}, {"wear/friction_power", false}}) {
        const Outcome outcome =
            run_briefly({"-o", "worn.h5", "--force", "--set", "run.output_interval=1 us", "--set", "record.channels=" + channels});
        ASSERT_EQ(outcome.status, 0) << outcome.err;
        ASSERT_EQ(run({"report", "worn.h5"}).status, 0);
        EXPECT_EQ(read("worn.html").find("Friction energy of the tips by radius") != std::string::npos, shown) << channels;
    }
}

TEST_F(ReportCommand, ShowsSeveralRecordsBesideEachOther) {
    std::filesystem::copy_file(folder_ / "run.h5", folder_ / "other.h5");
    ASSERT_EQ(run({"report", "run.h5", "other.h5", "-o", "both.html"}).status, 0);
    EXPECT_THAT(read("both.html"), testing::AllOf(HasSubstr("<h3>run.h5</h3>"), HasSubstr("<h3>other.h5</h3>")));
}

TEST_F(ReportCommand, OfTwoRecordsShowsTheirDifferences) {
    ASSERT_EQ(run_briefly({"-o", "other.h5", "--set", "run.output_interval=1 us", "--set", "load.torque=8 N*m"}).status, 0);
    ASSERT_EQ(run({"report", "run.h5", "other.h5", "-o", "both.html"}).status, 0);
    const std::string page = read("both.html");
    EXPECT_THAT(page, HasSubstr("<tr data-key=\"load.torque\"><td><code>load.torque</code></td><td>7 N*m</td><td>8 N*m</td>"));
    EXPECT_THAT(page, Not(HasSubstr("<tr data-key=\"chain.pitch\">")));
    EXPECT_THAT(page, testing::AllOf(HasSubstr("<tr data-difference=\"slip\">"), HasSubstr("slip: B - A")));
    EXPECT_THAT(page, HasSubstr("<title>cvtflow: tiny: load.torque 7 N*m, load.torque 8 N*m</title>"));
    EXPECT_LT(page.find("\">Differences</h2>"), page.find("\">Key figures</h2>"));
    const std::string simulated = page.substr(page.find("id=\"simulated\""), page.find("id=\"curves\"") - page.find("id=\"simulated\""));
    EXPECT_EQ(simulated.find("24 pins around"), simulated.rfind("24 pins around")) << "what records share is stated once";
    EXPECT_THAT(simulated, testing::AllOf(HasSubstr("24 pins around"), HasSubstr("run.h5"), HasSubstr("other.h5")));
    EXPECT_THAT(page, HasSubstr("common to all records"));
    EXPECT_THAT(page, Not(HasSubstr("<td><code>load.torque</code></td><td>7 N*m</td><td>150 N*m</td>")));
    ASSERT_EQ(run({"report", "run.h5", "-o", "one.html"}).status, 0);
    EXPECT_THAT(read("one.html"), Not(HasSubstr("id=\"differences\"")));
    std::filesystem::copy_file(folder_ / "run.h5", folder_ / "copy.h5");
    ASSERT_EQ(run({"report", "run.h5", "copy.h5", "-o", "same.html"}).status, 0);
    EXPECT_THAT(read("same.html"),
                testing::AllOf(HasSubstr("Every key of both scenes has the same value"), HasSubstr("The same in every common row: ")));
}

TEST_F(ReportCommand, CountsTwoLevelsOfDetailAsOneDifference) {
    for (const char* level : {"medium", "fine"}) ASSERT_EQ(run_briefly({"-o", std::string(level) + ".h5", "--detail", level}).status, 0);
    ASSERT_EQ(run({"report", "medium.h5", "fine.h5", "-o", "both.html"}).status, 0);
    EXPECT_THAT(read("both.html"),
                testing::AllOf(HasSubstr("<title>cvtflow: tiny: detail.level medium, detail.level fine</title>"),
                               HasSubstr("<tr data-key=\"detail.level\">"), Not(HasSubstr("<tr data-key=\"detail.order\">"))));
}

TEST_F(ReportCommand, TextsOfASceneCannotBecomePartsOfThePage) {
    const Outcome outcome = run_briefly({"-o", "evil.h5", "--set", "scene.description=</script><b>&"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    ASSERT_EQ(run({"report", "evil.h5"}).status, 0);
    EXPECT_THAT(read("evil.html"), testing::AllOf(HasSubstr("&lt;/script&gt;&lt;b&gt;&amp;"), Not(HasSubstr("</script><b>"))));
}

TEST_F(ReportCommand, ShowsEveryCaseOfASweep) {
    write("cases.csv", "case,status,load_torque,slip_mean\n0,ok,10,0.1\n1,deep_tip,20,nan\n");
    ASSERT_EQ(run({"report", "cases.csv"}).status, 0);
    const std::string page = read("cases.html");
    EXPECT_THAT(page, testing::AllOf(HasSubstr("<b>ok</b>: 1 of 2 cases"), HasSubstr("<b>deep_tip</b>: 1 of 2 cases"),
                                     HasSubstr("id=\"cases-table\"")));
    EXPECT_THAT(page, testing::AllOf(HasSubstr("slip_mean [%]</th>"),
                                     HasSubstr("data-value=\"10\">10</td><td class=\"number\" data-value=\"10\">")))
        << "a slip of 0.1 is 10 %, a torque of 10 is 10";
}

TEST_F(ReportCommand, ShowsSlipAndEfficiencyInPerCentAsPlotsDo) {
    ASSERT_EQ(run({"report", "run.h5", "-o", "page.html"}).status, 0);
    const std::string page = read("page.html");
    for (const char* channel : {"slip", "friction_slip", "loss_slip", "efficiency"})
        EXPECT_TRUE(std::regex_search(page, std::regex(std::string("<tr data-channel=\"") + channel + "\">.*</td><td>%</td>"))) << channel;
    EXPECT_TRUE(std::regex_search(page, std::regex("<tr data-channel=\"ratio\">.*</td><td></td>"))) << "a ratio is no share";
}

TEST_F(ReportCommand, DrawsMapsOfCasesThatFormAGrid) {
    const std::string heading = "case,status,start_ratio,load_torque,slip_mean\n",
                      grid = "0,ok,1,10,0.1\n1,ok,1,20,0.2\n2,ok,2,10,0.3\n3,ok,2,20,0.4\n";
    write("grid.csv", heading + grid);
    write("twice.csv", heading + grid + "4,ok,2,20,0.5\n");
    ASSERT_EQ(run({"report", "grid.csv"}).status, 0);
    ASSERT_EQ(run({"report", "twice.csv"}).status, 0);
    EXPECT_THAT(read("grid.html"), HasSubstr("mean slip over load torque and start ratio"));
    EXPECT_THAT(read("twice.html"), Not(HasSubstr("mean slip over load torque and start ratio")));
}

TEST_F(ReportCommand, OfTheShippedSweepHasMaps) {
    ASSERT_EQ(run({"report", CVTFLOW_SOURCE_DIR "/scenes/sweeps/slip_efficiency_results.csv", "-o", "page.html"}).status, 0);
    EXPECT_THAT(read("page.html"), testing::AllOf(HasSubstr("id=\"maps\""), HasSubstr("mean slip over load torque and clamping driven")));
}

TEST_F(ReportCommand, ReportsWhatIsWrong) {
    write("cases.csv", "case,status\n0,ok\n");
    write("other.csv", "a,b\n1,2\n");
    EXPECT_THAT(run({"report", "none.h5"}).err, HasSubstr("none.h5: No such file or directory"));
    EXPECT_EQ(run({"report", "none.h5"}).status, 1);
    EXPECT_EQ(run({"report", "cases.csv", "cases.csv"}).status, 2);
    EXPECT_THAT(run({"report", "other.csv"}).err, HasSubstr("not a sweep's table"));
    EXPECT_EQ(run({"report", "run.h5", "-o", "run.h5"}).status, 1);
    EXPECT_EQ(run({"report", "run.h5", "-o", "none/page.html"}).status, 1);
}

TEST_F(ReportCommand, CountsNotesOfCases) {
    write("cases.csv", "case,status,load_torque,slip_mean,notes\n0,ok,6,0.1,unsteady\n1,ok,12,0.2,unsteady gross_slip\n");
    ASSERT_EQ(run({"report", "cases.csv", "-o", "page.html"}).status, 0);
    EXPECT_THAT(read("page.html"),
                AllOf(HasSubstr("<b>note unsteady</b>: 2 of 2 cases"), HasSubstr("<b>note gross_slip</b>: 1 of 2 cases")));
}

/// A run of more than 60 pin periods, until it is steady: curves are means over pin periods, and so are the numbers beside measured data.
TEST_F(ReportCommand, ComparesAndStatesMeansOfALongRun) {
    ASSERT_EQ(run({"run", "control", "--detail", "rigid", "--settle", "--until", "steady", "-o", "long.h5", "-q"}).status, 0);
    ASSERT_EQ(run({"plot", "long.h5", "slip", "-o", "slip.csv"}).status, 0);
    std::istringstream lines(read("slip.csv"));
    std::vector<std::string> points;  // "time,slip"
    for (std::string line; std::getline(lines, line);)
        if (const std::string curve = "\"slip\",\"slip\","; line.starts_with(curve))
            points.push_back(line.substr(curve.size(), line.find(",\"", curve.size()) - curve.size()));
    ASSERT_GE(points.size(), 60u);
    write("bench.csv", "time [ms],slip [%]\n" + points[30] + "\n");
    ASSERT_EQ(run({"report", "long.h5", "--with", "bench.csv", "-o", "page.html"}).status, 0);
    const std::string page = read("page.html");
    std::smatch row;
    const std::regex expected("<td>long.h5</td><td>slip</td><td>%</td><td[^>]*>1</td><td[^>]*data-value=\"([^\"]*)\"");
    ASSERT_TRUE(std::regex_search(page, row, expected));
    EXPECT_NEAR(std::stod(row[1]), 0.0, 1e-5) << "outputs swing by some tenths of a per cent about their means";
    EXPECT_THAT(page, HasSubstr("mean of the last half, which is steady"));
}

/// Deviations are those between the curve that plot draws and the measured numbers; points beyond the record do not count.
TEST_F(ReportCommand, ShowsMeasuredDataAndItsDeviations) {
    write("bench.csv", "time [us],slip [%]\n0,1.5\n20,1.6\n50,9\n");
    ASSERT_EQ(run({"report", "run.h5", "--with", "bench.csv", "-o", "page.html"}).status, 0);
    ASSERT_EQ(run({"plot", "run.h5", "slip", "-o", "slip.csv"}).status, 0);
    std::istringstream lines(read("slip.csv"));
    std::vector<double> slip;
    for (std::string line; std::getline(lines, line);)
        if (const std::string curve = "\"slip\",\"slip\","; line.starts_with(curve))
            slip.push_back(std::stod(line.substr(line.find(',', curve.size()) + 1)));
    ASSERT_GE(slip.size(), 2u);
    const std::string page = read("page.html");
    std::smatch row;
    const std::regex expected("<td>run.h5</td><td>slip</td><td>%</td><td[^>]*>2</td><td[^>]*data-value=\"([^\"]*)\"");
    ASSERT_TRUE(std::regex_search(page, row, expected));
    EXPECT_NEAR(std::stod(row[1]), 0.5 * (slip.front() - 1.5 + slip.back() - 1.6), 1e-5) << "six digits of the curve";
    EXPECT_THAT(page, HasSubstr("slip, bench.csv"));
    write("bench.csv", "time [us],oil [degC]\n0,80\n");
    const Outcome refused = run({"report", "run.h5", "--with", "bench.csv"});
    EXPECT_EQ(refused.status, 2);
    EXPECT_THAT(refused.err, HasSubstr("--with bench.csv: no heading is a channel of run.h5: time, oil"));
}

TEST_F(ReportCommand, ShowsMeasuredDataBesideASweep) {
    write("cases.csv", "case,status,load_torque,slip_mean\n0,ok,10,0.01\n1,ok,20,0.02\n");
    write("bench.csv", "load.torque [N*m],slip_mean [%]\n10,0.9\n20,2.1\n");
    ASSERT_EQ(run({"report", "cases.csv", "--with", "bench.csv", "-o", "page.html"}).status, 0);
    EXPECT_THAT(read("page.html"), testing::AllOf(HasSubstr("Measured data</h2>"), HasSubstr(">bench.csv</text>")));
    write("bench.csv", "slip_mean [%]\n0.9\n");
    EXPECT_EQ(run({"report", "cases.csv", "--with", "bench.csv", "-o", "page.html"}).status, 2);
}

std::string sum_of(const std::string& text) {
    std::string hex;
    for (const std::byte byte : sha256(std::as_bytes(std::span<const char>(text)))) {
        for (const unsigned shift : {4U, 0U}) hex += "0123456789abcdef"[std::to_integer<unsigned>(byte) >> shift & 15U];
    }
    return hex;
}

/// Examples of FIPS 180-4, and lengths about the border of a block, by sha256sum.
TEST(Sha256, IsThatOfTheStandard) {
    EXPECT_EQ(sum_of(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    EXPECT_EQ(sum_of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    EXPECT_EQ(sum_of("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
              "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    EXPECT_EQ(sum_of(std::string(55, 'a')), "9f4390f8d30c2dd92ec9f095b65e2b9ae9b0a925a5258e241c9f1e910f734318");
    EXPECT_EQ(sum_of(std::string(56, 'a')), "b35439a4ac6f0948b6d6f9e3c6af0f5f590ce20f1bde7090ef7970686ec6738a");
    EXPECT_EQ(sum_of(std::string(64, 'a')), "ffe054fe7ae0cb6dc65c3af9b61d5209f439851db43d0ba5997337df154668eb");
}

}  // namespace
}  // namespace cvtflow::tools
