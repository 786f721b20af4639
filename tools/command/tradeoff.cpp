#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>

#include "tasks/tradeoff/error_measure.hpp"
#include "tasks/tradeoff/pareto.hpp"
#include "tools/command.hpp"
#include "tools/detail_report.hpp"
#include "tools/interrupt.hpp"
#include "tools/method_choice_text.hpp"
#include "tools/output_folder.hpp"
#include "tools/plot/plot.hpp"
#include "tools/provenance_json.hpp"
#include "tools/scene_arguments.hpp"
#include "tools/text.hpp"

namespace cvtflow::tools {

namespace {

struct TradeoffArguments {
    SceneArguments scene;
    std::vector<std::string> choices{"rk4@50ns", "rk4@25ns", "dumka3-p4@2us", "dumka3-p5@2us", "dumka3-p5@3us", "dumka3-p7@3us", "rkc-s12@1us", "rock2-s9@1us",
                                     "rock4-s7@150ns", "fitted-l130-w1.9@2us", "fitted-l270-w4@4us", "leapfrog-rkc@0.5us", "leapfrog-rkc@1us", "leapfrog-rkc@1.5us", "leapfrog-rkc@2us",
                                     "leapfrog-chebyshev@1us", "leapfrog-chebyshev@2us"};
    std::string reference = "rk4@12.5ns", duration = "240us", interval = "12us";
    int rounds = 3;
    OutputArguments output;
};

/// All rounds of one choice.
struct Entry {
    std::string choice;
    std::vector<std::string> settings;
    tasks::TrajectoryErrors errors;
    double evaluations = 0.0;      ///< per simulated second
    std::vector<double> seconds;   ///< wall time per simulated second, of each round

    [[nodiscard]] double median() const {
        std::vector<double> sorted = seconds;
        std::sort(sorted.begin(), sorted.end());
        return sorted[sorted.size() / 2];
    }
    [[nodiscard]] double largest_force() const { return std::max(errors.axial_force, errors.tension); }
};

/// The choices in turns, round after round, so that whatever else the machine does falls on all of them alike.
std::vector<Entry> measure_all(const TradeoffArguments& arguments, const tasks::ErrorMeasure& measure, const engine::Cancellation& cancel) {
    std::vector<Entry> entries;
    for (const std::string& choice : arguments.choices) entries.push_back({choice, read_choice(choice), {}, 0.0, {}});
    for (int round = 0; round < arguments.rounds; ++round) {
        for (Entry& entry : entries) {
            if (cancel.requested()) return {};
            const tasks::Trajectory run = measure.run(entry.settings);
            entry.errors = measure.errors(run).overall;
            entry.evaluations = run.evaluations_per_second();
            entry.seconds.push_back(run.wall_per_second());
        }
    }
    return entries;
}

std::string cell(double error) { return std::isfinite(error) ? fmt::format("{:.1e}", error) : "lost"; }

std::string table_of(const std::vector<Entry>& entries, const std::vector<bool>& front) {
    const auto right = [](const char* heading) { return Table::Column{heading, Align::right}; };
    Table table({{"method"}, right("evaluations/s"), right("axial force"), right("tension"), right("slip"), right("losses"), right("wall s/s"), right("faster"), {"front"}});
    for (std::size_t k = 0; k < entries.size(); ++k) {
        const Entry& e = entries[k];
        table.add({e.choice, fmt::format("{:.3g}", e.evaluations), cell(e.errors.axial_force), cell(e.errors.tension), cell(e.errors.slip), cell(e.errors.losses),
                   fmt::format("{:.4g}", e.median()), fmt::format("{:.1f}", entries[0].median() / e.median()), front[k] ? "*" : ""});
    }
    return table.text(2);
}

std::string recommendations(const std::vector<tasks::TradeoffPoint>& points) {
    std::string text = "\nFor an error in axial forces and link tensions of at most\n";
    for (const double error : {1e-2, 1e-3, 1e-4, 1e-5}) {
        const auto best = tasks::recommended(points, error, tasks::tradeoff_safety);
        text += best ? fmt::format("  {:.0e}  use {} ({:.4g} s per simulated second, {:.1e} here)\n", error, points[*best].choice, points[*best].seconds, points[*best].error)
                     : fmt::format("  {:.0e}  none of these is exact enough\n", error);
    }
    return text + fmt::format("An error counts as met if it is met {:g} times over here, since scenes differ.\n", tasks::tradeoff_safety);
}

std::string csv_of(const std::vector<Entry>& entries, const std::vector<bool>& front) {
    std::string text = "method,evaluations_per_second,error_axial_force,error_tension,error_slip,error_losses,wall_seconds_per_second,front\n";
    for (std::size_t k = 0; k < entries.size(); ++k) {
        const Entry& e = entries[k];
        text += fmt::format("{},{:.6g},{:.3e},{:.3e},{:.3e},{:.3e},{:.6g},{}\n", e.choice, e.evaluations, e.errors.axial_force, e.errors.tension, e.errors.slip,
                            e.errors.losses, e.median(), front[k] ? 1 : 0);
    }
    return text;
}

std::string json_of(const std::vector<Entry>& entries, const std::vector<bool>& front, const std::string& scene, const TradeoffArguments& arguments) {
    auto rows = nlohmann::ordered_json::array();
    for (std::size_t k = 0; k < entries.size(); ++k) {
        const Entry& e = entries[k];
        rows.push_back({{"method", e.choice}, {"evaluations_per_second", e.evaluations}, {"error_axial_force", e.errors.axial_force}, {"error_tension", e.errors.tension},
                        {"error_slip", e.errors.slip}, {"error_losses", e.errors.losses}, {"wall_seconds_per_second", e.seconds}, {"front", static_cast<bool>(front[k])}});
    }
    return json_text({{"scene", scene}, {"provenance", provenance_json()}, {"reference", arguments.reference}, {"duration", arguments.duration},
                      {"interval", arguments.interval}, {"choices", rows}});
}

std::string picture(const std::vector<Entry>& entries, const std::string& scene, const TradeoffArguments& arguments) {
    Plot plot;
    plot.title = "Speed and accuracy: " + scene;
    plot.subtitle = fmt::format("against {} over {}, medians of {} rounds in turns", arguments.reference, arguments.duration, arguments.rounds);
    plot.x.label = "wall time per simulated second [s]";
    plot.y.label = "error, larger of axial forces and link tensions";
    plot.x.scale = plot.y.scale = Scale::logarithmic;
    std::vector<std::string> families;
    for (const Entry& entry : entries) {
        const std::string family = entry.choice.substr(0, entry.choice.find('@'));
        if (families.empty() || families.back() != family) {
            families.push_back(family);
            plot.series.push_back({.name = family, .points = {}, .line = Line::solid, .colour = {}});
        }
        if (std::isfinite(entry.largest_force())) plot.series.back().points.push_back({entry.median(), entry.largest_force()});
    }
    return svg(plot);
}

ExitStatus tradeoff(const TradeoffArguments& arguments) {
    for (const std::string& choice : arguments.choices) static_cast<void>(read_choice(choice));
    const tasks::MeasureSettings settings{read_time("--duration", arguments.duration), read_time("--interval", arguments.interval), read_choice(arguments.reference), 1};
    const LoadedScene loaded = load_scene(arguments.scene);
    const engine::Cancellation& cancel = catch_interrupts();
    tasks::Scene scene = loaded.scene;
    if (scene.run.schedule == "auto") tasks::set_value(scene, "run.schedule=serial");
    const tasks::ErrorMeasure measure(scene, settings, cancel);
    fmt::print("{}: errors against {} over {} from the settled start, {} transitions; {}; medians of {} rounds in turns\n", scene.name, arguments.reference,
               time_text(settings.duration), measure.reference().counters.detected, measure.reference().schedule, arguments.rounds);
    const std::vector<Entry> entries = measure_all(arguments, measure, cancel);
    if (entries.empty()) return ExitStatus::cancelled;
    std::vector<tasks::TradeoffPoint> points;
    for (const Entry& entry : entries) points.push_back({entry.choice, entry.largest_force(), entry.median()});
    const std::vector<bool> front = tasks::pareto_front(points);
    fmt::print("{}{}", table_of(entries, front), recommendations(points));
    OutputFolder folder(arguments.output);
    folder.write("tradeoff_" + scene.name + ".csv", csv_of(entries, front));
    folder.write("tradeoff_" + scene.name + ".json", json_of(entries, front, scene.name, arguments));
    folder.write("tradeoff_" + scene.name + ".svg", picture(entries, scene.name, arguments));
    fmt::print("{}", folder.written());
    return ExitStatus::finished;
}

}  // namespace

Action declare_tradeoff(CLI::App& app) {
    const auto arguments = std::make_shared<TradeoffArguments>();
    declare_scene(app, arguments->scene);
    app.add_option("CHOICE", arguments->choices, "METHOD@STEP, or METHOD@LONGEST~TOLERANCE")->type_name("");
    app.add_option("--reference", arguments->reference, "What errors are measured against")->type_name("CHOICE")->capture_default_str();
    app.add_option("--duration", arguments->duration, "Simulated time")->type_name("TIME")->capture_default_str();
    app.add_option("--interval", arguments->interval, "Between outputs")->type_name("TIME")->capture_default_str();
    app.add_option("--rounds", arguments->rounds, "Times that every choice runs, in turns")->check(CLI::Range(1, 100))->capture_default_str();
    CLI::Option* detail = app.get_option("--detail")->expected(0, 1);
    declare_output(app, arguments->output);
    app.footer("Errors are relative, Euclidean, over all tips (links) and outputs. front: no other is both faster and more exact.\n"
               "SCENE --detail without a level compares levels of detail instead of methods: cvtflow detail. Times are those of run.schedule, \"auto\" taken as serial.");
    return [arguments, detail] {
        if (detail->count() == 0 || !arguments->scene.detail.empty()) return tradeoff(*arguments);
        DetailArguments levels;
        levels.scenes = {arguments->scene.scene};
        levels.settings = arguments->scene.settings;
        return report_details(levels, arguments->output);
    };
}

}  // namespace cvtflow::tools
