#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "engine/method/catalogue.hpp"
#include "tasks/run/channels/channels.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tests/tools/program_fixture.hpp"

namespace cvtflow::tools {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

const std::vector<std::string> names{"run",     "resume",   "batch",     "table",     "merge",     "settle",      "check",  "info",
                                     "plot",    "report",   "list",      "explain",   "schema",    "local-error", "method", "fit",
                                     "compare", "spectrum", "stability", "pin-entry", "profile",   "newton",      "detail", "tradeoff",
                                     "tune",    "extremes", "dot",       "export",    "export-fmu"};

class Commands : public Program {};

TEST_F(Commands, AreAllInTheHelp) {
    const Outcome help = run({"--help"});
    EXPECT_EQ(help.status, 0);
    for (const std::string& name : names) {
        EXPECT_THAT(help.out, HasSubstr("\n  " + name + " "));
        const Outcome own = run({name, "--help"});
        EXPECT_EQ(own.status, 0) << name;
        EXPECT_THAT(own.out, HasSubstr("Usage: cvtflow " + name)) << name;
    }
}

TEST_F(Commands, DocumentTheExitStatus) {
    for (const std::string status : {"0 ", "1 ", "2 ", "3 ", "4 ", "130 "}) {
        EXPECT_THAT(run({"--help"}).out, HasSubstr("\n  " + status));
        EXPECT_THAT(run({"run", "--help"}).out, HasSubstr("\n  " + status));
    }
}

TEST_F(Commands, VersionTellsProgramBuildAndMachine) {
    const Outcome outcome = run({"--version"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_THAT(outcome.out, AllOf(StartsWith("cvtflow "), HasSubstr("\nbuilt with "), HasSubstr("\nrunning on ")));
}

TEST_F(Commands, TakeAnInstructionSetBeforeOrAfterTheirName) {
    const std::vector<std::string> brief{"--until", "1 us", "-o", "none"};
    std::vector<std::string> before{"--isa", "baseline", "run", "tiny"}, after{"run", "tiny", "--isa", "baseline"};
    before.insert(before.end(), brief.begin(), brief.end());
    after.insert(after.end(), brief.begin(), brief.end());
    for (const auto& words : {before, after}) {
        const Outcome outcome = run(words);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_THAT(outcome.out, HasSubstr("kernels             baseline"));
    }
    const Outcome unknown = run({"run", "tiny", "--isa", "sse9"});
    EXPECT_EQ(unknown.status, 2);
    EXPECT_THAT(unknown.err, HasSubstr("instruction set \"sse9\" is unknown"));
}

TEST_F(Commands, TradeoffWithDetailAloneComparesLevelsOfDetail) {
    const Outcome outcome = run({"tradeoff", "tiny", "--detail"});
    EXPECT_NE(outcome.status, 0);
    EXPECT_THAT(outcome.err, HasSubstr("tiny: has no settled state of full detail"));
}

TEST_F(Commands, ListEveryRowOfTheCatalogues) {
    const std::string methods = run({"list", "methods"}).out, channels = run({"list", "channels"}).out, keys = run({"list", "keys"}).out;
    for (const engine::StagePlan& plan : engine::methods()) EXPECT_THAT(methods, HasSubstr("\n" + plan.name + " "));
    for (const tasks::Channel& channel : tasks::channels()) EXPECT_THAT(channels, HasSubstr("\n" + std::string(channel.name) + " "));
    for (const tasks::Parameter& parameter : tasks::parameter_table())
        EXPECT_THAT(keys, HasSubstr("\n" + std::string(parameter.key) + " "));
    const std::string detail = run({"list", "detail"}).out;
    for (const tasks::DetailPreset& preset : tasks::detail_presets()) EXPECT_THAT(detail, HasSubstr("\n" + std::string(preset.name) + " "));
    EXPECT_THAT(run({"list", "scenes"}).out, AllOf(HasSubstr("\nbaseline "), HasSubstr("\ntiny ")));
    EXPECT_THAT(run({"list", "executors", "units"}).out, AllOf(HasSubstr("\nserial "), HasSubstr("\na torque ")));
}

TEST_F(Commands, ListMethodsAtOnce) {
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_THAT(run({"list", "methods"}).out, testing::ContainsRegex("\nrk4 +4 +4 +[a-z]"));
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(1)) << "4 s of processor time with the measured stability";
}

TEST_F(Commands, ExplainKeysAndSections) {
    const Outcome key = run({"explain", "tip.radius"});
    EXPECT_THAT(key.out, StartsWith("tip.radius\n"));
    EXPECT_THAT(run({"explain", "tip"}).out, AllOf(HasSubstr("tip.radius\n"), HasSubstr("tip.angle\n")));
}

TEST_F(Commands, ExplainSaysWhatAKeyIsInASceneAndHowFarItsStepIsStable) {
    const std::string clamping = run({"explain", "chain.pins", "--scene", "tiny"}).out;
    EXPECT_THAT(clamping, HasSubstr("here:     24 in tiny"));
    const std::string step = run({"explain", "run.step", "--scene", "baseline", "--set", "run.method=leapfrog-chebyshev"}).out;
    EXPECT_THAT(step, AllOf(HasSubstr("stable:   baseline with leapfrog-chebyshev up to 2"), HasSubstr("auto is:  1.")));
    EXPECT_THAT(run({"explain", "run.step", "--scene", "baseline", "--set", "run.step=3us"}).out, HasSubstr("run.step is beyond"));
}

TEST_F(Commands, SchemaIsJson) {
    const auto schema = nlohmann::json::parse(run({"schema"}).out);
    EXPECT_TRUE(schema["properties"].contains("chain"));
}

TEST_F(Commands, CheckSaysWhatASceneIs) {
    const Outcome outcome = run({"check", "tiny", "--step", "50 ns"});
    EXPECT_EQ(outcome.status, 0);
    // Order 1: 4 (1 + 1) + 4 coordinates per link.
    EXPECT_THAT(outcome.out, HasSubstr("324 coordinates (24 links x 12 + pulleys 36), 648 unknowns\n"));
    EXPECT_THAT(outcome.out, HasSubstr("geometric at ratio 1, settles for 10 ms\n"));
    EXPECT_THAT(outcome.out, HasSubstr("20 000 + 200 000 for settling\n"));  // (1 + 10) ms of 50 ns
    EXPECT_THAT(outcome.out, HasSubstr("880 000, and some for transitions\n"));
    EXPECT_THAT(outcome.out, HasSubstr("\n  schedule            auto, which chooses the segments\n"));
    EXPECT_THAT(outcome.out, testing::ContainsRegex("states? every [^\n]*, up to [0-9.]+ [kM]?B\n"));
    EXPECT_THAT(outcome.out, testing::ContainsRegex("\n  time                about [0-9:.]+( s)? on one thread"));
    EXPECT_THAT(run({"check", "tiny", "--set", "run.segments=3"}).out, HasSubstr("\n  schedule            auto, 3 segments\n"));
}

// Tips brake the spin of sheaves by impulses that a leapfrog takes from the step's start; damping of tips is explicit as well. Neither is
// in the test equation that automatic steps come from, both are in the linearised step.
TEST_F(Commands, CheckSaysWhereTheAutomaticStepDoesNotHold) {
    for (const char* setting : {"pulley.sheave_polar_inertia=1.5e-4", "tip.reference_depth=1e-7"}) {
        const Outcome outcome = run({"check", "baseline", "--method", "leapfrog-chebyshev", "--set", setting});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_THAT(outcome.out, testing::ContainsRegex("\n  stable to +.*\\); \"auto\" is beyond: run.step = \"[0-9.]+ ns\" or less\n"))
            << setting;
    }
}

TEST_F(Commands, CheckSaysUpToWhereASettledSceneIsStable) {
    const Outcome beyond = run({"check", "control", "--step", "2 us"});
    EXPECT_EQ(beyond.status, 0) << beyond.err;
    EXPECT_THAT(
        beyond.out,
        testing::ContainsRegex("\n  stable to +1\\.9[0-9]* us \\(oscillation of .* kHz under friction of .* 1/s\\); run.step is beyond\n"));
    for (const char* step : {"1.8 us", "auto"})
        EXPECT_THAT(run({"check", "control", "--step", step}).out, testing::Not(HasSubstr(" is beyond")));
    EXPECT_THAT(run({"check", "control", "--method", "trapezoidal-once"}).out,
                testing::ContainsRegex("\n  stable to +linear stability sets no limit\n"));
    EXPECT_THAT(run({"check", "tiny"}).out, testing::Not(HasSubstr("stable to"))) << "there is no state yet";
}

TEST_F(Commands, InfoShowsRecords) {
    ASSERT_EQ(run_briefly({"-q", "-o", "r.h5"}).status, 0);
    const std::string text = run({"info", "r.h5"}).out;
    EXPECT_THAT(text, AllOf(StartsWith("r.h5: record of a run, "), HasSubstr("\n  status              finished\n"),
                            HasSubstr("\n  scene               tiny\n")));
    EXPECT_THAT(text, AllOf(HasSubstr("\n  program             cvtflow "), HasSubstr("\n  rows                3, t = 0 s to 20 us\n")));
    EXPECT_THAT(text, testing::ContainsRegex("\n  links/tension +N +3 x 24 +[0-9.e+-]+ \\.\\.\\. "));
    EXPECT_THAT(text, testing::ContainsRegex("\n  transitions +[0-9]+ +time pin tip from to "));
}

TEST_F(Commands, InfoShowsStates) {
    ASSERT_EQ(run({"settle", "tiny", "-q", "-o", "s.h5", "--time", "20us", "--set", "start.ramp_time=10us"}).status, 0);
    const std::string text = run({"info", "s.h5"}).out;
    EXPECT_THAT(text,
                AllOf(StartsWith("s.h5: state, "), HasSubstr("\n  time                0 s\n"), HasSubstr("\n  unknowns            648\n")));
    EXPECT_THAT(text, AllOf(HasSubstr("\n  state hash "), HasSubstr("\n  settled with        scene tiny, 24 pins\n"),
                            HasSubstr(" 20 us of settling\n")));
}

TEST_F(Commands, LocalErrorShowsTheOrder) {
    const Outcome outcome = run({"local-error", "tiny", "--settle", "--set", "start.settling_time=1ms", "--set", "start.ramp_time=0.5ms",
                                 "--friction", "both", "--steps", "80ns,160ns"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, StartsWith("tiny: error of one step of rk4 (order 4: slope 5 where the solution is smooth), phases held, "));
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("\npiecewise friction\n"), HasSubstr("\nsmoothed friction\n"), HasSubstr("\n  160 ns "),
                                   HasSubstr("\n   80 ns ")));
}

TEST_F(Commands, LocalErrorOfSeveralMethodsIsATableAndAPictureEach) {
    const Outcome outcome = run(
        std::vector<std::string>{"local-error", "tiny", "--methods", "rk4,heun", "--steps", "80ns,160ns", "-o", "errors"} + brief_settling);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out,
                AllOf(HasSubstr("tiny: error of one step of rk4 (order 4"), HasSubstr("\ntiny: error of one step of heun (order 2")));
    EXPECT_THAT(
        outcome.out,
        HasSubstr("\n  written             errors/local-error.csv, errors/local-error.json, errors/local-error-axial-force-piecewise.svg, "
                  "errors/local-error-velocities-piecewise.svg\n"));
    EXPECT_THAT(read("errors/local-error.csv"),
                AllOf(StartsWith("method,friction,step,positions,velocities,axial_force,tension\nrk4,piecewise,1.6"),
                      HasSubstr("\nheun,piecewise,8")));
    EXPECT_THAT(read("errors/local-error-velocities-piecewise.svg"), AllOf(HasSubstr(">rk4</text>"), HasSubstr(">heun</text>")));
}

TEST_F(Commands, WriteAsJsonWhatTheyMeasure) {
    const auto json_of = [&](const std::vector<std::string>& words, const std::string& file) {
        const Outcome outcome = run(words + std::vector<std::string>{"--json"});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_THAT(outcome.out, HasSubstr("\n  written             results/" + file + "\n"));
        const auto json = nlohmann::json::parse(read("results/" + file));
        EXPECT_TRUE(json["provenance"].contains("commit")) << file;
        return json;
    };
    const auto errors =
        json_of(std::vector<std::string>{"local-error", "tiny", "--methods", "rk4,heun", "--steps", "80ns,160ns"} + brief_settling,
                "local-error.json");
    ASSERT_EQ(errors["curves"].size(), 2u);
    EXPECT_GT(double(errors["curves"][1]["errors"][0]["velocities"]), double(errors["curves"][0]["errors"][0]["velocities"]))
        << "heun has half the order";
    const auto maps = json_of({"stability", "rk4", "leapfrog-rkc", "sw2", "-q"}, "stability.json");
    EXPECT_NEAR(double(maps["tables"][0]["imaginary"]), 2.0 * std::sqrt(2.0), 1e-3);
    EXPECT_NEAR(double(maps["programs"][0]["oscillator"]["h_omega"]), 2.0, 1e-3);  // of every leapfrog
    EXPECT_TRUE(maps["programs"][1].contains("linear"));
    ASSERT_EQ(run({"settle", "tiny", "-q", "-o", "s.h5", "--time", "20us", "--set", "start.ramp_time=10us"}).status, 0);
    const auto trade = json_of({"tradeoff", "tiny", "rk4@50ns", "--reference", "rk4@25ns", "--duration", "24us", "--rounds", "2",
                                "--confirm", "24us", "--confirm-against", "rk4@25ns", "--set", "start.state=s.h5"},
                               "tradeoff_tiny.json");
    EXPECT_EQ(trade["choices"][0]["wall_seconds_per_second"].size(), 2u);
    const auto detail =
        json_of({"detail", "baseline", "--settle", "20us", "--average", "20us", "--control", "0 s"}, "detail_baseline.json");
    EXPECT_EQ(detail["variants"].size(), 14u);
    EXPECT_EQ(detail["variants"].back()["mass_scaling"], 3.0);
    EXPECT_TRUE(detail["variants"][0]["thrust_ratio"].is_null()) << "it was not looked for";
}

TEST_F(Commands, DetailNeedsAStateOfFullDetailAndItsDialsFree) {
    const Outcome other =
        run({"detail", "baseline", "--set", std::string("start.state=") + CVTFLOW_SOURCE_DIR + "/scenes/states/baseline-medium.h5"});
    EXPECT_EQ(other.status, 1);
    EXPECT_THAT(other.err, AllOf(StartsWith("cvtflow: baseline: variants start from a settled state of full detail: --set start.state="),
                                 HasSubstr("\n  detail.order = 3, settled with 1\n")));
    const Outcome held = run({"detail", "baseline", "--set", "detail.order=1"});
    EXPECT_EQ(held.status, 2);
    EXPECT_EQ(held.err, "cvtflow: --set detail.order=1: detail.order is one of the dials that are compared\n");
}

TEST_F(Commands, DetailComparesTheLevelsOfTheCatalogueWithTheFinestAtAQuarterOfItsStep) {
    const Outcome outcome = run(
        {"detail", "baseline", "--rungs", "--settle", "20us", "--average", "20us", "--control", "0 s", "--json", "--csv", "-o", "ladder"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const auto ladder = nlohmann::json::parse(read("ladder/ladder.json"));
    const auto presets = tasks::detail_presets();
    ASSERT_EQ(ladder["points"].size(), 1u);
    const auto& point = ladder["points"][0];
    EXPECT_EQ(point["reference"]["detail"], presets.back().name);
    EXPECT_EQ(point["reference"]["share"], 0.25);
    ASSERT_EQ(point["rungs"].size(), presets.size());
    for (std::size_t k = 0; k < presets.size(); ++k) EXPECT_EQ(point["rungs"][k]["detail"], presets[presets.size() - 1 - k].name);
    EXPECT_NEAR(double(point["reference"]["step"]) / double(point["rungs"][0]["step"]), 0.25, 0.02);
    for (const auto& rung : point["rungs"]) EXPECT_GT(double(rung["seconds"]), 0.0);
    EXPECT_THAT(read("ladder/ladder.csv"), StartsWith("point,detail,share,"));
    const Outcome both = run({"detail", "--rungs", "--all"});
    EXPECT_EQ(both.status, 2);
}

TEST_F(Commands, DetailKeepsFaultsOutOfItsTable) {
    const std::vector<std::string> brief{"--settle", "20us", "--average", "20us", "--control", "0 s"};
    const Outcome all = run(std::vector<std::string>{"detail", "baseline", "--set", "tip.deepest=6um"} + brief);
    EXPECT_EQ(all.status, 1);
    EXPECT_THAT(all.err, StartsWith("cvtflow: baseline: full detail, with which all is compared, ended: a tip of pin "));
    EXPECT_EQ(all.out, "");
    const Outcome some = run(std::vector<std::string>{"detail", "baseline", "--set", "tip.deepest=20um"} +
                             brief);  // rigid pulleys take the jolt with deeper tips
    EXPECT_EQ(some.status, 5);
    EXPECT_THAT(some.err, HasSubstr("cvtflow: baseline: p=3 each   8 pt rigid: a tip of pin "));
    EXPECT_THAT(some.out, testing::ContainsRegex("\n  p=3 each   8 pt rigid +1684 +- +- +- "));
    EXPECT_THAT(some.out, testing::Not(HasSubstr("a tip of")));
}

TEST_F(Commands, PinEntryCountsAndMeasuresErrors) {
    const Outcome outcome = run(std::vector<std::string>{"pin-entry", "tiny", "rk4@50ns", "dumka3-p2@1us", "--time", "24us", "--reference",
                                                         "rk4@25ns", "--rounds", "1", "--pin", "0", "-q", "-o", "c"} +
                                brief_settling);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, StartsWith("tiny: 24 us from t = 0 s, against rk4@25ns; one thread, medians of 1 round, in turns\n"));
    EXPECT_THAT(outcome.out, testing::ContainsRegex("\n  rk4 +50 ns +[0-9]+ +[0-9 ]+ +[0-9.e+]+ +1\\.00 +[0-9.e+]+ +1\\.00 "));
    EXPECT_THAT(read("c/comparison.csv"), StartsWith("method,step,steps,evaluations,transitions,"));
    EXPECT_THAT(read("c/pin-force.csv"), StartsWith("time,reference,rk4@50ns,dumka3-p2@1us\n0,"));
    EXPECT_EQ(nlohmann::json::parse(read("c/comparison.json"))["candidates"].size(), 2u);
    EXPECT_THAT(read("c/pin-force.svg"), HasSubstr(">reference</text>"));
}

TEST_F(Commands, DotDrawsATaskPerSegment) {
    const std::string text = run({"dot", "tiny", "--segments", "3"}).out;
    EXPECT_THAT(text, AllOf(StartsWith("digraph "), HasSubstr("force[2]"), testing::Not(HasSubstr("force[3]"))));
}

TEST_F(Commands, DotDrawsTheCyclesOfAMethodByTheirTasks) {
    const std::string kick = run({"dot", "tiny", "--segments", "3", "--method", "leapfrog-rkc", "--cycle", "friction"}).out;
    EXPECT_THAT(kick, AllOf(StartsWith("digraph "), HasSubstr("friction[2]"), testing::Not(HasSubstr("record"))));
    const std::string solve = run({"dot", "tiny", "--method", "trapezoidal-full", "--cycle", "backward"}).out;
    EXPECT_THAT(solve, AllOf(HasSubstr("label=\"forward[0]\""), HasSubstr("label=\"join\"")));
}

}  // namespace
}  // namespace cvtflow::tools
