/// ARCHITECTURE shows the graphs that steps run (the other pages: *_test.py).

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

namespace cvtflow::docs {
namespace {

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
    std::ifstream file(CVTFLOW_SOURCE_DIR "/ARCHITECTURE.md");
    const std::string shown{std::istreambuf_iterator<char>(file), {}};
    constexpr int segments = 2, passes = 3;  // two sweeps
    const std::set<std::string> halves = tasks_of_step("fine", segments, segments * passes), rigid = tasks_of_step("rigid", 1, 0);
    EXPECT_EQ(halves.size(), segments * (1 + passes));
    EXPECT_THAT(rigid, testing::UnorderedElementsAre("links", "plates", "tips", "kick"));
    for (const std::string& task : halves) EXPECT_THAT(shown, testing::HasSubstr(" " + task + "  ")) << task;
    for (const std::string& task : rigid) EXPECT_THAT(shown, testing::HasSubstr(" " + task + "  ")) << task;
}

}  // namespace
}  // namespace cvtflow::docs
