#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>

#include "bench/lab/command/command.hpp"
#include "bench/lab/text/method_choice_text.hpp"
#include "bench/lab/text/watch_text.hpp"
#include "bench/study/tradeoff/error_measure.hpp"
#include "tools/program/arguments/scene_arguments.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output/interrupt.hpp"
#include "tools/program/output/output_folder.hpp"
#include "tools/program/text/provenance_json.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

struct CompareArguments {
    SceneArguments scene;
    std::vector<std::string> choices{"rk4@50ns", "dumka3-p5@2us", "dumka3-p7@3us", "dumka3-p8@4us", "dumka3-p9@2us"};
    std::string reference = "rk4@12.5ns";
    std::string duration = "120us", interval = "12us";
    int repeats = 1;
    OutputArguments output;
};

/// A choice and its results.
struct ComparedChoice {
    std::string choice;
    Trajectory run;
    TrajectoryErrors errors;

    [[nodiscard]] double mean_step() const { return run.simulated / static_cast<double>(std::max(1L, run.counters.steps)); }
};

std::string error_cell(double error) { return std::isfinite(error) ? fmt::format("{:.1e}", error) : "lost"; }

std::string table_of(const std::vector<ComparedChoice>& rows) {
    const auto right = [](const char* heading) { return Table::Column{heading, Align::right}; };
    Table table({{"method"},
                 right("mean step"),
                 right("evaluations"),
                 right("per second"),
                 right("axial force"),
                 right("tension"),
                 right("slip"),
                 right("losses"),
                 right("wall s/s"),
                 right("fewer"),
                 right("faster"),
                 right("residual"),
                 {"status"}});
    const Trajectory& first = rows.front().run;
    for (const ComparedChoice& row : rows) {
        const Trajectory& run = row.run;
        const TrajectoryErrors& errors = row.errors;
        table.add({row.choice, fmt::format("{:.4g} ns", 1e9 * row.mean_step()), fmt::format("{}", run.counters.evaluations),
                   fmt::format("{:.3g}", run.evaluations_per_second()), error_cell(errors.axial_force), error_cell(errors.tension),
                   error_cell(errors.slip), error_cell(errors.losses), fmt::format("{:.4g}", run.wall_per_second()),
                   fmt::format("{:.2f}", first.evaluations_per_second() / run.evaluations_per_second()),
                   fmt::format("{:.2f}", first.wall_per_second() / run.wall_per_second()), residual_cell(run.fault, run.watch),
                   run.watch.status(run.fault)});
    }
    return table.text(2);
}

std::string error_number(double error) { return std::isfinite(error) ? fmt::format("{:.3e}", error) : ""; }

std::string csv_of(const std::vector<ComparedChoice>& rows) {
    std::string text =
        "method,mean_step,evaluations,evaluations_per_second,error_axial_force,error_tension,error_slip,error_losses,wall_seconds_per_"
        "second,";
    text += watch_heading + std::string("\n");
    for (const ComparedChoice& row : rows) {
        text += fmt::format("{},{:.6g},{},{:.6g},{},{},{},{},{:.6g},{}\n", row.choice, row.mean_step(), row.run.counters.evaluations,
                            row.run.evaluations_per_second(), error_number(row.errors.axial_force), error_number(row.errors.tension),
                            error_number(row.errors.slip), error_number(row.errors.losses), row.run.wall_per_second(),
                            watch_csv(row.run.fault, row.run.watch));
    }
    return text;
}

std::string json_of(const std::vector<ComparedChoice>& rows, const std::string& scene, const CompareArguments& arguments,
                    const Trajectory& reference) {
    auto choices = nlohmann::ordered_json::array();
    for (const ComparedChoice& row : rows) {
        choices.push_back({{"method", row.choice},
                           {"mean_step", row.mean_step()},
                           {"evaluations", row.run.counters.evaluations},
                           {"error_axial_force", row.errors.axial_force},
                           {"error_tension", row.errors.tension},
                           {"error_slip", row.errors.slip},
                           {"error_losses", row.errors.losses},
                           {"wall_seconds_per_second", row.run.wall_per_second()},
                           {"fault", row.run.fault ? row.run.fault.message() : ""},
                           {"watch", watch_json(row.run.fault, row.run.watch)}});
    }
    return json_text({{"scene", scene},
                      {"provenance", provenance_json()},
                      {"reference", arguments.reference},
                      {"reference_watch", watch_json(reference.fault, reference.watch)},
                      {"duration", arguments.duration},
                      {"interval", arguments.interval},
                      {"choices", choices}});
}

/// Prints faults and warnings.
void complain(const std::string& choice, const Trajectory& run) {
    const std::string remark = run.fault ? run.fault.message() : unreliable_remark(run.fault, run.watch);
    if (!remark.empty()) print_error(choice + ": " + remark);
}

void report(const std::vector<ComparedChoice>& rows, const std::string& scene, const CompareArguments& arguments,
            const Trajectory& reference) {
    fmt::print("{}", table_of(rows));
    const std::string brief = too_short(reference.watch);
    if (!brief.empty()) fmt::print("{}", field("too short", brief));
    OutputFolder folder(arguments.output);
    folder.write("compare_" + scene + ".csv", csv_of(rows));
    folder.write("compare_" + scene + ".json", json_of(rows, scene, arguments, reference));
    fmt::print("{}", folder.written());
}

ExitStatus compare(const CompareArguments& arguments) {
    std::vector<std::vector<std::string>> choices;
    for (const std::string& choice : arguments.choices) choices.push_back(read_choice(choice));
    MeasureSettings settings{read_time("--duration", arguments.duration), read_time("--interval", arguments.interval),
                             read_choice(arguments.reference), 1};
    const LoadedScene loaded = load_scene(arguments.scene);
    const engine::Cancellation& cancel = catch_interrupts();
    tasks::Scene scene = loaded.scene;
    if (scene.run.schedule == "auto") tasks::set_value(scene, "run.schedule=serial");
    settings.repeats = arguments.repeats;
    const ErrorMeasure measure(scene, settings, cancel);
    fmt::print("{}: errors against {} over {} from the settled start, {} transitions; {}\n", scene.name, arguments.reference,
               time_text(settings.duration), measure.reference().counters.detected, measure.reference().schedule);
    complain("the reference, " + arguments.reference, measure.reference());
    std::vector<ComparedChoice> rows;
    for (std::size_t i = 0; i < choices.size() && !cancel.requested(); ++i) {
        const Trajectory run = measure.run(choices[i]);
        rows.push_back({arguments.choices[i], run, measure.errors(run).overall});
        complain(arguments.choices[i], run);
    }
    if (!rows.empty()) report(rows, scene.name, arguments, measure.reference());
    return cancel.requested() ? ExitStatus::cancelled : ExitStatus::finished;
}

}  // namespace

Action declare_compare(CLI::App& app) {
    const auto arguments = std::make_shared<CompareArguments>();
    declare_scene(app, arguments->scene);
    app.add_option("CHOICE", arguments->choices, "METHOD@STEP, METHOD@auto, or METHOD@LONGEST~TOLERANCE; ratios refer to the first one")
        ->type_name("")
        ->capture_default_str();
    app.add_option("--reference", arguments->reference, "Reference of the errors")->type_name("CHOICE")->capture_default_str();
    app.add_option("--duration", arguments->duration, "Simulated time")->type_name("TIME")->capture_default_str();
    app.add_option("--interval", arguments->interval, "Time between outputs")->type_name("TIME")->capture_default_str();
    app.add_option("--repeats", arguments->repeats, "Runs of each choice; the fastest counts")
        ->check(CLI::Range(1, 100))
        ->capture_default_str();
    declare_output(app, arguments->output);
    app.footer(
        "Errors: relative, Euclidean norm over all tips (links) and outputs. fewer, faster: evaluations and wall time of the first choice "
        "divided by\nthose of this one. run.schedule = \"auto\" means serial here. METHOD@auto: automatic steps, timed over at least 4 ms "
        "because choosing\nthem is most expensive at the start. residual: residual of the energy balance over the losses; runs whose "
        "balance "
        "does not close are\nunreliable, whatever their errors.\n"
        "  cvtflow-lab compare baseline rk4@50ns dumka3-p5@2us fitted@3us dopri54@1us~1e-3");
    return [arguments] { return compare(*arguments); };
}

}  // namespace cvtflow::bench
