#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>

#include "engine/base/text.hpp"
#include "tasks/run/checkpoint.hpp"
#include "tasks/run/run.hpp"
#include "tasks/scene/ready_scenes.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/command/sweep/batch.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/program.hpp"
#include "tools/program/progress.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

namespace {

struct ResumeArguments {
    std::string what;
    std::string scene;
    std::string until;
    std::string output;
    std::optional<std::string> every;
    std::vector<std::string> settings;
    bool force = false, quiet = false, keep_going = false, mixed = false;
};

constexpr std::string_view checkpoint_ending = ".checkpoint";

/// The record that belongs to a checkpoint: beside it, NAME.h5 or NAME for NAME.checkpoint. The path stored in the checkpoint must agree
/// but is never used to choose a file. @throws engine::RecordError if it differs
std::string record_beside(const std::string& file, const tasks::Checkpoint& checkpoint) {
    if (checkpoint.record.empty()) return {};
    const bool named = file.ends_with(checkpoint_ending) && file.size() > checkpoint_ending.size();
    const std::string stem = named ? file.substr(0, file.size() - checkpoint_ending.size()) : "";
    const auto place = [](const std::string& name) {
        std::error_code unknown;
        return std::filesystem::weakly_canonical(std::filesystem::absolute(name), unknown);
    };
    for (const std::string& beside : {stem + ".h5", stem}) {
        if (named && place(beside) == place(checkpoint.record)) return beside;
    }
    throw engine::RecordError(
        fmt::format("{}: its run wrote the record {}, which is not NAME.h5 beside the checkpoint; -o FILE names the record to continue, "
                    "-o none resumes without a record",
                    file, checkpoint.record));
}

/// Place of the resumed record. Existing files are checked where the record is opened, which knows those of the run.
engine::OutputFile record_file(const ResumeArguments& arguments, const tasks::Checkpoint& checkpoint, const tasks::Scene& scene) {
    std::vector<std::filesystem::path> inputs = input_files(scene);
    inputs.emplace_back(arguments.what);
    const std::string& named = arguments.output;
    const std::string file = named.empty() ? record_beside(arguments.what, checkpoint) : named == "none" ? "" : named;
    if (!file.empty()) engine::require_no_input(file, inputs);
    return output_file(file, !named.empty(), arguments.force);
}

tasks::Scene scene_to_resume(const ResumeArguments& arguments, const tasks::Checkpoint& checkpoint) {
    tasks::Scene scene = arguments.scene.empty() ? tasks::scene_of(checkpoint)
                                                 : tasks::read_scene(tasks::find_scene(arguments.scene), tasks::StartState::ignored);
    std::vector<std::string> settings = arguments.settings;
    if (!arguments.until.empty()) settings.push_back("run.until=" + arguments.until);
    tasks::set_values(scene, settings);
    return scene;
}

/// Runs the unfinished cases of a sweep.
ExitStatus resume_sweep(const ResumeArguments& arguments) {
    tasks::BatchOptions options;
    options.folder = arguments.what;
    while (options.folder.size() > 1 && options.folder.back() == '/') options.folder.pop_back();
    options.keep_going = arguments.keep_going;
    return run_sweep(load_sweep(sweep_of(arguments.what)), options, {.quiet = arguments.quiet});
}

ExitStatus resume_run(const ResumeArguments& arguments) {
    if (std::filesystem::is_directory(arguments.what)) return resume_sweep(arguments);
    const tasks::Checkpoint checkpoint = tasks::read_checkpoint(arguments.what);
    const tasks::Scene scene = scene_to_resume(arguments, checkpoint);
    ProgressDisplay display(arguments.quiet, tasks::latest_end(scene));
    tasks::RunOptions options = display.options();
    options.file = record_file(arguments, checkpoint, scene);
    // Without its record, a run must not move its checkpoint on: the rows in between would be nowhere.
    if (!options.file.empty() || checkpoint.run.empty()) options.checkpoint = arguments.what;
    options.checkpoint_every = seconds_of("--checkpoint-every", arguments.every.value_or("60 s"));
    options.from = &checkpoint;
    options.mixed = arguments.mixed;
    say(arguments.quiet, fmt::format("{} resumes at t = {}", scene.name, time_text(checkpoint.integration.time)));
    const tasks::RunReport report = tasks::run_scene(scene, options);
    if (!arguments.quiet) {
        fmt::print("{}: {}{}", engine::visible(scene.name), tasks::summary(report),
                   field("record", options.file.empty() ? "none" : options.file.path));
    } else if (report.fault) {
        print_error(report.fault.message());
    }
    return exit_status(report);
}

}  // namespace

Action declare_resume(CLI::App& app) {
    const auto arguments = std::make_shared<ResumeArguments>();
    with_default_place(app.add_option("FILE", arguments->what, "Checkpoint of a run, or folder of a sweep"))->required()->type_name("");
    app.add_option("SCENE", arguments->scene, "Scene that the checkpoint must belong to (default: the one it contains)")->type_name("");
    app.add_option("--until", arguments->until, "New end of the run (default: unchanged)")->type_name("TIME");
    declare_repeated(app, "--set", arguments->settings, "Change a key that does not affect results: run.threads, run.max_wall, …",
                     "KEY=VALUE");
    app.add_option("-o,--output", arguments->output, "Record to continue (default: NAME.h5 beside NAME.checkpoint); none: no record")
        ->type_name("FILE");
    app.add_flag("--force", arguments->force, force_meaning);
    app.add_option("--checkpoint-every", arguments->every, "Wall time between checkpoints (default: 60 s)")->type_name("TIME");
    app.add_flag("--keep-going", arguments->keep_going, keep_going_meaning);
    app.add_flag("--mixed", arguments->mixed, "Continue a run that another version of the program began");
    app.add_flag("-q,--quiet", arguments->quiet, "Print errors only");
    app.footer(
        "The results are bitwise equal to those of an uninterrupted run. A checkpoint of another scene, method or model is refused.\n"
        "The record must be beside the checkpoint, or named with -o, and belong to this run; any other file is replaced only with "
        "--force.\n\n" +
        std::string(exit_status_help));
    return [arguments] { return resume_run(*arguments); };
}

}  // namespace cvtflow::tools
