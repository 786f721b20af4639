#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>

#include "engine/base/provenance.hpp"
#include "tasks/run/run.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/program.hpp"
#include "tools/program/progress.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

namespace {

struct RunArguments {
    SceneArguments scene;
    std::string output;
    std::optional<std::string> checkpoint_every;
    bool force = false, quiet = false;
};

/// Path of the record; empty: no record. Creates the folder only for the default path.
std::string record_path(const RunArguments& arguments, const tasks::Scene& scene) {
    if (arguments.output == "none") return {};
    if (!arguments.output.empty()) return arguments.output;
    return default_place(scene.path.stem().string() + ".h5");
}

/// Beside the record, or under the scene's name.
std::string checkpoint_path(const tasks::Scene& scene, const std::string& record) {
    return beside(record.empty() ? scene.path.stem().string() : record, ".checkpoint");
}

/// Checks the command line and the output paths before the work begins. A checkpoint beside the record belongs to a run that can be
/// resumed.
engine::OutputFile require_places(const RunArguments& arguments, const tasks::Scene& scene, const std::string& file) {
    const std::string checkpoint = checkpoint_path(scene, file);
    if (arguments.checkpoint_every) static_cast<void>(seconds_of("--checkpoint-every", *arguments.checkpoint_every));
    const bool kept = arguments.checkpoint_every || !file.empty();
    if (kept && !arguments.force) keep_checkpoint(checkpoint);
    engine::OutputFile record = output_file(file, !arguments.output.empty(), arguments.force);
    engine::require_place(record, input_files(scene));
    if (arguments.checkpoint_every) require_checkpoint_place(checkpoint, input_files(scene));
    if (kept && arguments.force) forget_checkpoint(checkpoint, input_files(scene));
    say(arguments.quiet, replacing(file));
    return record;
}

std::string record_text(const std::string& path) {
    if (path.empty()) return "none";
    std::error_code unknown;
    const auto bytes = std::filesystem::file_size(path, unknown);
    return unknown ? path : fmt::format("{} ({})", path, size_text(static_cast<double>(bytes)));
}

std::string machine_text() {
    const engine::Provenance here = engine::current_provenance();
    return field("machine", fmt::format("{}, {} cores", here.cpu, here.cores)) +
           field("program", fmt::format("cvtflow {} ({}), {} {}, {}", here.version, here.commit, here.compiler, here.build_type,
                                        here.instruction_set));
}

tasks::RunReport simulate(const RunArguments& arguments, const tasks::Scene& scene, const engine::OutputFile& file) {
    ProgressDisplay display(arguments.quiet, tasks::latest_end(scene));
    tasks::RunOptions options = display.options();
    options.file = file;
    if (arguments.checkpoint_every) {
        options.checkpoint_every = seconds_of("--checkpoint-every", *arguments.checkpoint_every);
        options.checkpoint = checkpoint_path(scene, file.path);
    }
    options.notice = [](const std::string& text) { print_error(text); };
    return tasks::run_scene(scene, options);
}

ExitStatus run(const RunArguments& arguments) {
    const LoadedScene loaded = load_scene(arguments.scene);
    say(arguments.quiet, loaded.notice);
    const std::string file = record_path(arguments, loaded.scene);
    const engine::OutputFile record = require_places(arguments, loaded.scene, file);
    const tasks::RunReport report = simulate(arguments, loaded.scene, record);
    if (!arguments.quiet) {
        fmt::print("{}: {}{}{}", loaded.scene.name, tasks::summary(report), machine_text(), field("record", record_text(file)));
    } else if (report.fault) {
        print_error(report.fault.message());
    } else if (!report.reliable()) {
        print_error(tasks::unreliable_text(report));
    } else if (report.whole.cycle_missed()) {
        print_error("cycle_missed: " + report.cycle_miss.text(report.whole));
    }
    return exit_status(report);
}

struct SettleArguments {
    SceneArguments scene;
    std::string output;
    bool force = false, quiet = false;
};

ExitStatus settle(SettleArguments& arguments) {
    arguments.scene.settle = true;
    const tasks::Scene scene = load_scene(arguments.scene).scene;
    const std::string file = arguments.output.empty() ? scene.path.stem().string() + ".state" : arguments.output;
    const model::Start& start = scene.parameters.start;
    if (start.layout != model::StartLayout::belt || start.settling_time <= 0.0) {
        throw tasks::SceneError(fmt::format("{}: nothing to settle: start.layout is \"ring\" or start.settling_time is 0", scene.name));
    }
    const engine::OutputFile state = output_file(file, !arguments.output.empty(), arguments.force);
    engine::require_place(state, input_files(scene));  // before settling, not after it
    say(arguments.quiet, replacing(file));
    const double balance_error_ratio = tasks::settle_scene(scene, state, ProgressDisplay(arguments.quiet, 0.0).options());
    const ExitStatus status = balance_error_ratio <= 1.0 ? ExitStatus::finished : ExitStatus::unreliable;
    if (status == ExitStatus::unreliable) {
        print_error(
            fmt::format("{}: unreliable: the residual of the energy balance is {:.2g} times the tolerance; runs from this state "
                        "will be reported as unreliable",
                        scene.name, balance_error_ratio));
    }
    if (arguments.quiet) return status;
    fmt::print("{}: settled for {}\n{}", scene.name, time_text(start.settling_time), field("state file", file));
    fmt::print("{}", field("usage", fmt::format("state = \"{}\" in [start] of the scene, or --set start.state={}",
                                                std::filesystem::path(file).filename().string(), file)));
    return status;
}

}  // namespace

Action declare_run(CLI::App& app) {
    const auto arguments = std::make_shared<RunArguments>();
    SceneArguments& scene = arguments->scene;
    declare_scene(app, scene);
    app.add_option("-o,--output", arguments->output,
                   "Record to write; must not exist (default: results/SCENE.h5, replaced with a notice); none: no record")
        ->type_name("FILE");
    app.add_flag("--force", arguments->force, force_meaning);
    app.add_option("--checkpoint-every", arguments->checkpoint_every,
                   "Wall time between checkpoints, NAME.checkpoint beside the record, e.g. \"10 min\" (default: none)")
        ->type_name("TIME");
    declare_shortcut(app, scene, "--method", "run.method", "NAME");
    declare_shortcut(app, scene, "--step", "run.step", "TIME");
    declare_shortcut(app, scene, "--tolerance", "run.tolerance", "NUMBER");
    declare_shortcut(app, scene, "--until", "run.until", "TIME");
    declare_shortcut(app, scene, "--threads", "run.threads", "N");
    declare_shortcut(app, scene, "--segments", "run.segments", "N");
    declare_shortcut(app, scene, "--seed", "run.seed", "N");
    declare_fresh_start(app, scene);
    app.add_option("--accuracy",
                   "Choose detail, method and step for this largest error of the outputs, e.g. \"1 %\"; cvtflow tune has further options")
        ->type_name("SHARE");  // Python's part of run
    app.add_flag("-q,--quiet", arguments->quiet, "Print errors only");
    app.footer(
        "--accuracy measures as cvtflow tune does, whose --outputs, --methods, --settling and --average it takes, and runs the choice.\n"
        "--tolerance chooses steps by the local error (run.step_control = \"error\"), at most --step.\n"
        "Times have units: --step \"50 ns\" --until 2ms. Ctrl-C ends the run and completes its record; a second Ctrl-C ends it at once.\n"
        "With --checkpoint-every, cvtflow resume FILE continues a killed run; results are bitwise equal.\n"
        "The record of a running simulation is FILE.part, which is readable at any time (cvtflow info FILE.part).\n\n" +
        std::string(exit_status_help));
    return [arguments] { return run(*arguments); };
}

Action declare_settle(CLI::App& app) {
    const auto arguments = std::make_shared<SettleArguments>();
    declare_scene(app, arguments->scene);
    app.add_option("-o,--output", arguments->output, "State file to write; must not exist (default: SCENE.state)")->type_name("STATE");
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
