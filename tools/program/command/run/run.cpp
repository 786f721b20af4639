#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>

#include "engine/base/provenance.hpp"
#include "tasks/run/run.hpp"
#include "tasks/tuning/tuned_scene.hpp"
#include "tools/program/arguments/scene_arguments.hpp"
#include "tools/program/arguments/tuning_arguments.hpp"
#include "tools/program/command/command.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output/interrupt.hpp"
#include "tools/program/output/output_place.hpp"
#include "tools/program/output/progress.hpp"
#include "tools/program/output/replacing.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

namespace {

struct RunArguments {
    SceneArguments scene;
    TuningArguments tuning;
    std::optional<std::string> cache;
    std::string output;
    std::string checkpoint;
    std::optional<std::string> checkpoint_every;
    bool force = false, quiet = false;
};

/// Where the record goes; empty: nowhere. Makes the folder only if the place was not chosen by the user.
std::string record_path(const RunArguments& arguments, const tasks::Scene& scene) {
    if (arguments.output == "none") return {};
    if (!arguments.output.empty()) return arguments.output;
    std::error_code reported_later;  // by the record, which needs the folder
    std::filesystem::create_directories("results", reported_later);
    return "results/" + scene.path.stem().string() + ".h5";
}

/// Beside the record, or under the scene's name.
std::string checkpoint_path(const RunArguments& arguments, const tasks::Scene& scene, const std::string& record) {
    if (!arguments.checkpoint.empty()) return arguments.checkpoint;
    std::filesystem::path path = record.empty() ? scene.path.stem() : std::filesystem::path(record);
    return path.replace_extension(".checkpoint.h5").string();
}

/// Complaints about the command line, and about places that must not be written to, before the work.
void require_places(const RunArguments& arguments, const tasks::Scene& scene, const std::string& file) {
    const std::vector<std::filesystem::path> inputs{scene.path, scene.state_file};
    require_output(file, inputs);
    if (!arguments.checkpoint_every) return;
    static_cast<void>(seconds_of("--checkpoint-every", *arguments.checkpoint_every));
    const std::string checkpoint = checkpoint_path(arguments, scene, file);
    require_checkpoint_place(checkpoint, file, inputs);
    keep_checkpoint(checkpoint, arguments.force);
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

tasks::RunReport simulate(const RunArguments& arguments, const tasks::Scene& scene, const std::string& file) {
    ProgressDisplay display(progress_style(arguments.quiet), scene.run.until);
    tasks::RunOptions options;
    options.file = file;
    options.cancel = &catch_interrupts();
    if (arguments.checkpoint_every) {
        options.checkpoint_every = seconds_of("--checkpoint-every", *arguments.checkpoint_every);
        options.checkpoint = checkpoint_path(arguments, scene, file);
    }
    options.notice = [](const std::string& text) { print_error(text); };
    if (!arguments.quiet) options.progress = [&display](const tasks::Progress& progress) { display.show(progress); };
    return tasks::run_scene(scene, options);
}

/// The scene with the detail, method and step that the accuracy asked for needs: as kept, or found now.
tasks::Scene tuned(const RunArguments& arguments, const tasks::Scene& scene) {
    const tasks::TuneSettings settings = tune_settings(arguments.tuning, arguments.quiet);
    const std::filesystem::path folder = arguments.cache ? std::filesystem::path(*arguments.cache) : tasks::usual_tuning_folder();
    const tasks::TunedScene made = tasks::tuned_scene(scene, settings, folder, catch_interrupts());
    if (!arguments.quiet)
        print_error(fmt::format("{}: {} for {} (largest error measured: {:.2g} %){}", scene.name, made.kept.choice.text(),
                                *arguments.tuning.accuracy, 100.0 * made.kept.error,
                                made.result ? fmt::format(", found in {}", clock_text(made.result->wall)) : ", as found before"));
    return made.scene;
}

ExitStatus run_loaded(const RunArguments& arguments, LoadedScene loaded) {
    if (!loaded.notice.empty() && !arguments.quiet) print_error(loaded.notice);
    const std::string file = record_path(arguments, loaded.scene);
    require_places(arguments, loaded.scene, file);
    if (arguments.tuning.accuracy) loaded.scene = tuned(arguments, loaded.scene);
    const std::string replaced = replacing(file, !arguments.output.empty(), arguments.force);
    if (!replaced.empty() && !arguments.quiet) print_error(replaced);
    const tasks::RunReport report = simulate(arguments, loaded.scene, file);
    if (!arguments.quiet) {
        fmt::print("{}: {}{}{}", loaded.scene.name, tasks::summary(report), machine_text(), field("record", record_text(file)));
    } else if (report.fault) {
        print_error(report.fault.message());
    } else if (!report.reliable()) {
        print_error(tasks::unreliable_text(report));
    }
    return exit_status(report);
}

ExitStatus run(const RunArguments& arguments) try {
    return run_loaded(arguments, load_scene(arguments.scene));
} catch (const tasks::AccuracyError& error) {
    print_error(error.what());
    return ExitStatus::inaccurate;
} catch (const tasks::SimulationError&) {
    if (arguments.tuning.accuracy && catch_interrupts().requested()) return ExitStatus::cancelled;
    throw;
}

}  // namespace

Action declare_run(CLI::App& app) {
    const auto arguments = std::make_shared<RunArguments>();
    SceneArguments& scene = arguments->scene;
    declare_scene(app, scene);
    app.add_option("-o,--output", arguments->output,
                   "Record to write, which must not be there yet (default: results/SCENE.h5, replaced with a notice); none: no record")
        ->type_name("FILE");
    app.add_flag("--force", arguments->force, force_meaning);
    app.add_option("--checkpoint-every", arguments->checkpoint_every,
                   "Wall time between checkpoints, e.g. \"10 min\" (default: no checkpoints)")
        ->type_name("TIME");
    app.add_option("--checkpoint", arguments->checkpoint, "Where checkpoints go (default: beside the record, NAME.checkpoint.h5)")
        ->type_name("FILE");
    declare_shortcut(app, scene, "--method", "run.method", "NAME");
    declare_shortcut(app, scene, "--step", "run.step", "TIME");
    declare_shortcut(app, scene, "--tolerance", "run.tolerance", "NUMBER");
    declare_shortcut(app, scene, "--until", "run.until", "TIME");
    declare_shortcut(app, scene, "--threads", "run.threads", "N");
    declare_shortcut(app, scene, "--segments", "run.segments", "N");
    declare_shortcut(app, scene, "--seed", "run.seed", "N");
    declare_fresh_start(app, scene);
    declare_tuning(app, arguments->tuning);
    for (const char* chosen : {"--method", "--step", "--tolerance", "--detail"}) app.get_option("--accuracy")->excludes(chosen);
    for (const char* needs : {"--outputs", "--methods", "--budget", "--settling", "--average"}) app.get_option(needs)->needs("--accuracy");
    app.add_option("--cache", arguments->cache,
                   "Where choices for --accuracy are kept (default: $XDG_CACHE_HOME/cvtflow or ~/.cache/cvtflow)")
        ->type_name("DIR")
        ->needs("--accuracy");
    app.add_flag("-q,--quiet", arguments->quiet, "Print nothing but errors");
    app.footer(
        "--accuracy finds detail, method and step as cvtflow tune does, and keeps them: the same run of the same scene begins at once the "
        "next time.\n"
        "--tolerance makes the local error decide on steps (run.step_control = \"error\"), up to --step.\n"
        "Times take units: --step \"50 ns\" --until 2ms. Ctrl-C ends the run and completes its record; twice ends it at once.\n"
        "With checkpoints a run that was killed goes on with cvtflow resume FILE, bit for bit.\n"
        "While the run goes on, its record is FILE.part, readable at any time (cvtflow info FILE.part).\n\n" +
        std::string(exit_status_help));
    return [arguments] { return run(*arguments); };
}

}  // namespace cvtflow::tools
