#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "bench/lab/command/command.hpp"
#include "tasks/method/method.hpp"
#include "tasks/step/step_graph.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/guard.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

/// Cycles of every step, in the order of tasks::Cycle.
const std::vector<std::string> common_cycles{"evaluate", "detect", "locate", "truncate"};

struct DotArguments {
    SceneArguments scene;
    std::string cycle = "evaluate";
};

/// Names of a graph's cycles: those of every step, and those of the method, named by one of their tasks.
std::vector<std::pair<std::string, int>> cycles_of(const engine::TaskGraph& graph) {
    std::vector<std::pair<std::string, int>> cycles;
    for (std::size_t k = 0; k < common_cycles.size(); ++k) cycles.emplace_back(common_cycles[k], static_cast<int>(k));
    for (int task = 0; task < graph.size(); ++task) {
        const std::pair<std::string, int> named{graph.task(task).stem(), graph.task(task).cycle};
        const auto same = [&](const auto& cycle) { return cycle.first == named.first; };
        if (named.second >= tasks::method_cycles && std::none_of(cycles.begin(), cycles.end(), same)) cycles.push_back(named);
    }
    return cycles;
}

int cycle_named(const engine::TaskGraph& graph, const std::string& name, const std::string& method) {
    std::vector<std::string> names;
    for (const auto& [known, cycle] : cycles_of(graph)) {
        if (known == name) return cycle;
        names.push_back(known);
    }
    throw UsageError(fmt::format("--cycle {}: a step of {} has {}", name, method, fmt::join(names, ", ")));
}

std::string quoted(const std::string& text) {
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') result += '\\';
        result += c;
    }
    return result + '"';
}

/// One cycle of a frozen graph, levels from left to right.
std::string to_dot(const engine::TaskGraph& graph, int cycle) {
    std::string text = fmt::format("digraph cycle_{} {{\n    rankdir=LR;\n    node [shape=box];\n", cycle);
    for (int level = 0; level < graph.levels(cycle); ++level) {
        text += "    { rank=same;";
        for (const int task : graph.level(cycle, level)) text += fmt::format(" t{} [label={}];", task, quoted(graph.task(task).name));
        text += " }\n";
    }
    for (const int task : graph.topological(cycle)) {
        for (const int after : graph.successors(task)) text += fmt::format("    t{} -> t{};\n", task, after);
    }
    return text + "}\n";
}

ExitStatus dot(const DotArguments& arguments) {
    const tasks::Scene scene = load_scene(arguments.scene).scene;
    const tasks::Method chosen = tasks::method_of(scene);
    tasks::Workspace workspace(scene.parameters, chosen.plan(),
                               tasks::Partition::equal(scene.parameters.chain.pins, std::max(1, scene.run.segments)));
    const std::unique_ptr<tasks::StepMethod> method = chosen.make(workspace);
    const engine::TaskGraph graph = tasks::step_graph(workspace, {.kind = scene.run.assembly}, method.get());
    fmt::print("{}", to_dot(graph, cycle_named(graph, arguments.cycle, chosen.name())));
    return ExitStatus::finished;
}

}  // namespace

Action declare_dot(CLI::App& app) {
    const auto arguments = std::make_shared<DotArguments>();
    arguments->scene.settle = true;  // the start does not matter
    declare_scene(app, arguments->scene);
    declare_shortcut(app, arguments->scene, "--segments", "run.segments", "N");
    declare_shortcut(app, arguments->scene, "--method", "run.method", "NAME");
    app.add_option("--cycle", arguments->cycle,
                   "Cycle to draw: evaluate, detect, locate, truncate, or one of the method's, named by a task in it")
        ->type_name("NAME")
        ->capture_default_str();
    app.footer("Example: cvtflow-lab dot tiny --segments 3 | dot -Tsvg > step.svg");
    return [arguments] { return dot(*arguments); };
}

}  // namespace cvtflow::bench
