#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <memory>

#include "engine/graph/dot.hpp"
#include "tasks/method_choice.hpp"
#include "tasks/step_graph.hpp"
#include "tools/command.hpp"
#include "tools/scene_arguments.hpp"

namespace cvtflow::tools {

namespace {

/// In the order of tasks::Cycle.
const std::vector<std::string> cycles{"evaluate", "detect", "locate", "truncate"};

struct DotArguments {
    SceneArguments scene;
    std::string cycle = "evaluate";
};

ExitStatus dot(const DotArguments& arguments) {
    const tasks::Scene scene = load_scene(arguments.scene).scene;
    const tasks::Workspace workspace(scene.parameters, *tasks::plan_for(scene.run.method),
                                     tasks::Partition::equal(scene.parameters.chain.pins, std::max(1, scene.run.segments)));
    const auto cycle = std::find(cycles.begin(), cycles.end(), arguments.cycle) - cycles.begin();
    fmt::print("{}", engine::to_dot(tasks::step_graph(workspace, {.kind = scene.run.assembly}), static_cast<int>(cycle)));
    return ExitStatus::finished;
}

}  // namespace

Action declare_dot(CLI::App& app) {
    const auto arguments = std::make_shared<DotArguments>();
    arguments->scene.settle = true;  // the start does not matter
    declare_scene(app, arguments->scene);
    declare_shortcut(app, arguments->scene, "--segments", "run.segments", "N");
    app.add_option("--cycle", arguments->cycle, "Cycle to draw: evaluate, detect, locate or truncate")
        ->type_name("NAME")
        ->check(CLI::IsMember(cycles))
        ->capture_default_str();
    app.footer("Example: cvtflow dot tiny --segments 3 | dot -Tsvg > step.svg");
    return [arguments] { return dot(*arguments); };
}

}  // namespace cvtflow::tools
