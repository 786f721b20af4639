/// Commands that read results: `info`, `table --rainflow` and `diff`; a status that all of them state.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <hdf5.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "engine/record/run/state_file.hpp"
#include "tests/tools/forgery_fixture.hpp"
#include "tests/tools/program_fixture.hpp"

namespace cvtflow::tools {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

// Statements of `info` and of the summary about a run: the step that was taken, uncounted quantities, and tables of sweeps.

class Info : public Sweeps {
protected:
    const Words settled_{"--set", "start.settling_time=1ms", "--set", "start.ramp_time=0.5ms"};

    [[nodiscard]] std::string info(const std::string& file) const { return run({"info", file}).out; }
    [[nodiscard]] double taken(const std::string& file) const {
        const engine::RunReader reader = record(file);
        const auto* step = engine::attribute_value<double>(reader.attributes(), "step_taken");
        return step != nullptr ? *step : 0.0;
    }
};

TEST_F(Info, StatesTheStepThatWasTaken) {
    ASSERT_EQ(run(Words{"run", "tiny", "--method", "auto", "--until", "0.1 ms", "-q", "-o", "auto.h5"} + settled_).status, 0);
    EXPECT_NEAR(taken("auto.h5"), 2.5e-6, 0.5e-6);
    EXPECT_THAT(info("auto.h5"), ContainsRegex("\n  method              leapfrog-sweep, step auto \\([0-9.]+ us\\), seed 0\n"));
    ASSERT_EQ(run_briefly({"-q", "-o", "given.h5"}).status, 0);
    EXPECT_NEAR(taken("given.h5"), 50e-9, 1e-12);
    EXPECT_THAT(info("given.h5"), HasSubstr("step 50 ns, seed 0\n"));
    ASSERT_EQ(run(Words{"settle", "tiny", "-q", "-o", "state.h5"} + settled_).status, 0);
    EXPECT_THAT(info("state.h5"), ContainsRegex("rk4 with step auto \\([0-9.]+ ns\\), 1 ms of settling\n"));
}

TEST_F(Info, OfFilesOfEarlierProgramsStatesTheSettingAlone) {
    ASSERT_EQ(run(Words{"run", "tiny", "--until", "0.1 ms", "-q", "-o", "old.h5"} + settled_).status, 0);
    change_record((folder_ / "old.h5").string(), [](hid_t file) { H5Adelete(file, "step_taken"); });
    EXPECT_THAT(info("old.h5"), HasSubstr("rk4, step auto, seed 0\n"));
}

TEST_F(Info, CountsTransitionsOfRigidPins) {
    const Outcome outcome =
        run(Words{"run", "tiny", "--detail", "rigid", "--method", "auto", "--until", "1 ms", "-o", "rigid.h5"} + settled_);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, ContainsRegex("  transitions         [1-9][0-9]* detected, 0 steps truncated, 0 suppressed"));
}

TEST_F(Info, DescribesTheTableOfASweep) {
    write_sweep("\"6 N*m\"");
    ASSERT_EQ(batch({"-q"}).status, 0);
    for (const char* path : {"out", "out/cases.h5"}) {
        const std::string text = info(path);
        EXPECT_THAT(text,
                    AllOf(HasSubstr("out/cases.h5: results of a sweep, "), HasSubstr(" ok\n"), HasSubstr("status              finished"),
                          HasSubstr("cvtflow table " + std::string(path)), HasSubstr("energy_residual")));
        EXPECT_THAT(text, HasSubstr(table().attribute("results_hash")));
    }
}

/// A vehicle of 100 kg that has to gain 10 km/h in 50 ms, more than the chain can transfer; or that rolls on at 30 km/h.
TEST_F(Info, ACycleThatIsMissedIsTheStatusOfRunRecordAndCase) {
    const auto car = [&](const char* speed) {
        write("car.toml",
              "[detail]\nlevel = \"rigid\"\n[vehicle]\nmass = \"100 kg\"\n[cycle]\nspeed = [[\"0 s\", \"30 km/h\"], [\"50 ms\", \"" +
                  std::string(speed) +
                  " km/h\"]]\npedal_time = \"10 ms\"\n[clamping]\ndriving = \"20 kN\"\ndriven = \"15 kN\"\n[control]\nenabled = "
                  "true\n[start]\nsettling_time = \"5 ms\"\nramp_time = \"2 ms\"\n[run]\nuntil = \"50 ms\"\n");
    };
    car("30");
    EXPECT_EQ(run({"run", "car.toml", "-q", "-o", "none"}).status, 0);
    car("40");
    const Outcome missed = run({"run", "car.toml", "-o", "car.h5"});
    EXPECT_EQ(missed.status, 8);
    EXPECT_THAT(missed.out,
                AllOf(HasSubstr("car: cycle_missed at t = 0.05 s\n"),
                      ContainsRegex("\n  note                the machine misses its cycle: speed of shaft 2 is off by 7[0-9.]+ %")));
    EXPECT_THAT(info("car.h5"), HasSubstr("\n  status              cycle_missed: the machine misses its cycle: "));
    write("sweep.toml",
          "[sweep]\nscene = \"car.toml\"\n[[axes]]\nkey = \"vehicle.mass\"\nvalues = [\"100 kg\"]\n[outputs]\nrecords = true\n"
          "scalars = [\"ratio mean\", \"efficiency mean\"]\n");
    EXPECT_EQ(batch({"-q"}).status, 5);
    EXPECT_EQ(column("status").at(0), "cycle_missed");
    EXPECT_THAT(column("notes").at(0), HasSubstr("cycle_missed"));
    EXPECT_NE(column("ratio_mean").at(0), "nan") << "a case that has run completely has scalars";
    EXPECT_NEAR(taken("out/records/case-000000.h5"), 5e-6, 1e-6) << "of rigid pins";
}

// `cvtflow table RECORD --rainflow CHANNEL`.

class RainflowOfARecord : public Program {
protected:
    void SetUp() override {
        made_once("a record with a followed pin", [this] {
            const Words more{"-q", "-o", "run.h5", "--set", "record.channels=followed_pin/*", "--set", "run.output_interval=200 ns"};
            ASSERT_EQ(run_briefly(more).status, 0);
        });
    }
};

TEST_F(RainflowOfARecord, IsThatOfItsChannel) {
    const auto values = record("run.h5").channel("followed_pin/half_axial_force");
    std::vector<double> history;
    for (std::size_t row = 0; row < values.size() / 2; ++row) history.push_back(values[2 * row + 1]);
    const std::vector<double> times = record("run.h5").times();
    const Outcome json = run({"table", "run.h5", "--rainflow", "followed_pin/half_axial_force[1]", "--json"});
    ASSERT_EQ(json.status, 0) << json.err;
    const auto load = nlohmann::json::parse(json.out).at("loads").at(0);
    EXPECT_EQ(load.at("unit"), "N");
    const auto value_at = [&](const nlohmann::json& time) {
        return history.at(static_cast<std::size_t>(std::ranges::find(times, time.get<double>()) - times.begin()));
    };
    double counted = 0.0, all = 0.0, largest = 0.0;
    for (const auto& cycle : load.at("cycles")) {
        const double from = value_at(cycle.at("from_time")), to = value_at(cycle.at("to_time"));
        EXPECT_EQ(cycle.at("range"), std::abs(to - from));
        EXPECT_EQ(cycle.at("mean"), 0.5 * (from + to));
        all += cycle.at("count").get<double>();
        largest = std::max(largest, std::abs(to - from));
    }
    const auto turns = [&](std::size_t at) { return (history[at] - history[at - 1]) * (history[at + 1] - history[at]) < 0.0; };
    double stretches = 1.0;  // between reversals: each belongs to one cycle
    for (std::size_t at = 1; at + 1 < history.size(); ++at) stretches += turns(at) ? 1.0 : 0.0;
    EXPECT_EQ(2.0 * all, stretches);
    EXPECT_EQ(largest, *std::ranges::max_element(history) - *std::ranges::min_element(history));
    for (const auto& each : load.at("classes")) counted += each.at("count").get<double>();
    EXPECT_EQ(counted, all);
}

TEST_F(RainflowOfARecord, HasATextATableAndAWindow) {
    const Outcome text = run({"table", "run.h5", "--rainflow", "followed_pin/plate_tension[*]", "--classes", "4"});
    EXPECT_EQ(text.status, 0) << text.err;
    EXPECT_THAT(text.out, HasSubstr("followed_pin/plate_tension[0]: rainflow counts (ASTM E1049) of 101 outputs from 0 s to 20 us\n"));
    const Outcome csv = run({"table", "run.h5", "--rainflow", "tight_tension", "--rainflow", "slip", "--csv"});
    EXPECT_THAT(csv.out, testing::StartsWith("load,unit,range,mean,cycles,from_time,to_time\ntight_tension,N,"));
    EXPECT_THAT(csv.out, HasSubstr("\nslip,1,"));
    const Outcome window = run({"table", "run.h5", "--rainflow", "tight_tension", "--from", "4.9 us", "--until", "1.01e-5"});
    EXPECT_THAT(window.out, HasSubstr("of 26 outputs from 5 us to 10 us"));
    EXPECT_THAT(run({"table", "run.h5", "--rainflow", "tight_tension", "--from", "1 s"}).out, HasSubstr("no outputs\n  no cycles\n"));
}

TEST_F(RainflowOfARecord, HasADamageEquivalentRangeAndReportsThatTheRecordIsShort) {
    const Outcome json = run({"table", "run.h5", "--rainflow", "tight_tension", "--exponent", "3", "--json"});
    ASSERT_EQ(json.status, 0) << json.err;
    const auto load = nlohmann::json::parse(json.out).at("loads").at(0);
    double sum = 0.0;
    for (const auto& cycle : load.at("cycles")) sum += cycle.at("count").get<double>() * std::pow(cycle.at("range").get<double>(), 3.0);
    EXPECT_NEAR(load.at("damage_equivalent").at("range").get<double>(), std::cbrt(sum), 1e-9 * std::cbrt(sum)) << "once in the record";
    EXPECT_EQ(load.at("damage_equivalent").at("reference_cycles"), 1.0);
    const Outcome text = run({"table", "run.h5", "--rainflow", "tight_tension"});
    EXPECT_THAT(text.out, HasSubstr(" kN (exponent 5, one cycle in the record)\n"));
    EXPECT_THAT(text.out, HasSubstr("of a round of the chain (")) << "20 us of 58 ms";
    EXPECT_EQ(run({"table", "run.h5", "--rainflow", "tight_tension", "--exponent", "0"}).status, 2);
}

TEST_F(RainflowOfARecord, ReportsWhatItCannotCount) {
    const auto expect = [&](const std::vector<std::string>& more, int status, const std::string& why) {
        const Outcome outcome = run(std::vector<std::string>{"table", "run.h5"} + more);
        EXPECT_EQ(outcome.status, status) << outcome.err;
        EXPECT_THAT(outcome.err, HasSubstr(why));
        EXPECT_EQ(outcome.out, "");
    };
    expect({"--rainflow", "tight_tensoin"}, 2, "the record has no such channel (did you mean \"tight_tension\"?)");
    expect({"--rainflow", "tips/normal_force[0]"}, 2, "without this channel (record it with --set record.channels=tips/normal_force)");
    expect({"--rainflow", "followed_pin/position"}, 2, "it has 3 numbers; write followed_pin/position[0] ... followed_pin/position[2]");
    expect({"--rainflow", "followed_pin/position[3]"}, 2, "elements are numbered 0 to 2");
    expect({"--rainflow", "followed_pin/position[x]"}, 2, "elements are numbered 0 to 2");
    expect({"--rainflow", "slip", "--json", "--csv"}, 2, "--csv or --json, not both");
    expect({"--rainflow", "slip", "--status", "ok"}, 2, "--column and --status apply to sweeps");
    expect({"--rainflow", "slip", "--from", "3 kg"}, 2, "--from 3 kg: not a time");
    expect({"--json"}, 2, "require --rainflow");
    EXPECT_EQ(run({"table", "none.h5", "--rainflow", "slip"}).status, 1);
}

// `cvtflow diff`: two sweeps case by case.

class Diff : public Sweeps {
protected:
    void SetUp() override {
        made_once("a sweep of eight cases", [this] {
            write_sweep("\"6 N*m\", \"12 N*m\"");
            ASSERT_EQ(batch().status, 0);
        });
    }
};

TEST_F(Diff, OfTheSameSweepOnOtherThreadsIsNone) {
    ASSERT_EQ(run({"batch", "sweep.toml", "-o", "again", "--threads", "1"}).status, 0);
    const Outcome same = run({"diff", "out", "again"});
    EXPECT_EQ(same.status, 0) << same.err;
    EXPECT_THAT(same.out, HasSubstr("8 cases in out/cases.h5, 8 in again/cases.h5, 8 in both"));
    EXPECT_THAT(same.out, HasSubstr(" 0 differ\n"));
}

TEST_F(Diff, NamesColumnsCasesAndTheLargestDifference) {
    write_sweep("\"12 N*m\", \"18 N*m\"", "41 us");  // half of the cases in common, which run longer
    ASSERT_EQ(run({"batch", "sweep.toml", "-o", "longer"}).status, 0);
    const Outcome different = run({"diff", "out", "longer", "--json"});
    EXPECT_EQ(different.status, 1) << different.err;
    const auto all = nlohmann::json::parse(different.out);
    EXPECT_EQ(all["in_both"], 4);
    EXPECT_FALSE(all["equal"]);
    std::map<std::string, nlohmann::json> columns;
    for (const auto& column : all["columns"]) columns[column["column"]] = column;
    ASSERT_TRUE(columns.contains("steps"));
    EXPECT_EQ(columns["steps"]["cases"], 4);
    EXPECT_GE(columns["steps"]["largest"], 20);  // 1 us of steps of 50 ns
    EXPECT_FALSE(columns.contains("ratio_at_20_us")) << "the first 20 us are the same";
    const Outcome tolerant = run({"diff", "out", "longer", "--column", "slip_mean", "--tolerance", "1"});
    EXPECT_EQ(tolerant.status, 1) << "cases are missing";
    EXPECT_THAT(tolerant.out, HasSubstr("1 columns compared, 0 differ by more than 1 of the value\n"));
    const std::string shown = run({"diff", "out", "longer", "--column", "slip_mean"}).out;
    const std::string change = columns["slip_mean"]["example"];  // in SI: "…: 0.001 -> 0.002"
    const double before = std::stod(change.substr(change.rfind(": ") + 2)), after = std::stod(change.substr(change.rfind("> ") + 2));
    EXPECT_THAT(shown, HasSubstr(fmt::format("{:.8g} -> {:.8g}", 100.0 * before, 100.0 * after))) << "slip_mean [%]";
}

TEST_F(Diff, ReadsTheCsvOfATable) {
    write("out.csv", run({"table", "out", "--csv"}).out);
    const Outcome same = run({"diff", "out", "out.csv"});
    EXPECT_EQ(same.status, 0) << same.out << same.err;
    std::string other = read("out.csv");
    const auto cell = other.find(",ok,");
    ASSERT_NE(cell, std::string::npos);
    write("other.csv", other.replace(cell, 4, ",budget,"));
    const Outcome different = run({"diff", "out", "other.csv"});
    EXPECT_EQ(different.status, 1);
    EXPECT_THAT(different.out, HasSubstr("ok -> budget"));
}

TEST_F(Diff, RefusesTablesWhoseCasesHaveNoKeys) {
    write("keyless.csv", "case,status,slip_mean\n0,ok,0.1\n1,ok,0.2\n");
    const Outcome refused = run({"diff", "out", "keyless.csv"});
    EXPECT_EQ(refused.status, 2);
    EXPECT_THAT(refused.err, HasSubstr("both tables need the keys in which they differ"));
    EXPECT_EQ(run({"diff", "out", "out", "--column", "no_such"}).status, 2);
}

}  // namespace
}  // namespace cvtflow::tools
