#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>

#include "tasks/tradeoff/error_measure.hpp"
#include "tools/command.hpp"
#include "tools/guard.hpp"
#include "tools/method_choice_text.hpp"
#include "tools/interrupt.hpp"
#include "tools/scene_arguments.hpp"
#include "tools/text.hpp"

namespace cvtflow::tools {

namespace {

struct CompareArguments {
    SceneArguments scene;
    std::vector<std::string> choices{"rk4@50ns", "dumka3-p5@2us", "dumka3-p7@3us", "dumka3-p8@4us", "dumka3-p9@2us"};
    std::string reference = "rk4@12.5ns";
    std::string duration = "120us", interval = "12us";
    int repeats = 1;
};

std::string error_cell(double error) { return std::isfinite(error) ? fmt::format("{:.1e}", error) : "lost"; }

void add_row(Table& table, const std::string& name, const tasks::Trajectory& run, const tasks::TrajectoryErrors& errors, const tasks::Trajectory& first) {
    table.add({name, fmt::format("{:.4g} ns", 1e9 * run.simulated / static_cast<double>(std::max(1L, run.counters.steps))), fmt::format("{}", run.counters.evaluations),
               fmt::format("{:.3g}", run.evaluations_per_second()), error_cell(errors.axial_force), error_cell(errors.tension), error_cell(errors.slip),
               error_cell(errors.losses), fmt::format("{:.4g}", run.wall_per_second()),
               fmt::format("{:.2f}", first.evaluations_per_second() / run.evaluations_per_second()), fmt::format("{:.2f}", first.wall_per_second() / run.wall_per_second())});
}

ExitStatus compare(const CompareArguments& arguments) {
    std::vector<std::vector<std::string>> choices;
    for (const std::string& choice : arguments.choices) choices.push_back(read_choice(choice));
    tasks::MeasureSettings settings{read_time("--duration", arguments.duration), read_time("--interval", arguments.interval), read_choice(arguments.reference), 1};
    const LoadedScene loaded = load_scene(arguments.scene);
    const engine::Cancellation& cancel = catch_interrupts();
    tasks::Scene scene = loaded.scene;
    if (scene.run.schedule == "auto") tasks::set_value(scene, "run.schedule=serial");
    settings.repeats = arguments.repeats;
    const tasks::ErrorMeasure measure(scene, settings, cancel);
    fmt::print("{}: errors against {} over {} from the settled start, {} transitions; {}\n", scene.name, arguments.reference, time_text(settings.duration),
               measure.reference().counters.detected, measure.reference().schedule);
    const auto right = [](const char* heading) { return Table::Column{heading, Align::right}; };
    Table table({{"method"}, right("mean step"), right("evaluations"), right("per second"), right("axial force"), right("tension"), right("slip"), right("losses"),
                 right("wall s/s"), right("fewer"), right("faster")});
    std::optional<tasks::Trajectory> first;
    for (std::size_t i = 0; i < choices.size() && !cancel.requested(); ++i) {
        const tasks::Trajectory run = measure.run(choices[i]);
        if (!first) first = run;
        add_row(table, arguments.choices[i], run, measure.errors(run).overall, *first);
        if (run.fault) print_error(fmt::format("{}: {}", arguments.choices[i], run.fault.message()));
    }
    fmt::print("{}", table.text(2));
    return cancel.requested() ? ExitStatus::cancelled : ExitStatus::finished;
}

}  // namespace

Action declare_compare(CLI::App& app) {
    const auto arguments = std::make_shared<CompareArguments>();
    declare_scene(app, arguments->scene);
    app.add_option("CHOICE", arguments->choices, "METHOD@STEP, or METHOD@LONGEST~TOLERANCE; the first one is what others are compared with")
        ->type_name("")
        ->capture_default_str();
    app.add_option("--reference", arguments->reference, "What errors are measured against")->type_name("CHOICE")->capture_default_str();
    app.add_option("--duration", arguments->duration, "Simulated time")->type_name("TIME")->capture_default_str();
    app.add_option("--interval", arguments->interval, "Between outputs")->type_name("TIME")->capture_default_str();
    app.add_option("--repeats", arguments->repeats, "Runs of each choice, of which the fastest counts")->check(CLI::Range(1, 100))->capture_default_str();
    app.footer(
        "Errors are relative, Euclidean, over all tips (links) and outputs. fewer, faster: evaluations and wall time of the first choice over this one's.\n"
        "run.schedule = \"auto\" is taken as serial here.\n"
        "  cvtflow compare baseline rk4@50ns dumka3-p5@2us fitted@3us dopri54@1us~1e-3");
    return [arguments] { return compare(*arguments); };
}

}  // namespace cvtflow::tools
