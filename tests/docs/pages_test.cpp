/// Pages agree with what they describe: exit statuses and keys of sweeps with the program, steps and graphs with the source, speeds with
/// their committed table.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tasks/batch/sweep/sweep_keys.hpp"
#include "tasks/method/method.hpp"
#include "tasks/scene/ready_scenes.hpp"
#include "tasks/scene/scene.hpp"
#include "tasks/step/step_graph.hpp"
#include "tasks/step/step_method.hpp"
#include "tests/docs/page_fixture.hpp"
#include "tools/program/guard.hpp"

namespace cvtflow::docs {
namespace {

// The page of exit statuses has the rows of the program's help.

TEST(ExitStatusPage, HasARowForEveryStatusOfTheHelp) {
    const std::string text = page("docs/exit_status.md").text;
    std::istringstream help{std::string(tools::exit_status_table)};
    std::size_t rows = 0;
    for (std::string line; std::getline(help, line);) {
        std::smatch match;
        if (!std::regex_match(line, match, std::regex("  ([0-9]+) .*"))) continue;
        EXPECT_NE(text.find("\n| " + match[1].str() + " | "), std::string::npos) << line;
        ++rows;
    }
    EXPECT_GE(rows, 8u);
}

// The reference of sweeps is the program's.

TEST(SweepPage, HasARowForEveryKey) {
    const std::string text = page("docs/scene_reference.md").text, rows = text.substr(text.find("\n## Files of sweeps\n"));
    for (const tasks::SweepKey& row : tasks::sweep_keys()) {
        const std::string key = row.key().substr(std::string("sweep.").size());
        EXPECT_THAT(rows, testing::HasSubstr("\n| `" + key + "` | ")) << key;
    }
    EXPECT_THAT(page("docs/sweeps.md").links(), testing::Contains("scene_reference.md#files-of-sweeps"));
}

// ARCHITECTURE shows steps as they stand in the source, and the graphs that they run.

/// A function as an indented block of Markdown.
std::string as_block(const std::string& file, const std::string& signature) {
    const std::string text = text_of(CVTFLOW_SOURCE_DIR "/" + file);
    const std::size_t begin = text.find(signature), end = text.find("\n}\n", begin);
    EXPECT_NE(begin, std::string::npos) << file;
    std::string block = "    ";
    for (const char letter : text.substr(begin, end + 2 - begin)) {
        block += letter;
        if (letter == '\n') block += "    ";
    }
    return block + "\n";
}

TEST(ArchitecturePage, ShowsTheStepsAsTheyStandInTheSource) {
    const std::string shown = page("ARCHITECTURE.md").text;
    EXPECT_THAT(shown, testing::HasSubstr(as_block("tasks/method/friction/sweep_leapfrog.cpp", "CycleSequence SweepLeapfrog::step() {")));
    EXPECT_THAT(shown, testing::HasSubstr(as_block("tasks/method/friction/rigid_leapfrog.cpp", "CycleSequence RigidLeapfrog::step() {")));
}

/// Names of the tasks that `baseline` runs in a step at a level of detail: those of the method's cycles with as many rounds as a step has.
std::set<std::string> tasks_of_step(const std::string& level, int segments, std::size_t tasks_of_friction) {
    tasks::Scene scene = tasks::read_scene(tasks::find_scene("baseline"), tasks::StartState::ignored);
    tasks::apply_detail(scene, level);
    const tasks::Method method(tasks::resolved_method(tasks::automatic_method, scene.parameters));
    tasks::Workspace workspace(scene.parameters, method.plan(), tasks::Partition::equal(scene.parameters.chain.pins, segments));
    const auto step = method.make(workspace);
    const engine::TaskGraph graph = tasks::step_graph(workspace, {}, step.get());
    std::vector<std::vector<std::string>> cycles;
    for (int task = 0; task < graph.size(); ++task) {
        const auto cycle = static_cast<std::size_t>(graph.task(task).cycle);
        if (cycles.size() <= cycle) cycles.resize(cycle + 1);
        cycles[cycle].push_back(graph.task(task).name);
    }
    std::set<std::string> names;
    for (std::size_t cycle = tasks::method_cycles; cycle < cycles.size(); ++cycle) {
        const bool friction = cycles[cycle].front().starts_with("friction");
        if (!friction || cycles[cycle].size() == tasks_of_friction) names.insert(cycles[cycle].begin(), cycles[cycle].end());
    }
    return names;
}

TEST(ArchitecturePage, ShowsTheGraphsThatStepsRun) {
    const std::string shown = page("ARCHITECTURE.md").text;
    constexpr int segments = 2, passes = 3;  // two sweeps
    const std::set<std::string> halves = tasks_of_step("fine", segments, segments * passes), rigid = tasks_of_step("rigid", 1, 0);
    EXPECT_EQ(halves.size(), segments * (1 + passes));
    EXPECT_THAT(rigid, testing::UnorderedElementsAre("links", "plates", "tips", "kick"));
    for (const std::string& task : halves) EXPECT_THAT(shown, testing::HasSubstr(" " + task + "  ")) << task;
    for (const std::string& task : rigid) EXPECT_THAT(shown, testing::HasSubstr(" " + task + "  ")) << task;
}

// One page contains speeds (docs/speeds.md), drawn from a committed table; other pages link to it.

// The page of measured figures states which nights were run completely: those of the committed table.

TEST(MeasuredPage, HasTheNightsOfTheTable) {
    const std::string text = page("docs/laboratory/measured.md").text;
    std::istringstream table(text_of(CVTFLOW_SOURCE_DIR "/bench/results/nightly.csv"));
    for (std::string line; std::getline(table, line);) {
        const std::string cells = std::regex_replace(line, std::regex(","), " | ");
        EXPECT_NE(text.find("\n| " + cells + " |\n"), std::string::npos) << cells;
    }
}

// Every nightly suite belongs to one night.

TEST(Nights, HaveEverySuiteOnce) {
    std::multiset<std::string> listed;
    const std::string script = text_of(CVTFLOW_SOURCE_DIR "/.ci/run");
    static const std::regex list(R"(\n[a-z]+\+?='\|?(\w+(\|\w+)*)')"), word(R"(\w+)"), suite(R"(\nTEST(?:_[FP])?\(Nightly(\w+),)");
    for (std::sregex_iterator found(script.begin(), script.end(), list), end; found != end; ++found) {
        const std::string names = (*found)[1];
        for (std::sregex_iterator name(names.begin(), names.end(), word); name != end; ++name) listed.insert(name->str());
    }
    std::multiset<std::string> written;
    for (const auto& file : std::filesystem::recursive_directory_iterator(CVTFLOW_SOURCE_DIR "/tests")) {
        if (file.path().extension() != ".cpp") continue;
        const std::string text = text_of(file.path().string());
        std::set<std::string> suites;
        for (std::sregex_iterator found(text.begin(), text.end(), suite), end; found != end; ++found) suites.insert((*found)[1]);
        written.insert(suites.begin(), suites.end());
    }
    EXPECT_EQ(listed, written);
}

/// Seconds per simulated second of a row of bench/results/speeds.csv, by a regular expression for the fields before the median.
double seconds(const std::string& row) {
    const std::string table = text_of(CVTFLOW_SOURCE_DIR "/bench/results/speeds.csv");
    std::smatch found;
    if (!std::regex_search(table, found, std::regex("\n" + row + ",([0-9.]+),"))) ADD_FAILURE() << row;
    return found.empty() ? 0.0 : std::stod(found[1]);
}

/// Lines that state how fast the default is, or how long a simulated second takes.
std::vector<std::string> speeds(const Page& page) {
    static const std::regex factor(R"(\d+ (times (as fast|faster)|s/s)|\d+(\.\d+)? (s|seconds)( of processor time)? per simulated second)");
    static const std::regex column(R"(\|[^|]*(seconds per simulated second|faster than RK4)[^|]*\|)");
    static const std::regex share(R"((twentieth|thirtieth|nineteenth|eightieth) of (the cost|RK4|its time))");
    std::vector<std::string> found;
    for (const Line& line : page.text_lines())
        for (const std::regex* pattern : {&factor, &column, &share})
            if (std::regex_search(line.text, *pattern)) found.push_back(page.path + ":" + std::to_string(line.number) + ": " + line.text);
    return found;
}

/// Pages of reasons and of research compare methods of the laboratory and published figures with each other.
bool is_research(const std::string& path) {
    return path.starts_with("docs/decisions/") || path.starts_with("docs/laboratory/") || path == "docs/paper.md" || path == "CHANGELOG.md";
}

TEST(SpeedOfTheDefault, IsInTheReadmeAsInItsTable) {
    const std::string readme = page("README.md").text;
    std::smatch stated;
    ASSERT_TRUE(std::regex_search(readme, stated, std::regex(R"(\| default method and RK4 \(longest right step\) \| (\d+) times faster)")));
    const double ratio = seconds("method,`rk4` at 45 ns") / seconds("method,\"default [^\"]*\"");
    EXPECT_EQ(std::stol(stated[1]), std::lround(ratio));
}

TEST(PagesOfSpeed, AreDrawnFromTheCommittedTable) {
    EXPECT_EQ(std::system("python3 '" CVTFLOW_SOURCE_DIR "/tools/documents/speeds' --check"), 0);
}

TEST(PagesOfSpeed, AreNotRepeatedElsewhere) {
    for (const Page& each : pages()) {
        if (is_research(each.path) || each.path == "docs/speeds.md" || each.path == "README.md") continue;
        EXPECT_THAT(speeds(each), testing::IsEmpty());
    }
    EXPECT_THAT(speeds(page("README.md")), testing::SizeIs(1));
    EXPECT_THAT(speeds(page("docs/speeds.md")), testing::SizeIs(2));
}

TEST(PagesOfSpeed, AreRecognised) {
    const Page sample{"sample.md",
                      "It is 71 times faster.\nIt takes 1.4 s of processor time per simulated second.\n| `rk4` | 713 s/s |\n"
                      "| scene | seconds per simulated second |\na nineteenth of the cost\nThe summary contains seconds per "
                      "simulated second.\n\n```text\n71 times faster\n```\n"};
    EXPECT_THAT(speeds(sample), testing::SizeIs(5));
}

}  // namespace
}  // namespace cvtflow::docs
