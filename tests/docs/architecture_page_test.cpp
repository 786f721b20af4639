/// ARCHITECTURE shows steps as they stand in the source, and the graphs that they run.

#include <gmock/gmock.h>

#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include "tasks/method/method.hpp"
#include "tasks/scene/ready_scenes.hpp"
#include "tasks/scene/scene.hpp"
#include "tasks/step/step_graph.hpp"
#include "tasks/step/step_method.hpp"
#include "tests/docs/page_fixture.hpp"

namespace cvtflow::docs {
namespace {

/// A function as an indented block of Markdown.
std::string as_block(const std::string& file, const std::string& signature) {
    std::ifstream source(CVTFLOW_SOURCE_DIR "/" + file);
    const std::string text{std::istreambuf_iterator<char>(source), {}};
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
    EXPECT_THAT(shown,
                testing::HasSubstr(as_block("tasks/method/friction/sweep_leapfrog.cpp", "CycleSequence SweepLeapfrog<Number>::step() {")));
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
    constexpr int segments = 2, passes = 4;  // three sweeps
    const std::set<std::string> halves = tasks_of_step("fine", segments, segments * passes), rigid = tasks_of_step("rigid", 1, 0);
    EXPECT_EQ(halves.size(), segments * (1 + passes));
    EXPECT_THAT(rigid, testing::UnorderedElementsAre("links", "plates", "tips", "kick"));
    for (const std::string& task : halves) EXPECT_THAT(shown, testing::HasSubstr(" " + task + "  ")) << task;
    for (const std::string& task : rigid) EXPECT_THAT(shown, testing::HasSubstr(" " + task + "  ")) << task;
}

}  // namespace
}  // namespace cvtflow::docs
