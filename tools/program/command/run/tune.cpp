#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "tasks/tuning/tuned_scene.hpp"
#include "tools/program/arguments/scene_arguments.hpp"
#include "tools/program/arguments/tuning_arguments.hpp"
#include "tools/program/command/command.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output/interrupt.hpp"
#include "tools/program/output/output_folder.hpp"
#include "tools/program/output/output_place.hpp"
#include "tools/program/output/replacing.hpp"
#include "tools/program/output/text_file.hpp"
#include "tools/program/report/tune_report.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

namespace {

struct TuneArguments {
    SceneArguments scene;
    TuningArguments tuning;
    std::string file;
    int verify = 0;
    bool force = false, quiet = false;
    OutputArguments output;
};

/// Errors of the choice at so many points that it was not tried at.
std::vector<UnseenPoint> verify(tasks::Tuner& tuner, const tasks::Scene& scene, const tasks::TuneSettings& settings,
                                const tasks::TuneResult& result, int count) {
    std::vector<UnseenPoint> unseen;
    for (const tasks::OperatingPoint& point : tasks::unseen_points(scene, settings.times, count, scene.run.seed)) {
        if (settings.progress) settings.progress("verifying at " + point.name);
        UnseenPoint& made = unseen.emplace_back();
        made.name = point.name;
        made.errors = tuner.errors_at(result.choices[*result.chosen].choice, point, settings.accuracy, made.remark);
    }
    return unseen;
}

/// One point in twenty may miss the target.
bool held(const std::vector<UnseenPoint>& unseen, double accuracy) {
    std::size_t missed = 0, judged = 0;
    for (const UnseenPoint& point : unseen) {
        judged += !point.errors.empty();
        missed += !point.errors.empty() && !(tasks::largest(point.errors) <= accuracy);
    }
    return 20 * missed <= judged;
}

/// FILE and, where the scene's own start does not fit, its state beside it.
void write_tuned(const TuneArguments& arguments, tasks::Tuner& tuner, const tasks::Scene& scene, const tasks::TuneResult& result) {
    const tasks::TunedChoice& chosen = result.choices[*result.chosen];
    std::string state;
    if (tasks::needs_own_state(scene, tasks::chosen_scene(scene, chosen.choice, chosen.step))) {
        state = std::filesystem::path(arguments.file).replace_extension(".h5").string();
        engine::write_state(state, tuner.settled_state(chosen.choice));
    }
    const std::string place = state.empty() ? "" : std::filesystem::absolute(state).lexically_normal().string();
    write_text(arguments.file, tasks::tuned_text(scene, result, place));
    const std::string picture = std::filesystem::path(arguments.file).replace_extension(".svg").string();
    write_text(picture, tune_picture(result));
    fmt::print("{}", field("written", fmt::format("{}, {}{}", arguments.file, picture, state.empty() ? "" : ", " + state)));
}

ExitStatus tune(TuneArguments& arguments) try {
    tasks::TuneSettings settings = tune_settings(arguments.tuning, arguments.quiet);
    const LoadedScene loaded = load_scene(arguments.scene);
    const tasks::Scene& scene = loaded.scene;
    if (!loaded.notice.empty() && !arguments.quiet) print_error(loaded.notice);
    const bool named = !arguments.file.empty();
    if (!named) arguments.file = scene.path.stem().string() + ".tuned.toml";
    require_output(arguments.file, {scene.path, scene.state_file});
    const std::string replaced = replacing(arguments.file, named, arguments.force);
    if (!replaced.empty() && !arguments.quiet) print_error(replaced);
    tasks::Tuner tuner(scene, settings, catch_interrupts());
    const tasks::TuneResult result = tuner.tune(settings.accuracy);
    fmt::print("{}", tune_text(result));
    std::vector<UnseenPoint> unseen;
    if (result.chosen) {
        unseen = verify(tuner, scene, settings, result, arguments.verify);
        if (!unseen.empty()) fmt::print("{}", unseen_text(result, unseen));
        write_tuned(arguments, tuner, scene, result);
    }
    OutputFolder folder(arguments.output);
    folder.write("tune_" + result.scene + ".csv", tune_csv(result));
    folder.write("tune_" + result.scene + ".json", tune_json(result, unseen));
    folder.write("tune_" + result.scene + ".svg", tune_picture(result));
    fmt::print("{}", folder.written());
    return result.chosen && held(unseen, settings.accuracy) ? ExitStatus::finished : ExitStatus::inaccurate;
} catch (const tasks::SimulationError&) {
    if (catch_interrupts().requested()) return ExitStatus::cancelled;
    throw;
}

}  // namespace

Action declare_tune(CLI::App& app) {
    const auto arguments = std::make_shared<TuneArguments>();
    declare_scene(app, arguments->scene);
    declare_tuning(app, arguments->tuning);
    app.get_option("--accuracy")->required();
    app.add_option("--verify", arguments->verify, "Measure the choice at so many operating points that it was not tried at")
        ->type_name("N")
        ->check(CLI::Range(0, 1000));
    app.add_option(
           "--write", arguments->file,
           "Scene to write, with a picture beside it, and a state if its detail needs one (default: SCENE.tuned.toml, replaced with a "
           "notice)")
        ->type_name("FILE");
    app.add_flag("--force", arguments->force, force_meaning);
    declare_output(app, arguments->output);
    app.add_flag("-q,--quiet", arguments->quiet, "No progress");
    app.footer(
        "Levels of detail (cvtflow list detail) with the cheapest methods at their automatic steps, their halves and quarters, cheapest "
        "first, "
        "at the scene's start and\n"
        "at the lowest and highest value of every table over time, against the finest level at a quarter of its step or less. The first "
        "whose "
        "errors times " +
        fmt::format("{:g}", tasks::tuning_margin) +
        " are within the\n"
        "accuracy everywhere is chosen; what is unreliable never is. front: nothing that was tried is both cheaper and more exact. Exit "
        "status "
        "7: nothing is within it,\n"
        "or more than one in twenty points of --verify is not.\n\n" +
        std::string(exit_status_help));
    return [arguments] { return tune(*arguments); };
}

}  // namespace cvtflow::tools
