#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "tasks/tuning/tuned_scene.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/program.hpp"
#include "tools/program/text/report_columns.hpp"
#include "tools/program/text/text.hpp"
#include "tools/program/text/tune_report.hpp"

namespace cvtflow::tools {

namespace {

struct TuneArguments {
    SceneArguments scene;
    TuningArguments tuning;
    std::string file, levels;
    std::size_t verify = 0;
    bool all = false, force = false, quiet = false;
    OutputArguments output;
};

/// Whether at most one point in twenty misses the target.
bool held(const std::vector<tasks::UnseenPoint>& unseen, double accuracy) {
    std::size_t missed = 0, judged = 0;
    for (const tasks::UnseenPoint& point : unseen) {
        judged += !point.errors.empty();
        missed += !point.errors.empty() && !(tasks::largest(point.errors) <= accuracy);
    }
    return 20 * missed <= judged;
}

/// FILE, and beside it a picture and, if the scene's start does not fit, a state.
struct TunedFiles {
    engine::Permit scene, picture, state;
};

/// Asked before the work, whether a state will be needed or not.
TunedFiles permit_files(const TuneArguments& arguments, const tasks::Scene& scene, bool named) {
    const std::string &file = arguments.file, picture = beside(file, ".svg"), state = beside(file, ".h5");
    if (file == picture || file == state) throw UsageError(fmt::format("--write {}: expected FILE.toml", file));
    const bool force = arguments.force;
    const std::vector<std::string> marks{fmt::format("# {} for an accuracy of ", scene.name), "# Made by cvtflow"};
    engine::OutputRule picture_rule = marked_rule("picture", scene.name, input_files(scene), force);
    picture_rule.devices = false;
    TunedFiles files{
        {file, scene_rule("scene that cvtflow tuned from", engine::text_with(marks), scene, named, force)}, {picture, picture_rule}, {}};
    if (scene.parameters.start.layout == model::StartLayout::belt) files.state = {state, state_rule(scene, false, force)};
    say(arguments.quiet, files.scene.notice());
    return files;
}

/// @param picture empty: none could be drawn
void write_tuned(const TunedFiles& files, tasks::Tuner& tuner, const tasks::Scene& scene, const tasks::TuneResult& result,
                 const std::string& picture) {
    const tasks::TunedChoice& chosen = result.choices[*result.chosen];
    std::string place;
    if (tasks::needs_own_state(scene, tasks::chosen_scene(scene, chosen.choice, chosen.step))) {
        place = std::filesystem::absolute(files.state.path()).lexically_normal().string();
        engine::write_state(files.state, tuner.settled_state(chosen.choice, chosen.step));
    }
    engine::write_whole(files.scene, tasks::tuned_text(scene, result, place));
    if (!picture.empty()) engine::write_whole(files.picture, picture);
    fmt::print("{}", field("written", fmt::format("{}{}{}", files.scene.path(), picture.empty() ? "" : ", " + files.picture.path(),
                                                  place.empty() ? "" : ", " + files.state.path())));
}

/// Empty where Python or a library is missing: the search took minutes, and its numbers are there.
std::string picture_of(const nlohmann::ordered_json& json, const std::string& scene) try {
    return tune_picture(json, mark_of("picture", scene));
} catch (const std::runtime_error& missing) {
    print_error(fmt::format("no picture: {}", missing.what()));
    return {};
}

ExitStatus tune(TuneArguments& arguments) try {
    tasks::TuneSettings settings = tune_settings(arguments.tuning, arguments.quiet);
    settings.all = arguments.all;
    settings.levels = names_of(arguments.levels);
    const LoadedScene loaded = load_scene(arguments.scene);
    const tasks::Scene& scene = loaded.scene;
    say(arguments.quiet, loaded.notice);
    const bool named = !arguments.file.empty();
    if (!named) arguments.file = scene.path.stem().string() + ".tuned.toml";
    const TunedFiles files = permit_files(arguments, scene, named);
    tasks::Tuner tuner(scene, settings, catch_interrupts());
    const tasks::TuneResult result = tuner.tune(settings.accuracy);
    fmt::print("{}", tune_text(result));
    std::vector<tasks::UnseenPoint> unseen;
    if (result.chosen && arguments.verify > 0) {
        const auto points = tasks::unseen_points(scene, settings.times, tuner.points().outputs, arguments.verify, scene.run.seed);
        unseen = tuner.verify(result.choices[*result.chosen], points, settings.accuracy);
        fmt::print("{}", unseen_text(result, unseen));
    }
    OutputFolder folder(arguments.output);
    const nlohmann::ordered_json json = tune_json(result, unseen);
    const std::string picture = result.chosen || arguments.output.any() ? picture_of(json, scene.name) : "";
    if (result.chosen) write_tuned(files, tuner, scene, result, picture);
    folder.write("tune_" + result.scene + ".csv", tune_csv(result));
    folder.write("tune_" + result.scene + ".json", json_text(json));
    if (!picture.empty()) folder.write("tune_" + result.scene + ".svg", picture);
    fmt::print("{}", folder.written());
    if (!result.chosen && !result.used_up_by.empty()) return ExitStatus::budget;
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
    app.add_option("--verify", arguments->verify, "Measure the choice at N further operating points that tuning did not use")
        ->type_name("N")
        ->check(CLI::Range(0, 1000));
    app.add_option("--levels", arguments->levels,
                   "Levels of detail to choose from, separated by commas: LEVEL, or LEVEL KEY=VALUE such as \"full detail.plates=lumped\" "
                   "(default: all, and the scene's)")
        ->type_name("LIST");
    app.add_flag("--all", arguments->all, "Measure every choice at every point: the whole table of cost and error");
    app.add_option("--write", arguments->file,
                   "Scene to write, with a picture beside it, and a state if the detail requires one (default: SCENE.tuned.toml, replaced "
                   "with a notice)")
        ->type_name("FILE");
    app.add_flag("--force", arguments->force, force_meaning);
    declare_output(app, arguments->output);
    app.add_flag("-q,--quiet", arguments->quiet, "Print no progress");
    app.footer(
        "Tries levels of detail (cvtflow list detail) with the methods that auto chooses among, at the automatic step, a half and a "
        "quarter\nof it, cheapest first. Operating points: the scene's start, and the lowest and highest value of every table over "
        "time.\nReference: the finest level at a quarter of its step or less. Chooses the first variant whose errors times " +
        fmt::format("{:g} ({:g} where there is one point)", tasks::tuning_margin, tasks::lone_point_margin) +
        "\nmeet the accuracy at every point; unreliable variants are never chosen. front: no other variant is both cheaper and more "
        "accurate.\nExit status 7: no variant meets the accuracy, or more than one in twenty points of --verify misses it; 4: the budget "
        "was\nused up before one did.\n\n" +
        std::string(exit_status_help));
    return [arguments] { return tune(*arguments); };
}

}  // namespace cvtflow::tools
