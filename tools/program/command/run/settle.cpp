#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "tasks/run/run.hpp"
#include "tools/program/arguments/scene_arguments.hpp"
#include "tools/program/command/command.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output/interrupt.hpp"
#include "tools/program/output/outputs.hpp"
#include "tools/program/output/progress.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

namespace {

struct SettleArguments {
    SceneArguments scene;
    std::string output;
    bool force = false, quiet = false;
};

double simulate(const SettleArguments& arguments, const tasks::Scene& scene, const engine::Permit& file) {
    ProgressDisplay display(progress_style(arguments.quiet), 0.0);
    tasks::RunOptions options;
    options.cancel = &catch_interrupts();
    options.progress = [&display](const tasks::Progress& progress) { display.show(progress); };
    return tasks::settle_scene(scene, file, options);
}

ExitStatus settle(SettleArguments& arguments) {
    arguments.scene.settle = true;
    const tasks::Scene scene = load_scene(arguments.scene).scene;
    const std::string file = arguments.output.empty() ? scene.path.stem().string() + "_state.h5" : arguments.output;
    const model::Start& start = scene.parameters.start;
    if (start.layout != model::StartLayout::belt || start.settling_time <= 0.0) {
        throw tasks::SceneError(fmt::format("{}: nothing to settle: start.layout is \"ring\" or start.settling_time is 0", scene.name));
    }
    const engine::Permit permit(file, state_rule(scene, !arguments.output.empty(), arguments.force));  // before settling, not after it
    if (!permit.notice().empty() && !arguments.quiet) print_error(permit.notice());
    const double suspicion = simulate(arguments, scene, permit);
    const ExitStatus status = suspicion <= 1.0 ? ExitStatus::finished : ExitStatus::unreliable;
    if (status == ExitStatus::unreliable) {
        print_error(
            fmt::format("{}: unreliable: the residual of the energy balance is {:.2g} times the tolerance; runs from this state "
                        "will be reported as unreliable",
                        scene.name, suspicion));
    }
    if (arguments.quiet) return status;
    fmt::print("{}: settled for {}\n{}", scene.name, time_text(start.settling_time), field("state file", file));
    fmt::print("{}", field("usage", fmt::format("state = \"{}\" in [start] of the scene, or --set start.state={}",
                                                std::filesystem::path(file).filename().string(), file)));
    return status;
}

}  // namespace

Action declare_settle(CLI::App& app) {
    const auto arguments = std::make_shared<SettleArguments>();
    declare_scene(app, arguments->scene);
    app.add_option("-o,--output", arguments->output,
                   "State file to write; must not exist (default: SCENE_state.h5, replaced with a notice)")
        ->type_name("STATE.h5");
    app.add_flag("--force", arguments->force, force_meaning);
    declare_shortcut(app, arguments->scene, "--time", "start.settling_time", "TIME");
    declare_shortcut(app, arguments->scene, "--method", "run.method", "NAME");
    declare_shortcut(app, arguments->scene, "--step", "run.step", "TIME");
    declare_shortcut(app, arguments->scene, "--threads", "run.threads", "N");
    app.add_flag("-q,--quiet", arguments->quiet, "Print errors only");
    app.footer(
        "A path in start.state is relative to the folder of the scene file; with --set start.state to the working directory.\n"
        "Exit status as for run.");
    return [arguments] { return settle(*arguments); };
}

}  // namespace cvtflow::tools
