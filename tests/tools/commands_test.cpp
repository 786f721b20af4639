/// Commands as their help, the manual page and the completions list them.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "engine/method/catalogue.hpp"
#include "tasks/channel/channels.hpp"
#include "tasks/method/method.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/scene.hpp"
#include "tests/tools/program_fixture.hpp"
#include "tools/program/command/reference/terms.hpp"

namespace cvtflow::tools {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

class Commands : public Program {};

TEST_F(Commands, AreAllInTheHelp) {
    const Outcome help = run({"--help"});
    EXPECT_EQ(help.status, 0);
    const Words names = commands_of(CVTFLOW_PROGRAM);
    EXPECT_EQ(names.size(), 19u);
    for (const std::string& name : names) {
        const Outcome shown = run({name, "--help"});
        EXPECT_EQ(shown.status, 0) << name;
        EXPECT_THAT(shown.out, HasSubstr("Usage: cvtflow " + name)) << name;
    }
}

TEST_F(Commands, DocumentTheExitStatus) {
    for (const std::string status : {"0 ", "1 ", "2 ", "3 ", "4 ", "130 "}) {
        EXPECT_THAT(run({"--help"}).out, HasSubstr("\n  " + status));
    }
    EXPECT_THAT(run({"run", "--help"}).out, HasSubstr("cvtflow --help"));
}

TEST_F(Commands, VersionReportsProgramBuildAndMachine) {
    const Outcome outcome = run({"--version"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_THAT(outcome.out, AllOf(StartsWith("cvtflow "), HasSubstr("\nbuilt with "), HasSubstr("\nrunning on ")));
}

TEST_F(Commands, TakeAnInstructionSetBeforeOrAfterTheirName) {
    const Words brief{"--until", "1 us", "-o", "none", "--set", "start.settling_time=20us", "--set", "start.ramp_time=10us"};
    for (const auto& words : {Words{"--isa", "baseline", "run", "tiny"}, {"run", "tiny", "--isa", "baseline"}}) {
        const Outcome outcome = run(words + brief);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_THAT(outcome.out, HasSubstr("kernels             baseline"));
    }
    const Outcome unknown = run({"run", "tiny", "--isa", "sse9"});
    EXPECT_EQ(unknown.status, 2);
    EXPECT_THAT(unknown.err, HasSubstr("instruction set \"sse9\" is unknown"));
}

TEST_F(Commands, ListEveryRowOfTheCatalogues) {
    EXPECT_THAT(run({"list"}).out, AllOf(HasSubstr("\n  methods "), HasSubstr("\n  licenses ")));
    const std::string methods = run({"list", "methods", "--all"}).out, channels = run({"list", "channels"}).out,
                      keys = run({"list", "keys"}).out;
    for (const engine::StagePlan& plan : engine::methods()) EXPECT_THAT(methods, HasSubstr("\n" + plan.name + " "));
    for (const tasks::Channel& channel : tasks::channels()) EXPECT_THAT(channels, HasSubstr("\n" + std::string(channel.name) + " "));
    for (const tasks::Parameter& parameter : tasks::parameter_table())
        EXPECT_THAT(keys, HasSubstr("\n" + std::string(parameter.key) + " "));
    const std::string detail = run({"list", "detail"}).out;
    for (const tasks::DetailPreset& preset : tasks::detail_presets()) EXPECT_THAT(detail, HasSubstr("\n" + std::string(preset.name) + " "));
    EXPECT_THAT(run({"list", "scenes"}).out, AllOf(HasSubstr("\nbaseline "), HasSubstr("\ntiny ")));
    EXPECT_THAT(run({"list", "executors", "units"}).out, AllOf(HasSubstr("\nserial "), HasSubstr("\na torque ")));
}

TEST_F(Commands, ListTheMethodsThatOneWouldUse) {
    std::istringstream list(run({"list", "methods"}).out);
    std::vector<std::string> names;
    for (std::string line; std::getline(list, line) && !line.empty();) names.push_back(line.substr(0, line.find(' ')));
    ASSERT_EQ(names.size(), 9u) << "a heading, a rule and seven methods";
    EXPECT_EQ(names[2], tasks::Scene().run.method) << "the default is the first";
    for (std::size_t k = 3; k < names.size(); ++k) EXPECT_THAT(tasks::method_names(), testing::Contains(names[k]));
}

TEST_F(Commands, ListAllMethodsWithStagesAndOrder) {
    EXPECT_THAT(run({"list", "methods", "--all"}).out, testing::ContainsRegex("\nrk4 +4 +4 +[a-z]"));
}

TEST_F(Commands, ExplainKeysAndSections) {
    const Outcome key = run({"explain", "tip.radius"});
    EXPECT_THAT(key.out, StartsWith("tip.radius\n"));
    EXPECT_THAT(run({"explain", "tip"}).out, AllOf(HasSubstr("tip.radius\n"), HasSubstr("tip.angle\n")));
}

/// Section joint and term joint: keys come first. Words of several keys' names stay errors with suggestions.
TEST_F(Commands, ExplainTermsChannelsAndNotes) {
    EXPECT_THAT(run({"explain", "creep"}).out, HasSubstr("creep\n  Sliding of tips that a chain which holds"));
    EXPECT_THAT(run({"explain", "thrust ratio"}).out, HasSubstr("S_1/S_2"));
    EXPECT_THAT(run({"explain", "friction_slip"}).out, HasSubstr("\n  channel of records; unit: 1\n"));
    EXPECT_THAT(run({"explain", "target_missed"}).out, HasSubstr("\n  note of runs and cases\n"));
    EXPECT_THAT(run({"explain", "joint"}).out, HasSubstr("joint.friction_coefficient\n"));
    EXPECT_THAT(run({"explain", "palmgren"}).out, StartsWith("joint.law\n")) << "a value";
    EXPECT_THAT(run({"explain", "safety"}).out, StartsWith("safety factor\n"));
    EXPECT_EQ(run({"explain", "pin_period"}).out, run({"explain", "pin period"}).out);
    for (const char* word : {"settle", "steady", "not_steady", "archard", "rainflow"})
        EXPECT_THAT(run({"explain", word}).out, StartsWith(std::string(word) + "\n  "));
}

TEST_F(Commands, ExplainEveryWordAndThenNameTheUnknownOnes) {
    const Outcome some = run({"explain", "creep", "chain.pich", "tip.radius", "hogshead"});
    EXPECT_EQ(some.status, 1);
    EXPECT_EQ(some.out, run({"explain", "creep"}).out + "\n" + run({"explain", "tip.radius"}).out);
    EXPECT_THAT(some.err,
                AllOf(HasSubstr("chain.pich: unknown key (did you mean \"chain.pitch\"?)\n"), HasSubstr("hogshead: unknown key")));
}

TEST_F(Commands, ListTermsAsTheGlossaryDoes) {
    std::ifstream file(CVTFLOW_SOURCE_DIR "/docs/glossary.md");
    const std::string page{std::istreambuf_iterator<char>(file), {}};
    const std::string listed = run({"list", "terms"}).out;
    std::size_t rows = 0;
    for (const Term& term : terms) {
        EXPECT_THAT(page, HasSubstr(fmt::format("\n| {} | {} |\n", term.word, term.meaning)));
        EXPECT_THAT(listed, HasSubstr(std::string(term.word)));
    }
    for (std::size_t at = page.find("\n| "); at != std::string::npos; at = page.find("\n| ", at + 1)) ++rows;
    EXPECT_EQ(rows, std::size(terms) + 1) << "and a heading";
}

TEST_F(Commands, ExplainReportsWhatAKeyIsInASceneAndHowFarItsStepIsStable) {
    const std::string clamping = run({"explain", "chain.pins", "--scene", "tiny"}).out;
    EXPECT_THAT(clamping, HasSubstr("here:     24 in tiny"));
    const std::string step = run({"explain", "run.step", "--scene", "baseline", "--set", "run.method=leapfrog-chebyshev"}).out;
    EXPECT_THAT(step, AllOf(HasSubstr("stable:   baseline with leapfrog-chebyshev up to 1."), HasSubstr("auto:     1.")));
    EXPECT_THAT(run({"explain", "run.step", "--scene", "baseline", "--set", "run.step=3us"}).out, HasSubstr("run.step exceeds this limit"));
}

TEST_F(Commands, SchemaIsJson) {
    const auto schema = nlohmann::json::parse(run({"schema"}).out);
    EXPECT_TRUE(schema["properties"].contains("chain"));
}

TEST_F(Commands, CheckReportsWhatASceneIs) {
    const Outcome outcome = run({"check", "tiny", "--step", "50 ns"});
    EXPECT_EQ(outcome.status, 0);
    // Order 1: 4 (1 + 1) + 4 coordinates per link.
    EXPECT_THAT(outcome.out, HasSubstr("516 coordinates (24 links x 20 + pulleys 36), 1 032 unknowns\n"));
    EXPECT_THAT(outcome.out, HasSubstr("geometric at ratio 1, settles for 10 ms\n"));
    EXPECT_THAT(outcome.out, HasSubstr("20 000 + 200 000 for settling\n"));  // (1 + 10) ms of 50 ns
    EXPECT_THAT(outcome.out, HasSubstr("880 000, plus transitions\n"));
    EXPECT_THAT(outcome.out, HasSubstr("\n  schedule            auto, segments chosen automatically\n"));
    EXPECT_THAT(outcome.out, testing::ContainsRegex("states? every [^\n]*, up to [0-9.]+ [kM]?B\n"));
    EXPECT_THAT(outcome.out, testing::ContainsRegex("\n  time                about [0-9:.]+( s)? on one thread"));
    EXPECT_THAT(run({"check", "tiny", "--set", "run.segments=3"}).out, HasSubstr("\n  schedule            auto, 3 segments\n"));
}

// Tips brake the spin of sheaves by impulses that a leapfrog takes from the step's start; damping of tips is explicit as well. Neither is
// in the test equation that automatic steps come from, both are in the linearised step.
TEST_F(Commands, ARunReportsWhereTheAutomaticStepDoesNotHold) {
    for (const char* setting : {"pulley.sheave_polar_inertia=1.5e-4", "tip.reference_depth=1e-7"}) {
        const Outcome outcome =
            run({"run", "baseline", "--method", "leapfrog-chebyshev", "--set", setting, "--until", "2 ms", "-q", "-o", "none"});
        EXPECT_EQ(outcome.status, 6) << setting;
        EXPECT_THAT(outcome.err, HasSubstr("run.step = \"auto\" is too long here; use ")) << setting;
    }
}

TEST_F(Commands, CheckReportsUpToWhereASettledSceneIsStable) {
    const Outcome beyond = run({"check", "control", "--method", "leapfrog-chebyshev", "--step", "2 us"});
    EXPECT_EQ(beyond.status, 0) << beyond.err;
    EXPECT_THAT(beyond.out,
                testing::ContainsRegex("\n  stable to +1\\.[5-9][0-9]* us \\(oscillation of .* kHz\\); run.step exceeds this limit\n"));
    for (const char* step : {"1.8 us", "auto"})
        EXPECT_THAT(run({"check", "control", "--step", step}).out, testing::Not(HasSubstr(" exceeds this limit")));
#ifdef CVTFLOW_LAB
    EXPECT_THAT(run({"check", "control", "--method", "trapezoidal-once"}).out,
                testing::ContainsRegex("\n  stable to +linear stability sets no limit\n"));
#endif
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
    EXPECT_THAT(
        text, AllOf(StartsWith("s.h5: state, "), HasSubstr("\n  time                0 s\n"), HasSubstr("\n  unknowns            1 032\n")));
    EXPECT_THAT(text, AllOf(HasSubstr("\n  state hash "), HasSubstr("\n  settled with        scene tiny, 24 pins\n"),
                            HasSubstr(" 20 us of settling\n")));
}

// The manual page and the completions, made by the build (tools/documents/manual) of the program's help.

/// A text as in a manual page.
std::string hyphenated(std::string text) {
    for (std::size_t at = text.find('-'); at != std::string::npos; at = text.find('-', at + 2)) text.insert(at, "\\");
    return text;
}

class Manual : public Program {
protected:
    /// Output of a shell command in the test's folder, which must succeed.
    std::string output_of(const std::string& command) const {
        std::FILE* pipe = popen(("cd '" + folder_.string() + "' && " + command).c_str(), "r");
        std::string output;
        std::array<char, 4096> buffer;
        while (const std::size_t size = std::fread(buffer.data(), 1, buffer.size(), pipe)) output.append(buffer.data(), size);
        EXPECT_EQ(pclose(pipe), 0) << command;
        return output;
    }
    /// A file of the build's manual (target cvtflow_manual, cvtflow-lab_manual).
    std::string made(const std::string& kind, const std::string& program = "cvtflow") const {
        const std::map<std::string, std::string> files{
            {"man", program + ".1"}, {"bash", program}, {"zsh", "_" + program}, {"fish", program + ".fish"}};
        return read(std::filesystem::path(CVTFLOW_PROGRAM).parent_path() / "manual" / kind / files.at(kind));
    }
};

TEST_F(Manual, EveryKindKnowsEveryCommand) {
    std::vector<std::string> programs{CVTFLOW_PROGRAM};
#ifdef CVTFLOW_LAB
    programs.emplace_back(CVTFLOW_LAB);
#endif
    for (const std::string& path : programs) {
        const std::vector<std::string> all = commands_of(path);
        ASSERT_GE(all.size(), 10u);
        const std::string program = path.substr(path.rfind('/') + 1), page = made("man", program), bash = made("bash", program),
                          zsh = made("zsh", program), fish = made("fish", program);
        for (const std::string& name : all) {
            EXPECT_THAT(page, HasSubstr(hyphenated("Usage: " + program + " " + name))) << name;
            EXPECT_THAT(bash, HasSubstr("        " + name + ") words='")) << name;
            EXPECT_THAT(zsh, HasSubstr("\n    " + name + ") _arguments")) << name;
            EXPECT_THAT(fish, HasSubstr("-a '" + name + "' -d ")) << name;
        }
    }
}

TEST_F(Manual, CompletionsKnowOptionsOfTheirCommand) {
    EXPECT_THAT(made("bash"), testing::ContainsRegex("        run\\) words='[^']*--checkpoint-every [^']*--until "));
    EXPECT_THAT(made("fish"), AllOf(HasSubstr("__fish_seen_subcommand_from run' -l 'until' "),
                                    HasSubstr("__fish_seen_subcommand_from batch' -l 'dry-run' ")));
}

TEST_F(Manual, BashCompletesCommandsOptionsAndNamesOfTheCatalogues) {
    write("completions", made("bash"));
    const std::string path = std::string(CVTFLOW_PROGRAM).substr(0, std::string(CVTFLOW_PROGRAM).rfind('/'));
    const auto complete = [&](const std::string& words, int at) {
        return output_of("PATH='" + path + "':$PATH bash -c '. ./completions; COMP_WORDS=(" + words +
                         "); COMP_CWORD=" + std::to_string(at) + "; _cvtflow; echo \"${COMPREPLY[@]}\"'");
    };
    EXPECT_EQ(complete("cvtflow che", 1), "check\n");
    EXPECT_EQ(complete("cvtflow run --unt", 2), "--until\n");
    EXPECT_THAT(complete("cvtflow run bas", 2), HasSubstr("baseline"));
    EXPECT_THAT(complete("cvtflow run tiny --method leapfrog-ch", 4), HasSubstr("leapfrog-chebyshev"));
    EXPECT_EQ(complete("cvtflow explain tip.rad", 2), "tip.radius\n");
}

#ifdef CVTFLOW_LAB
TEST_F(Manual, BashCompletesCommandsOfTheLaboratory) {
    write("completions", made("bash", "cvtflow-lab"));
    EXPECT_EQ(output_of("bash -c '. ./completions; COMP_WORDS=(cvtflow-lab granu); COMP_CWORD=1; _cvtflow_lab; echo \"${COMPREPLY[@]}\"'"),
              "granularity\n");
}
#endif

TEST_F(Manual, AnUnknownKindIsAnErrorOfUsage) {
    EXPECT_EQ(output_of("{ '" CVTFLOW_SOURCE_DIR "/tools/documents/manual' html x 2>/dev/null; echo $?; }"), "2\n");
}

}  // namespace
}  // namespace cvtflow::tools
