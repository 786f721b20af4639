#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "bench/lab/command/command.hpp"
#include "bench/lab/show.hpp"
#include "bench/study/profile/counted_work.hpp"
#include "engine/base/provenance.hpp"
#include "model/kernels/available_isas.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

struct WorkArguments {
    SceneArguments scene;
    OutputArguments output;
    std::vector<int> segments;
    bool quiet = false;
};

/// Rows of work.csv and stages.csv.
Json work_json(const tasks::Scene& scene, const CountedWork& counted) {
    const std::string method = tasks::method_of(scene), kernels(model::name_of(model::chosen_isa()));
    const std::string commit = engine::current_provenance().commit;
    Json rows = Json::array(), stages = Json::array();
    for (const WorkRow& row : counted.rows)
        rows.push_back(named(
            "scene,method,kernels,threads,links,even,segments,instructions,fixed,claimed,claimed_segments,step_fixed,step_claimed,commit",
            {scene.name, method, kernels, row.threads, row.links, row.even, row.segments, row.longest, row.fixed, row.claimed,
             row.claimed_segments, row.step_fixed, row.step_claimed, commit}));
    double all = 0.0;
    for (const StageWork& stage : counted.stages) all += stage.instructions;
    for (const StageWork& stage : counted.stages)
        stages.push_back(
            named("scene,method,kernels,step_s,stage,instructions,share,commit",
                  {scene.name, method, kernels, counted.step, stage.stage, stage.instructions, stage.instructions / all, commit}));
    return {{"rows", std::move(rows)}, {"stages", std::move(stages)}};
}

ExitStatus work(const WorkArguments& arguments) {
    const LoadedScene loaded = load_scene(arguments.scene);
    const tasks::Scene& scene = loaded.scene;
    const auto progress = [&](const std::string& line) { say(arguments.quiet, line); };
    progress(loaded.notice);
    const int links = scene.parameters.chain.pins;
    std::vector<int> segments = arguments.segments.empty() ? shortening_segments(links) : arguments.segments;
    segments.push_back(1);
    std::sort(segments.begin(), segments.end());
    segments.erase(std::unique(segments.begin(), segments.end()), segments.end());
    if (segments.back() > links) throw UsageError(fmt::format("--segments {}: the chain has {} links", segments.back(), links));
    show("work", work_json(scene, count_work(scene, segments, progress)), arguments.output);
}

constexpr const char* work_explanation =
    "Every task is counted in a child process, with a trap after every instruction, inside a step that begins 0.5 ms or more after the\n"
    "start, and as often as it runs in a step.\n"
    "instructions: of the slowest thread, per step. fixed, claimed: speed-ups of tasks that have others beside them on their level; a\n"
    "segment per thread, or threads that claim tasks of the best counted number of segments. step: the same of all tasks, those alone on\n"
    "their level included. The controller is not a task. Synchronisation takes no time here.\n"
    "Example: cvtflow-lab work baseline --method rk4 --step \"45 ns\" -o results/work";

}  // namespace

Action declare_work(CLI::App& app) {
    const auto arguments = std::make_shared<WorkArguments>();
    declare_scene(app, arguments->scene);
    declare_shortcut(app, arguments->scene, "--method", "run.method", "NAME");
    declare_shortcut(app, arguments->scene, "--step", "run.step", "TIME");
    app.add_option("--segments", arguments->segments, "Numbers of segments to count (default: those that shorten the longest one)")
        ->type_name("LIST")
        ->delimiter(',')
        ->check(CLI::Range(1, 100000));
    declare_output(app, arguments->output);
    app.add_flag("-q,--quiet", arguments->quiet, "No progress");
    app.footer(work_explanation);
    return [arguments] { return work(*arguments); };
}

}  // namespace cvtflow::bench
