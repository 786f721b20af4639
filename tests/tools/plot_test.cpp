#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <numeric>
#include <sstream>
#include <tuple>

#include "engine/record/run/run_reader.hpp"
#include "tests/tools/program_fixture.hpp"

namespace cvtflow::tools {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

/// The points of a series of a CSV. @param plot its title; empty: that of the series
std::vector<std::pair<double, double>> points_of(const std::string& csv, const std::string& series, const std::string& plot = "") {
    std::vector<std::pair<double, double>> points;
    std::istringstream lines(csv);
    for (std::string line; std::getline(lines, line);) {
        const std::string begin = "\"" + (plot.empty() ? series : plot) + "\",\"" + series + "\",";
        if (!line.starts_with(begin)) continue;
        std::istringstream numbers(line.substr(begin.size()));
        double x = 0.0, y = 0.0;
        char comma = 0;
        numbers >> x >> comma >> y;
        points.emplace_back(x, y);
    }
    return points;
}

class PlotCommand : public Program {
protected:
    void SetUp() override {
        made_once("a record for plots", [this] {
            const Outcome outcome = run_briefly({"-o", "run.h5", "--set", "run.output_interval=1 us", "--until", "40 us"});
            ASSERT_EQ(outcome.status, 0) << outcome.err;
        });
    }
    static constexpr const char* table =
        "case,status,load_torque,start_ratio,slip_mean\n"
        "0,ok,10,1,0.1\n1,ok,20,1,0.2\n2,ok,10,2,0.3\n3,ok,20,2,0.4\n4,deep_tip,30,2,9\n";
};

TEST_F(PlotCommand, DrawsEveryKindOfPictureOfARecord) {
    for (const std::vector<std::string>& kind : std::vector<std::vector<std::string>>{
             {}, {"links/tension"}, {"shaft_1", "slip"}, {"links/tension[3]"}, {"tight_tension", "--orders"}, {"--round"}, {"--losses"}}) {
        const Outcome outcome = run(std::vector<std::string>{"plot", "run.h5"} + kind + std::vector<std::string>{"-o", "p.svg"});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_EQ(outcome.out, "p.svg\n");
        EXPECT_THAT(read("p.svg"), StartsWith("<svg"));
    }
}

TEST_F(PlotCommand, TheCsvHasTheNumbersOfTheRecord) {
    ASSERT_EQ(run({"plot", "run.h5", "ratio", "-o", "p.csv"}).status, 0);
    const engine::RunReader record((folder_ / "run.h5").string());
    const std::vector<double> ratio = record.channel("ratio"), times = record.times();
    std::istringstream lines(read("p.csv"));
    std::string line;
    std::getline(lines, line);
    EXPECT_EQ(line, "plot,series,x,y,x axis,y axis");
    for (std::size_t row = 0; row < ratio.size(); ++row) {
        ASSERT_TRUE(std::getline(lines, line));
        std::istringstream numbers(line.substr(line.find(',', line.find(',') + 1) + 1));
        double x = 0.0, y = 0.0;
        char comma = 0;
        numbers >> x >> comma >> y;
        EXPECT_NEAR(x, 1e3 * times[row], 1e-9);
        EXPECT_NEAR(y, ratio[row], 1e-8 * ratio[row]);  // nine digits
    }
    EXPECT_FALSE(std::getline(lines, line));
}

TEST_F(PlotCommand, ShowsUnitsOfEngineersOrSi) {
    const engine::RunReader record((folder_ / "run.h5").string());
    const double speed = record.channel("shaft_1/speed").front(), tension = record.channel("tight_tension").front();
    ASSERT_EQ(run({"plot", "run.h5", "shaft_1/speed", "tight_tension", "-o", "p.csv"}).status, 0);
    const std::string shown = read("p.csv");
    EXPECT_NEAR(points_of(shown, "shaft_1/speed").front().second, speed * 30.0 / std::numbers::pi, 1e-5);
    EXPECT_NEAR(points_of(shown, "tight_tension").front().second, 1e-3 * tension, 1e-8);
    EXPECT_THAT(shown, testing::AllOf(HasSubstr("speed [rpm]"), HasSubstr("tight tension [kN]")));
    ASSERT_EQ(run({"plot", "run.h5", "tips/axial_force[0]", "-o", "tip.csv"}).status, 0);
    EXPECT_THAT(read("tip.csv"), HasSubstr("tips/axial force[0] [kN]"));
    ASSERT_EQ(run({"plot", "run.h5", "shaft_1/speed", "tight_tension", "slip", "--si", "-o", "si.csv"}).status, 0);
    const std::string si = read("si.csv");
    EXPECT_NEAR(points_of(si, "shaft_1/speed").front().second, speed, 1e-6);
    EXPECT_NEAR(points_of(si, "tight_tension").front().second, tension, 1e-5);
    EXPECT_NEAR(points_of(si, "tight_tension").back().first, 40e-6, 1e-12) << "seconds";
    EXPECT_THAT(si, testing::AllOf(HasSubstr("speed [rad/s]"), HasSubstr("tight tension [N]"), HasSubstr(",\"time [s]\",\"slip\"\n")));
}

TEST_F(PlotCommand, OrdersOfTheBaselinePeakWherePinsPassAndAtTwiceThat) {
    const std::vector<std::string> brief{"--method", "leapfrog-chebyshev", "--step", "auto", "--until", "40 ms"};
    ASSERT_EQ(run(std::vector<std::string>{"run", "baseline", "-o", "baseline.h5", "-q"} + brief).status, 0);
    ASSERT_EQ(run({"plot", "baseline.h5", "tight_tension", "--orders", "-o", "p.csv"}).status, 0);
    const std::string text = read("p.csv");
    EXPECT_THAT(text, testing::AllOf(HasSubstr("pins pass: 14"), HasSubstr("order of the passing pins")));
    const double pins = 2000.0 / 60.0 * 2.0 * std::numbers::pi * 54.44e-3 / 8.12e-3;  // speed times radius over pitch: 1404 Hz
    for (const double expected : {1.0, 2.0}) {
        double largest = 0.0, at = 0.0;
        for (const auto& [order, amplitude] : points_of(text, "tight_tension")) {
            if (std::abs(order - expected) > 0.3 || amplitude < largest) continue;
            largest = amplitude, at = order;
        }
        EXPECT_NEAR(at, expected, 25.0 / pins);  // a line of 40 ms
    }
}

/// Largest amplitude within an eighth of an order.
double peak_near(const std::vector<std::pair<double, double>>& spectrum, double expected) {
    double largest = 0.0;
    for (const auto& [order, amplitude] : spectrum) {
        if (std::abs(order - expected) < 0.125) largest = std::max(largest, amplitude);
    }
    return largest;
}

TEST_F(PlotCommand, OrdersOfMixedPitchesPeakWhereThePatternRepeats) {
    const std::vector<std::string> mixed{"--set",    "chain.pitch=[\"6.6 mm\", \"9.64 mm\"]",
                                         "--set",    "start.state=\"\"",
                                         "--set",    "start.settling_time=20 ms",
                                         "--method", "auto",
                                         "--step",   "auto",
                                         "--until",  "100 ms"};
    ASSERT_EQ(run(std::vector<std::string>{"run", "tiny", "-o", "mixed.h5", "-q"} + mixed).status, 0);
    ASSERT_EQ(run({"plot", "mixed.h5", "tight_tension", "--orders", "-o", "p.csv"}).status, 0);
    const std::string text = read("p.csv");
    const auto named = [&](const std::string& begin) {
        const auto at = text.find("\"" + begin);
        return at == std::string::npos ? std::string() : text.substr(at + 1, text.find('"', at + 1) - at - 1);
    };
    const auto pattern = points_of(text, named("pitch pattern"), "tight_tension");
    ASSERT_GT(pattern.size(), 3U);
    EXPECT_NEAR(pattern.front().first, 0.5, 1e-9) << "two links";
    EXPECT_EQ(points_of(text, named("shaft 1"), "tight_tension").size(), 2U) << "one line";
    const auto spectrum = points_of(text, "tight_tension");
    // Marks are where the vibrations are: beside them, at quarters, hardly any (measured: a tenth).
    for (const double order : {0.5, 1.5, 2.5}) EXPECT_GT(peak_near(spectrum, order), 4.0 * peak_near(spectrum, order - 0.25)) << order;
}

TEST_F(PlotCommand, ALongRunIsDrawnAsMeansOverPinPeriods) {
    ASSERT_EQ(run({"run", "control", "-o", "long.h5", "-q", "--until", "50 ms"}).status, 0);
    ASSERT_EQ(run({"plot", "long.h5", "slip", "-o", "means.csv"}).status, 0);
    ASSERT_EQ(run({"plot", "long.h5", "slip", "-o", "all.csv", "--every-output"}).status, 0);
    const auto means = points_of(read("means.csv"), "slip"), all = points_of(read("all.csv"), "slip");
    EXPECT_EQ(all.size(), 2501U);
    ASSERT_GT(means.size(), 60U);
    EXPECT_LT(means.size(), 80U) << "50 ms of 0.71 ms";
    EXPECT_NEAR(means[1].first - means[0].first, 1e3 * 8.12e-3 / (2000.0 / 60.0 * 2.0 * std::numbers::pi * 54.44e-3), 0.01);
    ASSERT_EQ(run({"plot", "long.h5", "loss", "-o", "losses.csv"}).status, 0);
    std::istringstream lines(read("losses.csv"));
    long joints = 0;
    for (std::string line; std::getline(lines, line);) joints += line.find("\"loss/joint_friction\"") != std::string::npos ? 1 : 0;
    EXPECT_EQ(joints, static_cast<long>(means.size())) << "losses as well";
    for (const auto& [time, slip] : means) EXPECT_TRUE(slip > 0.1 && slip < 0.6) << time << ": " << slip << " %";
}

/// The mean of a swing hides it: the strand moves by more than its means do.
TEST_F(PlotCommand, LengthsOfALongRunAreDrawnAtEveryOutput) {
    ASSERT_EQ(run({"run", "control", "--detail", "rigid", "-o", "long.h5", "-q", "--until", "50 ms", "--set", "guide.stiffness=1 N/m",
                   "--set", "start.settling_time=5 ms"})
                  .status,
              0);
    ASSERT_EQ(run({"plot", "long.h5", "guide/slack_deflection", "slip", "-o", "p.csv"}).status, 0);
    const std::string csv = read("p.csv");
    const auto drawn = points_of(csv, "guide/slack_deflection");
    const std::vector<double> recorded = engine::RunReader((folder_ / "long.h5").string()).channel("guide/slack_deflection");
    const auto [least, largest] = std::ranges::minmax_element(drawn, {}, &std::pair<double, double>::second);
    const auto [lowest, highest] = std::ranges::minmax_element(recorded);
    EXPECT_NEAR(largest->second, 1e3 * *highest, 1e-7 * std::abs(1e3 * *highest)) << "nine digits";
    EXPECT_NEAR(least->second, 1e3 * *lowest, 1e-7 * std::abs(1e3 * *lowest));
    EXPECT_LT(points_of(csv, "slip").size(), 80U) << "means over pin periods";
}

/// Row by row, the one channel over the other one.
TEST_F(PlotCommand, DrawsAChannelOverAnother) {
    ASSERT_EQ(run({"plot", "run.h5", "--x", "ratio", "slip", "-o", "p.csv"}).status, 0);
    const auto drawn = points_of(read("p.csv"), "slip");
    const engine::RunReader record((folder_ / "run.h5").string());
    const std::vector<double> ratio = record.channel("ratio"), slip = record.channel("slip");
    ASSERT_EQ(drawn.size(), ratio.size());
    for (std::size_t k = 0; k < drawn.size(); ++k) {
        EXPECT_NEAR(drawn[k].first, ratio[k], 1e-8 * ratio[k]);  // CSV has nine digits
        EXPECT_NEAR(drawn[k].second, 100.0 * slip[k], 1e-8 * std::abs(100.0 * slip[k]));
    }
    ASSERT_EQ(run({"plot", "run.h5", "--x", "ratio", "slip", "-o", "p.svg", "--force"}).status, 0);
    EXPECT_THAT(read("p.svg"), HasSubstr(">ratio</text>"));
    write("bench.csv", "ratio,slip [%]\n1.01,1.5\n");
    ASSERT_EQ(run({"plot", "run.h5", "--x", "ratio", "slip", "--with", "bench.csv", "-o", "q.csv"}).status, 0);
    EXPECT_EQ(points_of(read("q.csv"), "slip, bench.csv", "slip"), (std::vector<std::pair<double, double>>{{1.01, 1.5}}));
    EXPECT_THAT(run({"plot", "run.h5", "--x", "shaft_1", "slip"}).err, HasSubstr("--x shaft_1: "));
    EXPECT_THAT(run({"plot", "run.h5", "--x", "slip", "--losses"}).err, HasSubstr("--with and --x are for curves of channels"));
}

TEST_F(PlotCommand, SeveralRecordsStandInOnePicture) {
    std::filesystem::copy_file(folder_ / "run.h5", folder_ / "other.h5");
    ASSERT_EQ(run({"plot", "run.h5", "other.h5", "slip", "-o", "p.svg"}).status, 0);
    EXPECT_THAT(read("p.svg"),
                testing::AllOf(HasSubstr("slip, run.h5<"), HasSubstr("slip, other.h5<"), HasSubstr("tiny, own detail, rk4")));
    ASSERT_EQ(run_briefly({"-o", "heavy.h5", "--set", "run.output_interval=1 us", "--until", "40 us", "--set", "load.torque=7"}).status, 0);
    ASSERT_EQ(run({"plot", "run.h5", "heavy.h5", "slip", "-o", "p.svg"}).status, 0);
    EXPECT_THAT(read("p.svg"), HasSubstr(">slip, heavy.h5 (load.torque 7 N*m)<")) << "the one key that differs";
}

TEST_F(PlotCommand, DrawsSweepsAsCurvesAndAsMaps) {
    write("cases.csv", table);
    const std::vector<std::string> axes{"plot", "cases.csv", "-o", "p.svg", "--x", "load.torque", "--y"};
    ASSERT_EQ(run(axes + std::vector<std::string>{"slip_mean"}).status, 0);
    EXPECT_THAT(read("p.svg"), testing::AllOf(HasSubstr(">start ratio 2<"), HasSubstr("4 of 5 cases"), HasSubstr(">mean slip [%]<"),
                                              HasSubstr(">load torque [N·m]<")));
    const std::string by_column = read("p.svg");
    ASSERT_EQ(run(axes + std::vector<std::string>{"slip mean"}).status, 0);
    EXPECT_EQ(read("p.svg"), by_column) << "as in the sweep's file";
    ASSERT_EQ(run(axes + std::vector<std::string>{"start.ratio", "--colour", "slip_mean"}).status, 0);
    EXPECT_THAT(read("p.svg"), testing::AllOf(HasSubstr(">mean slip over load torque and start ratio<"), HasSubstr(">failed (1)<")));
}

TEST_F(PlotCommand, TakesConditionsWithUnits) {
    const std::string sweep = CVTFLOW_SOURCE_DIR "/scenes/sweeps/slip_efficiency_results.csv";
    const auto drawn = [&](const std::string& where) {
        const Outcome made = run({"plot", sweep, "--x", "load_torque", "--y", "efficiency", "--where", where, "-o", "p.csv", "--force"});
        EXPECT_EQ(made.status, 0) << made.err;
        return read("p.csv");
    };
    EXPECT_EQ(drawn("clamping.driven=20 kN"), drawn("clamping.driven=20000"));
    EXPECT_EQ(run({"plot", sweep, "--x", "load_torque", "--y", "efficiency", "--where", "clamping.driven=21 kN"}).status, 2);
}

TEST_F(PlotCommand, DrawsMeasuredDataAsPoints) {
    write("bench.csv", "time [us],slip [%],shaft_1_speed [rpm],oil [degC]\n0,1.5,2000,80\n20,1.6,,80\n");
    ASSERT_EQ(run({"plot", "run.h5", "slip", "shaft_1/speed", "--with", "bench.csv", "-o", "p.csv"}).status, 0);
    const auto slip = points_of(read("p.csv"), "slip, bench.csv", "slip");
    ASSERT_EQ(slip.size(), 2U);
    EXPECT_NEAR(slip[1].first, 0.02, 1e-12) << "milliseconds, as the axis";
    EXPECT_NEAR(slip[1].second, 1.6, 1e-12);
    EXPECT_EQ(points_of(read("p.csv"), "shaft_1/speed, bench.csv", "shaft_1/speed").size(), 1U) << "an empty cell is no point";
    const Words plot{"plot", "run.h5", "-o", "q.svg", "--with", "bench.csv"};
    EXPECT_THAT(
        run(plot + Words{"ratio"}).err,
        HasSubstr("--with bench.csv: its columns (time, slip, shaft_1_speed, oil) are none of the channels that are drawn (ratio)"));
    EXPECT_EQ(run(plot + Words{"--losses"}).status, 2);
    write("bench.csv", "time [us],slip [N]\n0,1.5\n");
    EXPECT_THAT(run(plot + Words{"slip"}).err, HasSubstr("bench.csv: slip [N]: a plain number expected (1)"));
    write("bench.csv", "time [us],slip [hogshead]\n0,1.5\n");
    EXPECT_THAT(run(plot + Words{"slip"}).err, HasSubstr("bench.csv: slip [hogshead]: "));
    write("bench.csv", "slip [%]\n1.5\n");
    EXPECT_THAT(run(plot + Words{"slip"}).err, HasSubstr("--with bench.csv: no column 'time', only slip"));
    EXPECT_EQ(run({"plot", "run.h5", "slip", "--with", "none.csv"}).status, 1);
}

TEST_F(PlotCommand, DrawsMeasuredDataBesideASweep) {
    write("cases.csv", table);
    write("bench.csv", "load.torque [N*m];slip_mean [%]\n10;9,5\n20;21\n");
    const Words plot{"plot", "cases.csv", "--x", "load.torque", "--with", "bench.csv"};
    ASSERT_EQ(run(plot + Words{"--y", "slip_mean", "-o", "p.csv"}).status, 0);
    const std::vector<std::pair<double, double>> expected{{10.0, 9.5}, {20.0, 21.0}};
    EXPECT_EQ(points_of(read("p.csv"), "bench.csv", "mean slip over load torque"), expected);
    EXPECT_EQ(run(plot + Words{"--y", "start.ratio"}).status, 2) << "it has no such column";
    EXPECT_EQ(run(plot + Words{"--y", "start.ratio", "--colour", "slip_mean"}).status, 2);
}

/// Bars are means of the record, and kinds that are zero are only named: the cylinders do not damp.
TEST_F(PlotCommand, LossesAreBars) {
    const Words settings{"--set", "pulley.cylinder_damping=0", "--set", "run.output_interval=1 us", "--until", "20 us"};
    ASSERT_EQ(run_briefly(Words{"-o", "free.h5"} + settings).status, 0);
    ASSERT_EQ(run({"plot", "free.h5", "--losses", "-o", "p.svg"}).status, 0);
    ASSERT_EQ(run({"plot", "free.h5", "--losses", "-o", "p.csv"}).status, 0);
    const engine::RunReader record((folder_ / "free.h5").string());
    const auto mean = [&](const char* channel) {
        const std::vector<double> values = record.channel(channel);
        return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
    };
    ASSERT_EQ(mean("loss/cylinder"), 0.0);
    const std::string text = read("p.svg");
    EXPECT_THAT(text, testing::AllOf(HasSubstr(">tip friction<"), testing::Not(HasSubstr(">cylinder<")), HasSubstr("; zero: cylinder<"),
                                     HasSubstr("Losses by kind: ")));
    const std::string csv = read("p.csv"), row = "\"tip friction\",";
    const auto at = csv.find(row);
    ASSERT_NE(at, std::string::npos);
    EXPECT_NEAR(std::stod(csv.substr(csv.find(',', at + row.size()) + 1)), mean("loss/tip_friction"), 1e-7 * mean("loss/tip_friction"));
}

TEST_F(PlotCommand, CurvesThatAreZeroAreNamedInTheSubtitleAlone) {
    ASSERT_EQ(run({"plot", "run.h5", "slip", "control/limited", "-o", "p.svg"}).status, 0);
    EXPECT_THAT(read("p.svg"), testing::AllOf(HasSubstr("; zero: control/limited<"), testing::Not(HasSubstr(">control/limited<"))));
    ASSERT_EQ(run({"plot", "run.h5", "control/limited", "-o", "one.svg"}).status, 0) << "there is no other";
    EXPECT_THAT(read("one.svg"), HasSubstr(">control/limited<"));
}

TEST_F(PlotCommand, CurvesOfAGroupThatLieOnTheAxisAreNamedInTheSubtitleAlone) {
    const auto legend = [&](const Words& words) {
        EXPECT_EQ(run(Words{"plot", "run.h5"} + words + Words{"-o", "p.svg", "--force"}).status, 0);
        return read("p.svg");
    };
    const std::string group = legend({"loss"}), named = legend({"loss/inner", "loss/joint_damping"});
    EXPECT_THAT(group, testing::AllOf(HasSubstr(">loss: "), HasSubstr("; below 1 %: "), HasSubstr(">loss/inner<"),
                                      testing::Not(HasSubstr(">loss/joint_damping<"))));
    EXPECT_THAT(named, HasSubstr(">loss/joint_damping<")) << "it was asked for";
}

/// Means of 1 ms beside those of outputs every 10 us of the same steps, by the trapezoidal rule; sums are those of the instant.
TEST_F(PlotCommand, OutputsAreMeansOverTheirIntervalWhereTheSceneAsksForThem) {
    const Words scene{"run", "baseline", "-q", "--detail", "rigid", "--until", "4 ms", "--set", "run.state_interval=1 ms"};
    ASSERT_EQ(run(scene + Words{"-o", "means.h5", "--set", "run.output_interval=1 ms", "--set", "record.means=true"}).status, 0);
    ASSERT_EQ(run(scene + Words{"-o", "dense.h5", "--set", "run.output_interval=10 us"}).status, 0);
    const engine::RunReader means((folder_ / "means.h5").string()), dense((folder_ / "dense.h5").string());
    ASSERT_EQ(means.rows(), 5U);
    const std::size_t stride = (dense.rows() - 1) / (means.rows() - 1);
    for (const char* channel : {"tight_tension", "slip", "loss/tip_friction", "shaft_2/torque", "chain_speed"}) {
        const std::vector<double> row = means.channel(channel), value = dense.channel(channel);
        for (std::size_t k = 1; k < row.size(); ++k) {
            double sum = 0.5 * (value[(k - 1) * stride] + value[k * stride]), spread = 0.0;
            for (std::size_t j = (k - 1) * stride + 1; j < k * stride; ++j) sum += value[j];
            for (std::size_t j = (k - 1) * stride; j < k * stride; ++j) spread = std::max(spread, std::abs(value[j] - value[k * stride]));
            EXPECT_NEAR(row[k], sum / static_cast<double>(stride), 0.05 * spread + 1e-12 * std::abs(row[k])) << channel << ' ' << k;
        }
        EXPECT_NEAR(row[0], value[0], 1e-4 * std::abs(value[0])) << "of the instant: nothing was before";
    }
    EXPECT_NEAR(means.channel("dissipated/total").back(), dense.channel("dissipated/total").back(),
                1e-3 * dense.channel("dissipated/total").back());
    ASSERT_EQ(run({"plot", "means.h5", "slip", "-o", "p.svg"}).status, 0);
    EXPECT_THAT(read("p.svg"), HasSubstr("; outputs are means over their interval<"));
}

TEST_F(PlotCommand, TheTargetOfARatioIsDrawnInItsPanel) {
    const Words control{"--set", "control.enabled=true",    "--set", "control.ratio=1.1", "--until", "40 us",
                        "--set", "run.output_interval=1 us"};
    ASSERT_EQ(run_briefly(Words{"-o", "held.h5"} + control).status, 0);
    for (const Words& words : {Words{"ratio"}, Words{"ratio", "control/target"}}) {
        ASSERT_EQ(run(Words{"plot", "held.h5"} + words + Words{"-o", "p.csv", "--force"}).status, 0);
        const auto target = points_of(read("p.csv"), "control/target", "ratio"), ratio = points_of(read("p.csv"), "ratio");
        ASSERT_EQ(target.size(), ratio.size());
        EXPECT_DOUBLE_EQ(target.back().second, 1.1);
        EXPECT_THAT(read("p.csv"), testing::Not(HasSubstr("\"control/target\",\"control/target\"")));
    }
    ASSERT_EQ(run({"plot", "run.h5", "ratio", "-o", "p.csv", "--force"}).status, 0);
    EXPECT_THAT(read("p.csv"), testing::Not(HasSubstr("control/target"))) << "nothing controls it";
}

TEST_F(PlotCommand, OfASweepStatesItsLevelAndWhereAMapIsLargest) {
    write("sweep.toml",
          "[sweep]\nscene = \"tiny\"\ndetail = \"fine\"\n[set]\nrun.until = \"20 us\"\nstart.state = \"\"\n"
          "start.settling_time = \"20 us\"\nstart.ramp_time = \"10 us\"\n[[axes]]\nkey = \"load.torque\"\nvalues = [\"6 N*m\", \"7 N*m\"]\n"
          "[[axes]]\nkey = \"drive.speed\"\nvalues = [\"900 rpm\", \"1000 rpm\"]\n[outputs]\nscalars = [\"slip mean\"]\n");
    const Outcome batch = run({"batch", "sweep.toml", "-q", "-o", "swept"});
    ASSERT_EQ(batch.status, 0) << batch.err;
    ASSERT_EQ(run({"plot", "swept", "--x", "load.torque", "--y", "drive.speed", "--colour", "slip mean", "-o", "p.svg"}).status, 0);
    EXPECT_THAT(read("p.svg"), HasSubstr(">sweep sweep, fine, 4 cases; ring: largest, "));
    ASSERT_EQ(run({"report", "swept", "-o", "page.html"}).status, 0);
    EXPECT_THAT(read("page.html"), testing::AllOf(HasSubstr("What was simulated"), HasSubstr("24 pins"), HasSubstr("common to all cases"),
                                                  testing::Not(HasSubstr("<td><code>load.torque</code></td>"))));
}

/// Pins of tiny pass every 2.5 ms.
TEST_F(PlotCommand, OutputsThatPinsOvertakeAreSamplesWithoutOrders) {
    const Words slow{"--until", "20 ms", "--step", "200 ns", "--set", "run.output_interval=2 ms", "--set", "run.state_interval=2 ms"};
    const Outcome outcome = run_briefly(Words{"-o", "slow.h5"} + slow);
    ASSERT_THAT(outcome.status, testing::AnyOf(0, 6)) << outcome.err;
    ASSERT_EQ(run({"plot", "slow.h5", "slip", "-o", "slow.svg"}).status, 0);
    EXPECT_THAT(read("slow.svg"), testing::ContainsRegex("outputs are 2 ms apart, and pins pass at [0-9.]+ Hz: curves are samples"));
    const Outcome orders = run({"plot", "slow.h5", "slip", "--orders"});
    EXPECT_EQ(orders.status, 2);
    EXPECT_THAT(orders.err, HasSubstr("spectra require run.output_interval below "));
}

TEST_F(PlotCommand, ReportsHowAChannelIsRecordedThatExists) {
    const Outcome outcome = run({"plot", "run.h5", "shaft_1/slip"});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_EQ(outcome.err,
              "cvtflow: shaft_1/slip: run.h5 was recorded without this channel (record it with --set record.channels=shaft_1/slip)\n");
}

TEST_F(PlotCommand, ReadsTablesWithSemicolonsAndDecimalCommas) {
    write("german.csv", "case;status;load_torque;slip_mean\n0;ok;10,5;0,001\n1;ok;20;0,002\n");
    ASSERT_EQ(run({"plot", "german.csv", "--x", "load.torque", "--y", "slip_mean", "-o", "p.csv"}).status, 0);
    EXPECT_THAT(read("p.csv"), HasSubstr(",10.5,0.1,"));
}

TEST_F(PlotCommand, ReportsWhatIsWrong) {
    write("cases.csv", table);
    write("twice.csv", "status,load_torque,start_ratio,tip_angle,slip_mean\nok,1,1,1,1\nok,1,1,2,2\n");
    const auto complains = [&](const std::vector<std::string>& words, int status, const std::string& text) {
        const Outcome outcome = run(std::vector<std::string>{"plot"} + words);
        EXPECT_EQ(outcome.status, status) << text;
        EXPECT_THAT(outcome.err, HasSubstr(text));
    };
    complains({"run.h5", "slp"}, 2, "slp: neither a file nor a channel of run.h5 (did you mean \"slip\"?)");
    complains({"run.h5", "links/tension[99]"}, 2, "elements, numbered from 0");
    complains({"none.h5"}, 1, "none.h5: No such file or directory");
    complains({"run.h5", "-o", "p.pdf"}, 2, "expected FILE.svg, FILE.png or FILE.csv");
    complains({"run.h5", "--y", "slip"}, 2, "are for sweeps");
    complains({"cases.csv", "--x", "load.torqe", "--y", "slip_mean"}, 2, "did you mean \"load_torque\"?");
    complains({"cases.csv", "--x", "load.torque", "--y", "status"}, 2, "not numbers");
    complains({"cases.csv", "--orders"}, 2, "is a sweep");
    complains({"cases.csv", "--x", "load.torque", "--y", "slip_mean", "--where", "start.ratio=7"}, 2,
              "no case of cases.csv is left; start_ratio is ");
    complains({"twice.csv", "--x", "load.torque", "--y", "start.ratio", "--colour", "slip_mean"}, 2, "among tip_angle");
    complains({"run.h5", "-o", "none/p.svg"}, 1, "none/p.svg: cannot create: the folder 'none' does not exist");
}

TEST_F(PlotCommand, WithoutPythonOrALibraryReportsWhatToInstall) {
    write("bare", "#!/bin/sh\nexec /usr/bin/python3 -S \"$@\"\n");  // without the packages of Debian
    std::filesystem::permissions(folder_ / "bare", std::filesystem::perms::owner_all);
    const std::string bare = (folder_ / "bare").string(), none = (folder_ / "none").string();
    for (const auto& [python, status, text] :
         {std::tuple{none, 1,
                     "pictures, pages and load cycles require Python, and " + none + " cannot be started: No such file or directory"},
          {bare, 1,
           "pictures, pages and load cycles require numpy, matplotlib, h5py for /usr/bin/python3 (Debian: apt-get install python3-numpy "},
          {"./bare", 2, "CVTFLOW_PYTHON=./bare: expected an absolute path"}}) {
        const Outcome outcome = run({"plot", "run.h5", "-o", "p.png"}, {"CVTFLOW_PYTHON=" + python});
        EXPECT_EQ(outcome.status, status);
        EXPECT_THAT(outcome.err, HasSubstr(text));
        EXPECT_FALSE(std::filesystem::exists(folder_ / "p.png"));
    }
}

/// Modules, settings and packages of the working folder, of PYTHONPATH, of a home without permission to write; another locale.
TEST_F(PlotCommand, TheEnvironmentOfAUserHasNoEffect) {
    ASSERT_EQ(run({"plot", "run.h5", "slip", "-o", "p.svg"}).status, 0);
    const std::string drawn = read("p.svg"), here = folder_.string();
    for (const char* file : {"matplotlib.py", "numpy.py", "json.py", "cvtflow.py", "sitecustomize.py", "matplotlibrc"})
        write(file, "raise SystemExit('of the working folder')\n");
    for (const std::vector<std::string>& settings : std::vector<std::vector<std::string>>{
             {"PYTHONPATH=" + here, "PYTHONHOME=" + here, "MATPLOTLIBRC=" + here, "MPLBACKEND=module://evil", "PATH=" + here},
             {"HOME=/proc/none", "LANG=de_DE.UTF-8", "LC_ALL=de_DE.UTF-8"},
             {"HOME=", "LC_ALL=C", "MPLCONFIGDIR=" + here}}) {
        const Outcome outcome = run({"plot", "run.h5", "slip", "-o", "p.svg"}, settings);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_EQ(outcome.err, "");
        EXPECT_EQ(read("p.svg"), drawn);
    }
}

TEST_F(PlotCommand, TakesPathsOfAnyBytes) {
    for (const std::string name : {"a b%s.h5", "line\nbreak.h5", "\xc3\xbcml\xc3\xa4ut.h5", "latin\xfc.h5", "<b>&$x$.h5"}) {
        std::filesystem::copy_file(folder_ / "run.h5", folder_ / name);
        const Outcome outcome = run({"plot", name, "run.h5", "slip", "-o", "p.svg", "--force"});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_THAT(read("p.svg"), StartsWith("<svg"));
    }
}

TEST_F(PlotCommand, OverwritesNothingThatItReads) {
    std::filesystem::copy_file(folder_ / "run.h5", folder_ / "run.svg");
    EXPECT_EQ(run({"plot", "run.svg", "-o", "run.svg", "--force"}).status, 1);
    EXPECT_EQ(run({"plot", "run.svg"}).out, "run.svg.svg\n");
    EXPECT_EQ(read("run.svg"), read("run.h5"));
}

}  // namespace
}  // namespace cvtflow::tools
