#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>

#include "bench/lab/command/command.hpp"
#include "bench/lab/report/detail_report.hpp"
#include "bench/lab/report/method/tradeoff_report.hpp"
#include "bench/lab/text/method_choice_text.hpp"
#include "bench/lab/text/watch_text.hpp"
#include "tools/program/arguments/scene_arguments.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output/interrupt.hpp"
#include "tools/program/output/output_folder.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

struct TradeoffArguments {
    SceneArguments scene;
    std::vector<std::string> choices{"rk4@50ns",
                                     "rk4@25ns",
                                     "dumka3-p4@2us",
                                     "dumka3-p5@2us",
                                     "dumka3-p5@3us",
                                     "dumka3-p7@3us",
                                     "rkc-s12@1us",
                                     "rock2-s9@1us",
                                     "rock4-s7@150ns",
                                     "fitted-l130-w1.9@2us",
                                     "fitted-l270-w4@4us",
                                     "leapfrog-rkc@0.5us",
                                     "leapfrog-rkc@1us",
                                     "leapfrog-rkc@1.5us",
                                     "leapfrog-rkc@2us",
                                     "leapfrog-rkc@auto",
                                     "leapfrog-chebyshev@1us",
                                     "leapfrog-chebyshev@2us",
                                     "leapfrog-chebyshev@auto"};
    std::string reference = "rk4@12.5ns", duration = "240us", interval = "12us", confirm = "20 ms", confirm_reference;
    int rounds = 3;
    bool quiet = false;
    OutputArguments output;
};

void say(const TradeoffArguments& arguments, const std::string& what) {
    if (!arguments.quiet) print_error(what);
}

/// Runs all choices in alternating rounds, so that other load affects them equally.
std::vector<TradeoffEntry> measure_all(const TradeoffArguments& arguments, const ErrorMeasure& measure,
                                       const engine::Cancellation& cancel) {
    std::vector<TradeoffEntry> entries;
    for (const std::string& choice : arguments.choices) {
        TradeoffEntry& entry = entries.emplace_back();
        entry.choice = choice;
        entry.settings = read_choice(choice);
    }
    for (int round = 0; round < arguments.rounds; ++round) {
        for (TradeoffEntry& entry : entries) {
            if (cancel.requested()) return {};
            const Trajectory run = measure.run(entry.settings);
            entry.errors = measure.errors(run).overall;
            entry.evaluations = run.evaluations_per_second();
            entry.seconds.push_back(run.wall_per_second());
            entry.fault = run.fault;
            entry.watch = run.watch;
        }
    }
    return entries;
}

/// Rejects choices whose step is unstable, and those whose short run is unreliable.
void look_at_steps(const TradeoffArguments& arguments, Confirmation& confirmation, std::vector<TradeoffEntry>& entries) {
    say(arguments, "largest stable steps");
    for (TradeoffEntry& entry : entries) {
        entry.stable_step = confirmation.stable_step(entry.settings);
        if (confirmation.beyond_stability(entry.settings))
            entry.objection = "beyond stability";
        else if (!entry.fault && !entry.watch.reliable())
            entry.objection = "unreliable";
    }
}

/// The next choice to confirm: the cheapest that is on the front or would be recommended.
TradeoffEntry* next_candidate(std::vector<TradeoffEntry>& entries) {
    std::vector<tasks::TradeoffPoint> points;
    for (const TradeoffEntry& entry : entries) points.push_back(entry.point());
    std::vector<bool> requested = tasks::pareto_front(points);
    for (std::size_t k = 0; k < entries.size(); ++k) entries[k].front = requested[k];
    for (const double error : recommended_errors) {
        if (const auto best = tasks::recommended(points, error, tasks::tradeoff_safety)) requested[*best] = true;
    }
    TradeoffEntry* cheapest = nullptr;
    for (std::size_t k = 0; k < entries.size(); ++k) {
        if (!requested[k] || entries[k].confirmed) continue;
        if (cheapest == nullptr || entries[k].median() < cheapest->median()) cheapest = &entries[k];
    }
    return cheapest;
}

void confirm_all(const TradeoffArguments& arguments, Confirmation& confirmation, std::vector<TradeoffEntry>& entries,
                 const engine::Cancellation& cancel) {
    look_at_steps(arguments, confirmation, entries);
    const double duration = read_time("--confirm", arguments.confirm);
    for (TradeoffEntry* entry = next_candidate(entries); entry != nullptr && !cancel.requested(); entry = next_candidate(entries)) {
        say(arguments,
            fmt::format("{} over {}, about {} of wall time", entry->choice, time_text(duration), time_text(duration * entry->median())));
        entry->confirmed = confirmation.check(entry->settings);
        entry->objection = entry->confirmed->objection;
    }
}

void report(const TradeoffArguments& arguments, const std::vector<TradeoffEntry>& entries, const TradeoffSetting& setting) {
    fmt::print("{}{}", tradeoff_table(entries, setting), tradeoff_recommendations(entries, setting));
    OutputFolder folder(arguments.output);
    folder.write("tradeoff_" + setting.scene + ".csv", tradeoff_csv(entries));
    folder.write("tradeoff_" + setting.scene + ".json", tradeoff_json(entries, setting));
    folder.write("tradeoff_" + setting.scene + ".svg", tradeoff_picture(entries, setting));
    fmt::print("{}", folder.written());
}

ConfirmSettings confirm_settings(const TradeoffArguments& arguments) {
    ConfirmSettings settings;
    settings.duration = read_time("--confirm", arguments.confirm);
    settings.interval = read_time("--interval", arguments.interval);
    if (!arguments.confirm_reference.empty()) settings.reference = read_choice(arguments.confirm_reference);
    return settings;
}

ExitStatus tradeoff(const TradeoffArguments& arguments) try {
    for (const std::string& choice : arguments.choices) static_cast<void>(read_choice(choice));
    const ConfirmSettings far = confirm_settings(arguments);
    const MeasureSettings settings{read_time("--duration", arguments.duration), read_time("--interval", arguments.interval),
                                   read_choice(arguments.reference), 1};
    const LoadedScene loaded = load_scene(arguments.scene);
    const engine::Cancellation& cancel = catch_interrupts();
    tasks::Scene scene = loaded.scene;
    if (scene.run.schedule == "auto") tasks::set_value(scene, "run.schedule=serial");
    const ErrorMeasure measure(scene, settings, cancel);
    if (!measure.reference().watch.reliable())
        throw tasks::SimulationError(
            fmt::format("{}: the reference {} is {}", scene.name, arguments.reference, unreliable_remark({}, measure.reference().watch)));
    say(arguments, fmt::format("the reference of the confirmation, over {}", time_text(far.duration)));
    Confirmation confirmation(scene, far, cancel);  // before the rest: it may fail
    std::vector<TradeoffEntry> entries = measure_all(arguments, measure, cancel);
    if (entries.empty()) return ExitStatus::cancelled;
    confirm_all(arguments, confirmation, entries, cancel);
    if (cancel.requested()) return ExitStatus::cancelled;
    fmt::print("{}: errors against {} over {} from the settled start, {} transitions; {}; medians of {} alternating rounds\n", scene.name,
               arguments.reference, time_text(settings.duration), measure.reference().counters.detected, measure.reference().schedule,
               arguments.rounds);
    report(arguments, entries,
           {scene.name, arguments.reference, arguments.duration, arguments.interval, arguments.rounds, far.duration,
            confirmation.reference_text(), confirmation.reference().watch});
    return ExitStatus::finished;
} catch (const tasks::SimulationError&) {  // a reference that was interrupted
    if (catch_interrupts().requested()) return ExitStatus::cancelled;
    throw;
}

}  // namespace

Action declare_tradeoff(CLI::App& app) {
    const auto arguments = std::make_shared<TradeoffArguments>();
    declare_scene(app, arguments->scene);
    app.add_option("CHOICE", arguments->choices, "METHOD@STEP, METHOD@auto, or METHOD@LONGEST~TOLERANCE")->type_name("");
    app.add_option("--reference", arguments->reference, "Reference of the errors")->type_name("CHOICE")->capture_default_str();
    app.add_option("--duration", arguments->duration, "Simulated time")->type_name("TIME")->capture_default_str();
    app.add_option("--interval", arguments->interval, "Time between outputs")->type_name("TIME")->capture_default_str();
    app.add_option("--rounds", arguments->rounds, "Rounds of timing; choices alternate")->check(CLI::Range(1, 100))->capture_default_str();
    app.add_option("--confirm", arguments->confirm, "Length of the run that confirms a recommendation")
        ->type_name("TIME")
        ->capture_default_str();
    app.add_option("--confirm-against", arguments->confirm_reference,
                   "Reference of that run (default: leapfrog-chebyshev at a quarter of its automatic step, refined)")
        ->type_name("CHOICE");
    CLI::Option* detail = app.get_option("--detail")->expected(0, 1);
    declare_output(app, arguments->output);
    app.add_flag("-q,--quiet", arguments->quiet, "No progress; results are printed all the same");
    app.footer(
        "Errors: relative, Euclidean norm over all tips (links) and outputs. front: no other choice is both faster and more accurate.\n"
        "METHOD@auto: automatic steps, timed over 4 ms. Choices on the front or recommended run again over --confirm, cheapest first, "
        "because bursts\nare rare. Choices with unstable steps, with an energy balance that does not close (unreliable), or with errors of "
        "mean slip or losses\nabove 1 % are marked, and neither on the front nor recommended. Times are those of run.schedule; \"auto\" "
        "means serial.\ncvtflow-lab detail compares levels of detail instead of methods.");
    return [arguments, detail] {
        if (detail->count() == 0 || !arguments->scene.detail.empty()) return tradeoff(*arguments);
        DetailArguments levels;
        levels.scenes = {arguments->scene.scene};
        levels.settings = arguments->scene.settings;
        return report_details(levels, arguments->output);
    };
}

}  // namespace cvtflow::bench
