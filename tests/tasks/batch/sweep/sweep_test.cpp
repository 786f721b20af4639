#include "tasks/batch/sweep/sweep.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <set>

#include "tasks/batch/batch.hpp"
#include "tasks/batch/case_engine.hpp"
#include "tasks/batch/sweep/sweep_keys.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tests/tasks/tiny_fixture.hpp"
#include "tests/temporary_file_fixture.hpp"

namespace cvtflow::tasks {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class SweepFile : public testing::Test {
protected:
    void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
    [[nodiscard]] Sweep read(const std::string& text) const {
        write("s.toml", text);
        return read_sweep(folder_ / "s.toml", scene_file);
    }
    /// The error, without the folder.
    [[nodiscard]] std::string error(const std::string& text) const {
        std::string message = message_of([&] { return read(text); });
        const std::string prefix = (folder_ / "").string();
        for (std::size_t at; (at = message.find(prefix)) != std::string::npos;) message.erase(at, prefix.size());
        return message.empty() ? "none" : message;
    }
    [[nodiscard]] double value(const Sweep& sweep, long number, std::string_view key) const {
        Scene scene = sweep.scene;
        sweep.apply_case(number, scene);
        return std::stod(value_text(*find_parameter(key), scene));
    }

    const std::string head = "[sweep]\nscene = \"tiny\"\n[outputs]\nscalars = [\"slip mean\"]\n";
    const tests::TemporaryFolder folder_{"sweep"};
};

TEST_F(SweepFile, TakesALevelOfDetailByOneRuleInItsHeadItsSettingsAndItsAxes) {
    const std::string axis = "[[axes]]\nkey = \"load.torque\"\nvalues = [6]\n";
    const std::string outputs = "[outputs]\nscalars = [\"slip mean\"]\n";
    const model::Detail of_head = read("[sweep]\nscene = \"tiny\"\ndetail = \"fine\"\n" + outputs + axis).scene.parameters.detail;
    for (const char* set : {"[set.detail]\nlevel = \"fine\"\n", "[set]\ndetail.level = \"fine\"\n", "[set]\n\"detail.level\" = \"fine\"\n"})
        EXPECT_EQ(read("[sweep]\nscene = \"tiny\"\ndetail = \"full\"\n" + outputs + set + axis).scene.parameters.detail, of_head) << set;
    const Sweep levels = read(head + "[[axes]]\nkey = \"detail.level\"\nvalues = [\"full\", \"fine\"]\n");
    EXPECT_EQ(scene_of_case(levels, 1).parameters.detail, of_head);
    EXPECT_EQ(axis_text(*levels.axes[0].keys[0], levels.axes[0].at(1, 0)), "\"fine\"");
}

TEST_F(SweepFile, MultipliesItsAxesTheLastFastest) {
    const Sweep sweep = read(head +
                             "[[axes]]\nkey = \"load.torque\"\nvalues = [\"1 N*m\", 2]\n[[axes]]\nkey = \"clamping.driven\"\nfrom = \"1 "
                             "kN\"\nto = \"100 kN\"\ncount = 3\nscale = \"log\"\n");
    ASSERT_EQ(sweep.cases(), 6);
    EXPECT_EQ(value(sweep, 2, "load.torque"), 1.0);
    EXPECT_EQ(value(sweep, 3, "load.torque"), 2.0);
    EXPECT_EQ(value(sweep, 2, "clamping.driven"), 1e5);
    EXPECT_NEAR(value(sweep, 4, "clamping.driven"), 1e4, 1e-8);
}

TEST_F(SweepFile, KeysThatFollowAVehicleFollowEachOfItsCases) {
    const std::string masses = head + "[[axes]]\nkey = \"vehicle.mass\"\nvalues = [\"0 kg\", \"100 kg\", \"200 kg\"]\n";
    const Sweep sweep = read(masses);
    EXPECT_EQ(value(sweep, 0, "load.torque"), sweep.scene.parameters.load.torque.at(0.0)) << "no vehicle";
    EXPECT_NEAR(value(sweep, 1, "load.inertia"), 100.0 * std::pow(0.3 / 5.5, 2), 1e-12);
    EXPECT_NEAR(value(sweep, 2, "load.torque"), 2.0 * value(sweep, 1, "load.torque"), 1e-12);
    EXPECT_EQ(error(masses + "[[axes]]\nkey = \"load.torque\"\nvalues = [1, 2]\n[set]\n\"vehicle.mass\" = 50\n"),
              "s.toml:1:1: load.torque: follows from [vehicle]; remove it");
}

TEST_F(SweepFile, ASafetyHasNoFloorButThatOfAnAxisOrTheScene) {
    write("own.toml", "[load]\ntorque = 75\n");
    const std::string own = "[sweep]\nscene = \"own.toml\"\n[outputs]\nscalars = [\"slip mean\"]\n";
    const std::string safeties = "[[axes]]\nkey = \"clamping.safety\"\nvalues = [1.3, 0]\n";
    const std::string forces = "[[axes]]\nkey = \"clamping.driven\"\nvalues = [\"8 kN\", \"9 kN\"]\n";
    for (const auto& [text, first, last] :
         {std::tuple{own + safeties, 0.0, 20e3}, {own + safeties + forces, 8e3, 9e3}, {head + safeties, 5.7e3, 5.7e3}}) {
        const Sweep sweep = read(text);
        EXPECT_EQ(value(sweep, 0, "clamping.driven"), first) << text;
        EXPECT_EQ(value(sweep, sweep.cases() - 1, "clamping.driven"), last) << text;
    }
}

TEST_F(SweepFile, ZipsKeysAndReadsCsv) {
    write("rows.csv",
          "\xEF\xBB\xBF# measured\nload.torque [N*m], detail.pulleys, clamping.driven\n1, elastic, 5 kN\n2.5, rigid, \"6 kN\"\n");
    const Sweep sweep = read(head +
                             "[[axes]]\ncsv = \"rows.csv\"\n[[axes]]\nzip = [{key = \"start.ratio\", values = [0.9, 1.1]}, {key = "
                             "\"drive.speed\", values = [\"1000 rpm\", \"2000 rpm\"]}]\n");
    ASSERT_EQ(sweep.cases(), 4);
    EXPECT_EQ(value(sweep, 3, "load.torque"), 2.5);
    EXPECT_EQ(value(sweep, 3, "clamping.driven"), 6e3);
    EXPECT_EQ(value(sweep, 3, "start.ratio"), 1.1);
    Scene scene = sweep.scene;
    sweep.apply_case(2, scene);
    EXPECT_EQ(scene.parameters.detail.pulleys, model::PulleyDetail::rigid);
}

TEST_F(SweepFile, TakesColumnsOfAMeasuredFileByTheirNames) {
    write("bench.csv", "run, T_2 [N*m], note, S_2 [kN]\n1, 6, warm, 5\n2, 7, \"cold, later warm\", 4\n");
    const std::string axis = "[[axes]]\ncsv = \"bench.csv\"\n";
    const std::string load = "{column = \"T_2\", key = \"load.torque\"}", clamping = "{column = \"S_2\", key = \"clamping.driven\"}";
    const Sweep sweep = read(head + axis + "columns = [" + clamping + ", " + load + "]\n");
    ASSERT_EQ(sweep.cases(), 2);
    EXPECT_EQ(value(sweep, 1, "load.torque"), 7.0);
    EXPECT_EQ(value(sweep, 1, "clamping.driven"), 4e3);
    EXPECT_EQ(read(head + axis + "columns = [" + load + "]\n").cases(), 2) << "one column alone";
    EXPECT_EQ(error(head + axis + "columns = [{column = \"T2\", key = \"load.torque\"}]\n"),
              "s.toml:6:7: axes.csv: bench.csv:1:1: unknown column \"T2\" (did you mean \"T_2\"?)");
    EXPECT_EQ(error(head + axis + "columns = [{column = \"T_2\", key = \"load.torqe\"}]\n"),
              "s.toml:7:35: axes.columns.key: unknown key \"load.torqe\" (did you mean \"load.torque\"?)");
    EXPECT_EQ(error(head + axis + "columns = [" + load + ", " + load + "]\n"),
              error(head + axis + "columns = [" + load + "]\n[[axes]]\nkey = \"load.torque\"\nvalues = [1]\n"));
}

TEST_F(SweepFile, LatinHypercubeHitsEveryIntervalOnceAndIsTheSameEverywhere) {
    const auto samples = latin_hypercube(50, 3, 4);
    for (std::size_t d = 0; d < 3; ++d) {
        std::set<int> hit;
        for (std::size_t i = 0; i < 50; ++i) hit.insert(static_cast<int>(50.0 * samples[3 * i + d]));
        EXPECT_EQ(hit.size(), 50u);
    }
    EXPECT_EQ(latin_hypercube(50, 3, 4), samples);
    EXPECT_NE(latin_hypercube(50, 3, 5), samples);
    std::mt19937_64 generator(9);  // 64-bit Mersenne twister: the standard fixes its numbers
    EXPECT_EQ(random_samples(1, 1, 9).front(), static_cast<double>(generator() >> 11U) * 0x1p-53);
}

TEST_F(SweepFile, SamplesStayInTheirBox) {
    const Sweep sweep = read(head +
                             "[[axes]]\nsample = \"random\"\ncount = 40\nseed = 3\nkeys = [{key = \"load.torque\", from = 1, to = 4}, {key "
                             "= \"tip.hertz\", from = 1e9, to = 1e11, scale = \"log\"}]\n");
    ASSERT_EQ(sweep.cases(), 40);
    int below = 0;
    for (long number = 0; number < 40; ++number) {
        EXPECT_TRUE(value(sweep, number, "load.torque") >= 1.0 && value(sweep, number, "load.torque") <= 4.0);
        below += value(sweep, number, "tip.hertz") < 1e10;
    }
    EXPECT_TRUE(below > 8 && below < 32)
        << "half of a logarithmic interval lies below its geometric mean: 20 of 40, 4 standard deviations are 12.6";
}

TEST_F(SweepFile, ReportsEveryMistakeWithItsPlace) {
    EXPECT_EQ(error("[sweep]\nscene = \"tny\"\n"), "s.toml:2:9: sweep.scene: " + std::string(CVTFLOW_SOURCE_DIR) +
                                                       "/scenes/tny.toml: cannot be read: No such file or directory");
    EXPECT_EQ(error(head + "[[axes]]\nkey = \"load.torqe\"\nvlues = [1]\n"),
              "s.toml:6:7: axes.key: unknown key \"load.torqe\" (did you mean \"load.torque\"?)\ns.toml:7:1: axes.vlues: unknown key "
              "(did you mean \"values\"?)");
    EXPECT_EQ(error(head + "[[axes]]\nkey = \"load.torque\"\nvalues = [\"1 N\"]\n"),
              "s.toml:7:11: load.torque: 1 N is a force, expected a torque (N*m)");
    EXPECT_EQ(error(head + "[[axes]]\nkey = \"detail.pulleys\"\nfrom = \"elastic\"\nto = \"rigid\"\ncount = 2\n"),
              "s.toml:5:1: axes.from: detail.pulleys has no values in between; list them");
    EXPECT_EQ(error("[sweep]\nscene = \"tiny\"\n[outputs]\nscalars = [\"slp mean\", \"slip men\", \"sheaves/axial_force mean\", \"slip at "
                    "3\"]\n[[axes]]\nkey = \"load.torque\"\nvalues = [1]\n"),
              "s.toml:4:12: outputs.scalars: \"slp mean\": unknown channel \"slp\" (did you mean \"slip\"?)\n"
              "s.toml:4:24: outputs.scalars: \"slip men\": \"men\" is not one of mean, min, max, rms, final, at, median (did you mean "
              "\"mean\"?)\n"
              "s.toml:4:36: outputs.scalars: \"sheaves/axial_force mean\": sheaves/axial_force has several numbers; write "
              "sheaves/axial_force[0] … or sheaves/axial_force[*] for all of them\n"
              "s.toml:4:64: outputs.scalars: \"slip at 3\": \"3\" is not a time");
    EXPECT_EQ(error(head + "[[axes]]\nzip = [{key = \"load.torqe\", values = [1]}, {key = \"start.ratio\", values = [1, 2]}]\n"),
              "s.toml:6:15: axes.zip.key: unknown key \"load.torqe\" (did you mean \"load.torque\"?)");
    EXPECT_EQ(error(head), "s.toml:1:1: axes: none given; nothing varies");
    write("rows.csv", "load.torque\n1 kg\n");
    EXPECT_EQ(error(head + "[[axes]]\ncsv = \"rows.csv\"\n"),
              "s.toml:6:7: axes.csv: rows.csv:2:1: load.torque: 1 kg is a mass, expected a torque (N*m)");
    EXPECT_EQ(error(head + "[[axes]]\ncsv = \"/dev/zero\"\n"), "s.toml:6:7: axes.csv: \"/dev/zero\" cannot be read: not a regular file");
}

/// Cost of a sweep over that of a step's evaluations and unknowns, which no measurement disturbs.
double cost_of(const Sweep& sweep) {
    const BatchEstimate result = estimate(sweep, 0.01);
    EXPECT_EQ(result.measured, 3) << result.untried;
    return result.total / result.seconds_per_cost;
}

/// 3 x 4 cases of tiny, which has no state: 1 ms of run and 3 ms of settling each.
TEST_F(SweepFile, AnEstimateCountsEverySettlingOnceInEveryStartMode) {
    const std::string cases =
        head +
        "[set]\nrun.until = \"1 ms\"\nstart.settling_time = \"3 ms\"\nstart.ramp_time = \"1 ms\"\n"
        "[[axes]]\nkey = \"load.torque\"\nvalues = [1, 2, 3]\n[[axes]]\nkey = \"run.until\"\nvalues = [\"1 ms\", \"1 ms\", \"1 ms\", \"1 "
        "ms\"]\n[start]\nmode = ";
    const double alone = cost_of(read(cases + "\"scene\"\n")), settled = cost_of(read(cases + "\"settle\"\n")),
                 shared = cost_of(read(cases + "\"shared\"\n"));
    EXPECT_NEAR(alone / (12 + 12 * 3), shared / (12 + 1 * 3), 1e-9 * shared) << "each by itself; all share one";
    EXPECT_NEAR(settled / (12 + 3 * 3), shared / (12 + 1 * 3), 1e-9 * shared) << "one per load";
}

/// The state of baseline is of elastic pins: 1,416 unknowns of rigid pins are not in it.
TEST_F(SweepFile, AnEstimateMeasuresCasesOfAnotherLevelOfDetailThanTheScenesState) {
    for (const std::string mode : {"scene", "settle", "shared"}) {
        const Sweep sweep = read(
            "[sweep]\nscene = \"baseline\"\ndetail = \"rigid\"\n[outputs]\nscalars = [\"slip mean\"]\n[[axes]]\nkey = "
            "\"load.torque\"\nvalues = [1, 2, 3]\n"
            "[start]\nmode = \"" +
            mode + "\"\n");
        EXPECT_GT(cost_of(sweep), 0.0) << mode;
    }
}

/// A million cases would take ten times as long. Placing the chain for every case took 8 s for these.
TEST_F(SweepFile, AHundredThousandCasesAreEstimatedInSeconds) {
    const Sweep sweep = read(head + "[[axes]]\nkey = \"load.torque\"\nfrom = 1\nto = 9\ncount = 100000\n");
    const std::clock_t begin = std::clock();
    EXPECT_EQ(estimate(sweep, 0.01).cases, 100000);
    EXPECT_LT(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, 3.0);
}

TEST_F(SweepFile, RefusesOutputsBeyondTheEndOfACase) {
    const std::string cases = "[[axes]]\nkey = \"run.until\"\nvalues = [\"2 ms\", \"1 ms\"]\n";
    const std::string outputs = "[sweep]\nscene = \"tiny\"\n[outputs]\nscalars = [\"slip mean\", \"slip at ";
    EXPECT_EQ(error(outputs + "1 ms\"]\nfrom = \"0.9 ms\"\n" + cases), "none");
    EXPECT_THAT(error(outputs + "1 ms\"]\nfrom = \"1 ms\"\n" + cases),
                HasSubstr("outputs.from: 1e-3 s is run.until: no time is left for \"slip mean\""));
    EXPECT_THAT(error(outputs + "1 ms\"]\nfrom = \"1 s\"\n" + cases),
                HasSubstr("outputs.from: 1 s is beyond run.until = 1e-3 s: no output"));
    EXPECT_THAT(error(outputs + "1.5 ms\"]\n" + cases), HasSubstr("outputs.scalars: \"slip at 1.5 ms\" is beyond run.until = 1e-3 s"));
}

TEST_F(SweepFile, SteadyIsForAllCasesAndWithoutAnotherAccuracy) {
    const std::string sweep = "[sweep]\nscene = \"baseline\"\n[outputs]\nscalars = [\"slip mean\"]\n";
    const std::string set = "[set]\nrun.until = \"steady\"\n", axis = "[[axes]]\nkey = \"load.torque\"\nvalues = [1, 2]\n";
    EXPECT_EQ(error(sweep + set + axis + "[steady]\nconfirm = 1\nseed = 7\n"), "none");
    EXPECT_TRUE(read(sweep + set + axis).steady());
    EXPECT_THAT(error(sweep + axis + "[steady]\nconfirm = 1\n"), HasSubstr("steady: only with run.until = \"steady\""));
    EXPECT_THAT(error(sweep + set + axis + "[accuracy]\ntarget = \"3 %\"\n"), HasSubstr("has no fixed time"));
    EXPECT_THAT(error(sweep + set + "[[axes]]\nkey = \"run.until\"\nvalues = [\"1 ms\"]\n"), HasSubstr("it is no value of an axis"));
}

/// Four lines of three loads; a fall inside a line, or a shorter one, has no strands of equal length.
TEST_F(SweepFile, ContinuesAlongLinesOfACsvWhileItsKeyRises) {
    const std::string sweep =
        "[sweep]\nscene = \"baseline\"\n[outputs]\nscalars = [\"slip mean\"]\n[[axes]]\ncsv = \"lines.csv\"\n"
        "[start]\ncontinuation = \"load.torque\"\n";
    const auto with = [&](const std::string& loads) {
        std::ofstream(folder_ / "lines.csv") << "load.torque, clamping.driven\n" << loads;
        return error(sweep);
    };
    const std::string line = "10, 20000\n20, 20000\n30, 20000\n";
    EXPECT_EQ(with(line + line + line + line), "none");
    EXPECT_EQ(read(sweep).strand(), 3);
    const std::string across = sweep + "across = \"clamping.driven\"\n", tighter = "11, 30000\n22, 30000\n33, 30000\n";
    EXPECT_EQ(with(line + tighter + line + tighter), "none");
    EXPECT_EQ(read(across).strand(), 6);
    EXPECT_THAT(with(line + "10, 20000\n20, 20000\n"), HasSubstr("does not rise along lines of rows of equal length"));
    EXPECT_THAT(with(line + "10, 20000\n5, 20000\n30, 20000\n"), HasSubstr("does not rise along lines of rows of equal length"));
}

TEST(DrawCases, AreDistinctAscendingAndOfTheSeed) {
    EXPECT_EQ(draw_cases(5, 9, 3), (std::vector<long>{0, 1, 2, 3, 4}));
    EXPECT_EQ(draw_cases(1000, 7, 3), draw_cases(1000, 7, 3));
    EXPECT_NE(draw_cases(1000, 7, 3), draw_cases(1000, 7, 4));
    EXPECT_EQ(draw_cases(1000, 7, 3).size(), 7u);
    EXPECT_TRUE(draw_cases(0, 5, 1).empty());
}

TEST_F(SweepFile, KeepsTheCasesThatOnlyNames) {
    const std::string torque = "[[axes]]\nkey = \"load.torque\"\nvalues = [8, 14, 6, 10]\n";
    const std::string speed = "[[axes]]\nkey = \"drive.speed\"\nvalues = [100, 150, 200]\n";
    const auto only = [&](const std::string& which, const std::string& axes) {
        return "[sweep]\nscene = \"tiny\"\nonly = " + which + "\n[outputs]\nscalars = [\"slip mean\"]\n" + axes;
    };
    // rows 0, 1, 2 and 3 of the torques: first, highest, lowest, last; rows 0 and 2 of the speeds
    const Sweep corners = read(only("\"corners\"", torque + speed));
    ASSERT_EQ(corners.cases(), 8);
    EXPECT_EQ(value(corners, 3, "load.torque"), 14.0);
    EXPECT_EQ(value(corners, 3, "drive.speed"), 200.0);
    const Sweep two = read(only("[11, 4]", torque + speed));
    ASSERT_EQ(two.cases(), 2);
    EXPECT_EQ(value(two, 0, "load.torque"), 10.0);
    EXPECT_EQ(value(two, 1, "drive.speed"), 150.0);
    EXPECT_THAT(error(only("[12]", torque + speed)),
                HasSubstr("sweep.only: not \"corners\" of valid cases, nor a list of numbers below 12"));
    const std::string inner = "[[axes]]\nkey = \"pulley.innermost\"\nvalues = [\"10 mm\", \"11 mm\", \"30 mm\"]\n";
    EXPECT_EQ(read(only("\"corners\"", inner)).cases(), 1) << "30 mm are beyond pulley.outermost";
    std::string eleven = "[[axes]]\nkey = \"load.torque\"\nvalues = [1, 2, 3]\n";
    for (const char* key : {"clamping.driving", "clamping.driven", "drive.speed"})
        eleven += std::string("[[axes]]\nkey = \"") + key + "\"\nvalues = [100, 150]\n";
    EXPECT_EQ(read(only("\"corners\"", eleven)).cases(), 8) << "of sixteen";
}

/// A search for the nearest name took 0.06 ms of each.
TEST_F(SweepFile, ListsTheFirstHundredOfManyProblems) {
    std::string many = head + "[set]\n";
    for (int i = 0; i < 20000; ++i) many += "load.torqe" + std::to_string(i) + " = 1\n";
    const std::clock_t begin = std::clock();
    const std::string message = error(many + "[[axes]]\nkey = \"load.torque\"\nvalues = [1]\n");
    EXPECT_LT(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC, 0.5);
    EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 100);
    EXPECT_THAT(message, HasSubstr("… and 19900 more problems"));
}

/// Two workers: the first cases include the settling that all share.
TEST(BatchProgress, PredictsByThePaceAfterEveryWorkersFirstCase) {
    BatchProgress progress{.cases = 102, .before = 2, .done = 1, .wall = 10.0};
    EXPECT_TRUE(std::isnan(progress.left()));
    progress = {.cases = 102, .before = 2, .done = 3, .wall = 10.3, .warm = 2, .warm_wall = 10.1};
    EXPECT_TRUE(std::isnan(progress.left())) << "one case of two workers may have been nearly done";
    progress = {.cases = 102, .before = 2, .done = 12, .wall = 11.1, .warm = 2, .warm_wall = 10.1};
    EXPECT_DOUBLE_EQ(progress.left(), 8.8);
    progress.done = 100;
    EXPECT_EQ(progress.left(), 0.0);
}

/// Means over time by the trapezoidal rule; parts, as the pin periods of a steady case are, continue each other.
TEST(Reducer, ReducesAsItsTextStates) {
    std::vector<Problem> none;
    const std::map<std::string, double> expected{{"slip mean", 2.75},
                                                 {"slip min", 1.0},
                                                 {"slip max", 4.0},
                                                 {"slip rms", std::sqrt(9.25)},
                                                 {"slip final", 2.0},
                                                 {"slip at 0.5 s", 4.0},
                                                 {"slip median", 2.0},
                                                 {"slip max / slip mean", 4.0 / 2.75},
                                                 {"slip max / slip rms", 4.0 / std::sqrt(9.25)}};
    for (const auto& [text, value] : expected) {
        const Scalar scalar = parse_scalar(text, {}, none);
        Reducer whole, sum, parts[3];
        EXPECT_TRUE(std::isnan(whole.result(scalar)));
        const double numbers[] = {1.0, 4.0, 2.0};
        for (std::size_t k = 0; k < 3; ++k) {
            if (k > 0) parts[k] = parts[k - 1].continued(scalar);
            for (std::size_t term = 0; term < scalar.terms.size(); ++term) {
                for (Reducer* each : {&whole, &parts[k]}) each->add(scalar, term, 0.25 * static_cast<double>(k + 1), {&numbers[k], 1});
            }
        }
        for (const Reducer& part : parts) sum.add(scalar, part);
        sum.add(scalar, Reducer());
        EXPECT_DOUBLE_EQ(whole.result(scalar), value) << text;
        EXPECT_DOUBLE_EQ(sum.result(scalar), value) << text << ": of its parts";
    }
    EXPECT_TRUE(parse_scalar("slip mean / slip rms", {}, none).averages());
    EXPECT_FALSE(parse_scalar("slip mean / slip max", {}, none).averages());
    EXPECT_TRUE(none.empty());
}

/// An efficiency has no value before there is power. Other channels that are no numbers make a case undefined.
TEST(Reducer, LeavesOutOutputsAtWhichAQuotientIsUndefined) {
    const double none = std::numeric_limits<double>::quiet_NaN();
    std::vector<Problem> problems;
    const auto reduced = [&](const std::string& text) {
        const Scalar scalar = parse_scalar(text, {}, problems);
        Reducer reducer;
        double time = 0.0;
        for (const double number : {none, 0.8, 0.9}) {
            reducer.add(scalar, 0, time, {&number, 1});
            time += 0.25;
        }
        return reducer.result(scalar);
    };
    EXPECT_DOUBLE_EQ(reduced("thrust_ratio mean"), 0.85);
    EXPECT_DOUBLE_EQ(reduced("efficiency min"), 0.8);
    EXPECT_DOUBLE_EQ(reduced("thrust_ratio median"), 0.85);
    EXPECT_TRUE(std::isnan(reduced("efficiency at 0 s")) && !parse_scalar("efficiency at 0 s", {}, problems).may_be_undefined());
    EXPECT_TRUE(std::isnan(reduced("slip mean"))) << "a fault";
    EXPECT_TRUE(problems.empty());
}

/// A second drives with 100 W in and 90 W out, the next idles: 12 W in, 8 W lost, 4 W stored, 0 out. The mean of the instants is 61.7 %.
/// Or shaft 2 turns half as fast as shaft 1, then is at rest.
TEST(Reducer, MeanOfAQuotientIsThatOfItsSums) {
    using Sums = std::vector<std::vector<double>>;
    std::vector<Problem> none;
    for (const auto& [text, sums, half, all] :
         {std::tuple{"efficiency mean", Sums{{5, 0, 3, 7, -2}, {15, 0, 3, 107, -92}, {23, 0, 3, 119, -92}}, 0.9, 1.0 - 18.0 / 112.0},
          {"ratio mean", Sums{{1, 7}, {11, 12}, {21, 12}}, 2.0, 4.0}}) {
        const Scalar scalar = parse_scalar(text, {}, none);
        Reducer whole, both;
        whole.add(scalar, 0, 0.0, sums[0]);
        EXPECT_TRUE(scalar.may_be_undefined() && std::isnan(whole.result(scalar))) << "no time has passed";
        whole.add(scalar, 0, 1.0, sums[1]);
        EXPECT_DOUBLE_EQ(whole.result(scalar), half);
        Reducer first = whole, second = first.continued(scalar);
        for (Reducer* each : {&whole, &second}) each->add(scalar, 0, 2.0, sums[2]);
        EXPECT_FALSE(std::isfinite(second.result(scalar))) << "idle, or at rest";
        for (const Reducer& part : {first, second}) both.add(scalar, part);
        for (const Reducer& each : {whole, both}) EXPECT_DOUBLE_EQ(each.result(scalar), all) << "parts add up";
    }
}

TEST(Scalar, OfEveryElementHasAColumnOfItsOwn) {
    std::vector<Problem> none;
    const Scalar second = parse_scalar("sheaves/axial_force[2]  max", {}, none),
                 third = parse_scalar("sheaves/axial_force[3] max", {}, none);
    EXPECT_EQ(second.text, "sheaves/axial_force[2] max");
    EXPECT_EQ(second.column, "sheaves_axial_force_2_max");
    EXPECT_EQ(third.column, "sheaves_axial_force_3_max");
    EXPECT_EQ(parse_scalar("tips/axial_force[*] max", {}, none).column, "tips_axial_force_max") << "that of all";
    EXPECT_TRUE(none.empty());
}

TEST(Reducer, TakesAllElementsOfAChannel) {
    std::vector<Problem> none;
    const Scalar scalar = parse_scalar("tips/axial_force[*] max", {}, none);
    Reducer reducer;
    const double first[] = {1.0, -3.0, 2.0}, second[] = {0.5, 7.0, 1.0};
    reducer.add(scalar, 0, 0.0, first);
    reducer.add(scalar, 0, 1.0, second);
    EXPECT_DOUBLE_EQ(reducer.result(scalar), 7.0);
    EXPECT_TRUE(none.empty());
    (void)parse_scalar("tips/axial_force[*] final", {}, none);
    ASSERT_EQ(none.size(), 1u);
    EXPECT_THAT(none.front().message, testing::HasSubstr("name an element of"));
}

TEST(SweepKeys, AreExplainedOneByOneByTableAndAllTogether) {
    for (const SweepKey& row : sweep_keys()) {
        const std::string text = explain_sweep(row.key());
        EXPECT_THAT(text, testing::StartsWith(row.key() + "\n")) << row.key();
        EXPECT_THAT(text, HasSubstr(std::string(row.meaning))) << row.key();
        EXPECT_THAT(explain_sweep("sweep"), HasSubstr(text.substr(0, text.find("\n\n")))) << row.key();  // alone, without what is below it
    }
    EXPECT_THAT(explain_sweep("sweep.axes"), testing::AllOf(HasSubstr("sweep.axes.key\n"), HasSubstr("sweep.axes.zip.values\n")));
    EXPECT_THAT(explain_sweep("sweep.axes.zip"), testing::Not(HasSubstr("sweep.axes.csv\n")));
}

TEST(SweepKeys, AnUnknownOneIsAnErrorWithASuggestion) {
    EXPECT_EQ(message_of([] { return explain_sweep("sweep.axes.vlues"); }),
              "sweep.axes.vlues: unknown key of a sweep (did you mean \"sweep.axes.values\"?)");
}

TEST(SweepKeys, SectionsAreThoseOfTheFile) {
    EXPECT_THAT(sweep_sections(), testing::ElementsAre("sweep", "set", "axes", "outputs", "budget", "start", "steady", "accuracy"));
}

TEST(SweepSchema, HasEveryKeyAndTheKeysOfScenes) {
    const auto schema = nlohmann::json::parse(sweep_schema());
    const auto& tables = schema.at("properties");
    EXPECT_EQ(tables.size(), sweep_sections().size());
    for (const SweepKey& row : sweep_keys()) {
        if (row.form == SweepForm::scene_keys) continue;
        const auto& section = tables.at(std::string(row.table.substr(0, row.table.find('.'))));
        const auto& table = section.contains("items") ? section.at("items") : section;
        const std::size_t dot = row.table.find('.');
        const auto& inner =
            dot == std::string_view::npos ? table : table.at("properties").at(std::string(row.table.substr(dot + 1))).at("items");
        EXPECT_TRUE(inner.at("properties").contains(std::string(row.name))) << row.key();
        EXPECT_EQ(inner.at("additionalProperties"), false) << row.key();
    }
    for (const Parameter& parameter : parameter_table()) {
        const auto& sections = tables.at("set").at("properties");
        EXPECT_TRUE(sections.at(std::string(parameter.section())).at("properties").contains(std::string(parameter.name())))
            << parameter.key;
    }
}

}  // namespace
}  // namespace cvtflow::tasks
