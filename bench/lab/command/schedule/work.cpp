#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "bench/lab/command/command.hpp"
#include "bench/lab/plot/plot.hpp"
#include "bench/study/profile/counted_work.hpp"
#include "engine/base/provenance.hpp"
#include "model/kernels/available_isas.hpp"
#include "tasks/scene/csv.hpp"
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

std::string work_table(const std::vector<WorkRow>& rows) {
    const auto right = [](const char* heading) { return Table::Column{heading, Align::right}; };
    Table table({right("M"), right("links"), right("N/N_max"), right("segments"), right("instructions"), right("fixed"), right("claimed"),
                 right("of segments"), right("step fixed"), right("step claimed")});
    for (const WorkRow& row : rows) {
        if (row.threads != row.segments) continue;  // as fast as the row above
        table.add({fmt::format("{}", row.threads), fmt::format("{}", row.links), fmt::format("{:.2f}", row.even),
                   fmt::format("{}", row.segments), fmt::format("{:.0f}", row.longest), fmt::format("{:.2f}", row.fixed),
                   fmt::format("{:.2f}", row.claimed), fmt::format("{}", row.claimed_segments), fmt::format("{:.2f}", row.step_fixed),
                   fmt::format("{:.2f}", row.step_claimed)});
    }
    return table.text(2);
}

std::string work_csv(const tasks::Scene& scene, const std::vector<WorkRow>& rows, const std::string& kernels) {
    std::string text =
        "scene,method,kernels,threads,links,even,segments,instructions,fixed,claimed,claimed_segments,step_fixed,step_claimed,commit\n";
    for (const WorkRow& row : rows) {
        text += fmt::format("{},{},{},{},{},{:.4f},{},{:.0f},{:.4f},{:.4f},{},{:.4f},{:.4f},{}\n", tasks::csv_cell(scene.name, true),
                            tasks::method_of(scene), kernels, row.threads, row.links, row.even, row.segments, row.longest, row.fixed,
                            row.claimed, row.claimed_segments, row.step_fixed, row.step_claimed, engine::current_provenance().commit);
    }
    return text;
}

double all_instructions(const CountedWork& counted) {
    double sum = 0.0;
    for (const StageWork& stage : counted.stages) sum += stage.instructions;
    return sum;
}

std::string stages_table(const CountedWork& counted) {
    Table table({{"stage"}, {"instructions", Align::right}, {"share", Align::right}});
    for (const StageWork& stage : counted.stages) {
        table.add({stage.stage, fmt::format("{:.0f}", stage.instructions),
                   fmt::format("{:.1f} %", 100.0 * stage.instructions / all_instructions(counted))});
    }
    return table.text(2);
}

std::string stages_csv(const tasks::Scene& scene, const CountedWork& counted, const std::string& kernels) {
    std::string text = "scene,method,kernels,step_s,stage,instructions,share,commit\n";
    for (const StageWork& stage : counted.stages) {
        text += fmt::format("{},{},{},{:.6g},{},{:.0f},{:.5f},{}\n", tasks::csv_cell(scene.name, true), tasks::method_of(scene), kernels,
                            counted.step, stage.stage, stage.instructions, stage.instructions / all_instructions(counted),
                            engine::current_provenance().commit);
    }
    return text;
}

Plot work_plot(const tasks::Scene& scene, const std::vector<WorkRow>& rows, const std::string& kernels) {
    Plot plot;
    plot.title = fmt::format("Speed-up of {} by counted instructions", scene.name);
    plot.subtitle = fmt::format("{}, kernels {}; nothing but the work of tasks takes time", tasks::method_of(scene), kernels);
    plot.x = {"threads", Scale::linear, 1.0, 0.0, {}};
    plot.y = {"speed-up", Scale::linear, 1.0, 0.0, {}};
    Series even{"whole links: N / N_max(M)", {}, Mark::none, Line::dashed, "#999999"},
        fixed{"parallel tasks, a segment per thread", {}, Mark::small_dot, Line::solid, ""},
        claimed{"parallel tasks, claimed", {}, Mark::small_dot, Line::solid, ""},
        step{"all tasks, claimed", {}, Mark::none, Line::solid, ""};
    for (const WorkRow& row : rows) {
        even.points.push_back({static_cast<double>(row.threads), row.even});
        fixed.points.push_back({static_cast<double>(row.threads), row.fixed});
        claimed.points.push_back({static_cast<double>(row.threads), row.claimed});
        step.points.push_back({static_cast<double>(row.threads), row.step_claimed});
    }
    plot.series = {std::move(even), std::move(fixed), std::move(claimed), std::move(step)};
    return plot;
}

ExitStatus work(const WorkArguments& arguments) {
    const LoadedScene loaded = load_scene(arguments.scene);
    const tasks::Scene& scene = loaded.scene;
    const auto progress = [&](const std::string& line) {
        if (!arguments.quiet && !line.empty()) print_error(line);
    };
    progress(loaded.notice);
    const int links = scene.parameters.chain.pins;
    std::vector<int> segments = arguments.segments.empty() ? shortening_segments(links) : arguments.segments;
    segments.push_back(1);
    std::sort(segments.begin(), segments.end());
    segments.erase(std::unique(segments.begin(), segments.end()), segments.end());
    if (segments.back() > links) throw UsageError(fmt::format("--segments {}: the chain has {} links", segments.back(), links));
    const CountedWork counted = count_work(scene, segments, progress);
    const std::vector<WorkRow>& rows = counted.rows;
    const std::string kernels(model::name_of(model::chosen_isa()));
    OutputFolder folder(arguments.output);
    folder.write("work.csv", work_csv(scene, rows, kernels));
    folder.write("stages.csv", stages_csv(scene, counted, kernels));
    folder.write("work.svg", svg(work_plot(scene, rows, kernels)));
    fmt::print("{}: work of a step of {}, {} long, kernels {}\n{}", scene.name, tasks::method_of(scene), time_text(counted.step), kernels,
               stages_table(counted));
    fmt::print("\n{}{}", work_table(rows), folder.written());
    return ExitStatus::finished;
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
