#include "bench/lab/report/compare_report.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>

#include "bench/lab/text/text.hpp"
#include "bench/study/tradeoff/recommendation.hpp"
#include "tasks/scene/csv.hpp"
#include "tools/program/text/report_columns.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

using ChoiceColumn = ReportColumn<ComparedChoice>;
using ChoiceColumns = std::vector<ChoiceColumn>;
using nlohmann::ordered_json;

std::string error_cell(double error) { return std::isnan(error) ? "-" : std::isfinite(error) ? fmt::format("{:.1e}", error) : "lost"; }

/// A column of errors. @param of a function of a choice
template <class Of>
ChoiceColumn error_column(const std::string& key, const std::string& heading, Of of) {
    return {key, heading, [of](const ComparedChoice& c) { return of(c); }, [of](const ComparedChoice& c) { return error_cell(of(c)); }};
}

void add_costs(ChoiceColumns& columns, const ComparedChoice& first) {
    const auto fewer = [evaluations = first.run.evaluations_per_second()](const ComparedChoice& c) {
        return evaluations / c.run.evaluations_per_second();
    };
    const auto faster = [seconds = first.median()](const ComparedChoice& c) { return seconds / c.median(); };
    columns.insert(columns.end(),
                   {{"method", "method", [](const ComparedChoice& c) { return c.choice; }, [](const ComparedChoice& c) { return c.choice; },
                     Align::left},
                    {"mean_step", "mean step", [](const ComparedChoice& c) { return c.mean_step(); },
                     [](const ComparedChoice& c) { return time_text(c.mean_step()); }},
                    {"steps", "", [](const ComparedChoice& c) { return c.run.counters.steps; }},
                    {"evaluations", "evaluations", [](const ComparedChoice& c) { return c.run.counters.evaluations; },
                     [](const ComparedChoice& c) { return count_text(c.run.counters.evaluations); }},
                    {"transitions", "", [](const ComparedChoice& c) { return c.run.counters.detected; }},
                    {"evaluations_per_second", "per second", [](const ComparedChoice& c) { return c.run.evaluations_per_second(); },
                     [](const ComparedChoice& c) { return fmt::format("{:.3g}", c.run.evaluations_per_second()); }},
                    {"wall_seconds_per_second", "wall s/s", [](const ComparedChoice& c) { return c.median(); },
                     [](const ComparedChoice& c) { return fmt::format("{:.4g}", c.median()); }},
                    {"fewer_by", "fewer", fewer, [fewer](const ComparedChoice& c) { return fmt::format("{:.2f}", fewer(c)); }},
                    {"faster_by", "faster", faster, [faster](const ComparedChoice& c) { return fmt::format("{:.2f}", faster(c)); }}});
}

void add_errors(ChoiceColumns& columns, bool pin) {
    columns.push_back(error_column("error_axial_force", "axial force", [](const ComparedChoice& c) { return c.errors.axial_force; }));
    columns.push_back(error_column("error_tension", "tension", [](const ComparedChoice& c) { return c.errors.tension; }));
    columns.push_back(error_column("error_slip", "slip", [](const ComparedChoice& c) { return c.errors.slip; }));
    columns.push_back(error_column("error_losses", "losses", [](const ComparedChoice& c) { return c.errors.losses; }));
    if (pin) columns.push_back(error_column("error_pin", "pin", [](const ComparedChoice& c) { return c.pin_error; }));
}

/// A figure of Newton's method; nothing for other methods.
template <class Of>
ChoiceColumn newton_column(const std::string& key, const std::string& heading, Of of) {
    return {key, heading, [of](const ComparedChoice& c) { return c.run.newton ? ordered_json(of(*c.run.newton)) : ordered_json(); },
            [of](const ComparedChoice& c) { return c.run.newton ? fmt::format("{:.3g}", static_cast<double>(of(*c.run.newton))) : ""; }};
}

void add_newton(ChoiceColumns& columns) {
    using Newton = bench::NewtonStatistics;
    const auto per_step = [](long Newton::*count) {
        return [count](const Newton& n) { return static_cast<double>(n.*count) / static_cast<double>(std::max(1L, n.steps)); };
    };
    columns.push_back(newton_column("newton_iterations", "iterations", per_step(&Newton::iterations)));
    columns.push_back(newton_column("newton_most", "most", [](const Newton& n) { return n.most; }));
    columns.push_back(newton_column("newton_jacobians", "Jacobians", per_step(&Newton::jacobians)));
    columns.push_back(newton_column("newton_halvings", "halvings", per_step(&Newton::backtracks)));
    columns.push_back(newton_column("newton_fell_back", "fell back", [](const Newton& n) { return n.refreshed; }));
    columns.push_back(newton_column("newton_unconverged", "unconverged", [](const Newton& n) { return n.unconverged; }));
}

/// ChoiceColumns of watch_json(), from a run or from the confirmation. @param prefix of their keys
template <class Of>
void add_watch(ChoiceColumns& columns, const std::string& prefix, Of of) {
    for (const char* key : {"status", "residual", "suspicion", "pin_periods", "long_enough", "mean_slip", "efficiency"})
        columns.push_back({prefix + key, "", [of, key](const ComparedChoice& c) {
                               const ordered_json watch = of(c);
                               return watch.contains(key) ? watch[key] : ordered_json();
                           }});
}

/// Result of a long run; nullptr without one.
const Confirmed* long_run(const ComparedChoice& c) {
    return c.front_result.confirmed && c.front_result.confirmed->ran && !c.front_result.confirmed->run.fault ? &*c.front_result.confirmed
                                                                                                             : nullptr;
}

void add_front(ChoiceColumns& columns, double confirm) {
    const auto far = [](const char* key, const char* heading, double Confirmed::*error) {
        return ChoiceColumn{
            key, heading,
            [error](const ComparedChoice& c) { return long_run(c) != nullptr ? ordered_json(long_run(c)->*error) : ordered_json(); },
            [error](const ComparedChoice& c) {
                return long_run(c) != nullptr ? fmt::format("{:.3f} %", 100.0 * (long_run(c)->*error)) : "";
            }};
    };
    const auto outcome = [](const ComparedChoice& c) { return c.front_result.outcome(); };
    columns.push_back({"front", "front", [](const ComparedChoice& c) { return c.front_result.front; },
                       [](const ComparedChoice& c) { return c.front_result.front ? "*" : ""; }, Align::left});
    columns.push_back({"stable_step", "stable to", [](const ComparedChoice& c) { return c.front_result.stable_step; },
                       [](const ComparedChoice& c) {
                           return std::isfinite(c.front_result.stable_step) ? time_text(c.front_result.stable_step) : "any";
                       }});
    columns.push_back(far("long_slip_off", "slip off", &Confirmed::slip_error));
    columns.push_back(far("long_losses_off", "losses off", &Confirmed::loss_error));
    add_watch(columns, "long_", [](const ComparedChoice& c) {
        return long_run(c) != nullptr ? watch_json(long_run(c)->run.fault, long_run(c)->run.watch) : ordered_json::object();
    });
    columns.push_back({"standing", "over " + time_text(confirm), outcome, outcome, Align::left});
}

ChoiceColumns columns_of(const ComparedChoice& first, const CompareSetting& setting) {
    ChoiceColumns columns;
    add_costs(columns, first);
    add_errors(columns, setting.pin.has_value());
    if (setting.newton) add_newton(columns);
    const auto watch = [](const ComparedChoice& c) { return watch_json(c.run.fault, c.run.watch); };
    columns.push_back({"", "residual", {}, [](const ComparedChoice& c) { return residual_cell(c.run.fault, c.run.watch); }});
    columns.push_back({"", "status", {}, [](const ComparedChoice& c) { return c.run.watch.status(c.run.fault); }, Align::left});
    add_watch(columns, "", watch);
    if (setting.front) add_front(columns, setting.confirm);
    return columns;
}

std::vector<tasks::TradeoffPoint> points_of(const std::vector<ComparedChoice>& choices) {
    std::vector<tasks::TradeoffPoint> points;
    for (const ComparedChoice& choice : choices) points.push_back(choice.point());
    return points;
}

}  // namespace

double ComparedChoice::median() const {
    std::vector<double> sorted = seconds;
    std::sort(sorted.begin(), sorted.end());
    return sorted[sorted.size() / 2];
}

tasks::TradeoffPoint ComparedChoice::point() const {
    const double force = std::max(errors.axial_force, errors.tension);
    return {choice, front_result.objection.empty() ? force : std::numeric_limits<double>::infinity(), median()};
}

std::string compare_table(const std::vector<ComparedChoice>& choices, const CompareSetting& setting) {
    return report_table(columns_of(choices.front(), setting), choices);
}

std::string compare_csv(const std::vector<ComparedChoice>& choices, const CompareSetting& setting) {
    return report_csv(columns_of(choices.front(), setting), choices);
}

std::string compare_json(const std::vector<ComparedChoice>& choices, const CompareSetting& setting) {
    ordered_json json{{"scene", setting.scene},         {"provenance", provenance_json()},
                      {"reference", setting.reference}, {"reference_watch", watch_json({}, setting.reference_watch)},
                      {"duration", setting.duration},   {"interval", setting.interval},
                      {"rounds", setting.rounds}};
    if (setting.pin) json.update(ordered_json{{"pin", setting.pin->pin}, {"entry", setting.pin->time}});
    json["choices"] = report_json(columns_of(choices.front(), setting), choices);
    if (!setting.front) return json_text(json);
    json.update(ordered_json{{"confirm", setting.confirm},
                             {"confirm_reference", setting.confirm_reference},
                             {"confirm_watch", watch_json({}, setting.confirm_watch)}});
    for (const double error : recommended_errors) {
        const auto best = recommended(points_of(choices), error, tradeoff_safety);
        json["recommended"].push_back({{"error", error}, {"method", best ? ordered_json(choices[*best].choice) : ordered_json()}});
    }
    return json_text(json);
}

std::string recommendations(const std::vector<ComparedChoice>& choices, const CompareSetting& setting) {
    const std::vector<tasks::TradeoffPoint> points = points_of(choices);
    std::string text = "\nFor an error in axial forces and link tensions of at most\n";
    for (const double error : recommended_errors) {
        const auto best = recommended(points, error, tradeoff_safety);
        text += best ? fmt::format("  {:.0e}  use {} ({:.4g} s per simulated second, {:.1e} here)\n", error, points[*best].choice,
                                   points[*best].seconds, points[*best].error)
                     : fmt::format("  {:.0e}  no choice is accurate enough\n", error);
    }
    text += fmt::format(
        "A target counts as met with a margin of {:g}, because scenes differ. Recommendations were confirmed over {}\nagainst {}.\n",
        tradeoff_safety, time_text(setting.confirm), setting.confirm_reference);
    const std::string brief = too_short(setting.confirm_watch);
    return brief.empty() ? text : text + fmt::format("Confirmed over too short a time: {}.\n", brief);
}

Plot front_plot(const std::vector<ComparedChoice>& choices, const CompareSetting& setting) {
    Plot plot;
    plot.title = "Speed and accuracy: " + setting.scene;
    plot.subtitle = fmt::format("against {} over {}, medians of {} alternating rounds; without unstable choices and those wrong over {}",
                                setting.reference, setting.duration, setting.rounds, time_text(setting.confirm));
    plot.x.label = "wall time per simulated second [s]";
    plot.y.label = "error, larger of axial forces and link tensions";
    plot.x.scale = plot.y.scale = Scale::logarithmic;
    std::vector<std::string> families;
    for (const ComparedChoice& choice : choices) {
        const std::string family = choice.choice.substr(0, choice.choice.find('@'));
        if (families.empty() || families.back() != family) {
            families.push_back(family);
            plot.series.push_back({.name = family, .points = {}, .line = Line::solid, .colour = {}});
        }
        const tasks::TradeoffPoint point = choice.point();
        if (std::isfinite(point.error)) plot.series.back().points.push_back({point.seconds, point.error});
    }
    return plot;
}

namespace {

/// Colours repeat after eight.
Line line_of(std::size_t series) { return series < 8 ? Line::solid : Line::dashed; }

Plot empty_plot(const CompareSetting& setting, const std::string& quantity) {
    Plot plot;
    plot.title = fmt::format("{} of pin {}", quantity, setting.pin->pin);
    plot.subtitle = setting.scene + ", on the sheave at -z";
    if (setting.pin->time > 0.0) plot.subtitle += fmt::format("; the pin enters the driving sheaves at {}", time_text(setting.pin->time));
    plot.x = {"time [ms]", Scale::linear, 1.0, {}, {}};
    plot.y = {quantity + " [N]", Scale::linear, 1.0, {}, {}};
    return plot;
}

}  // namespace

std::string pin_csv(const std::vector<ComparedChoice>& choices, const Trajectory& reference, const CompareSetting& setting) {
    std::string text = "time,reference";
    std::vector<std::vector<double>> columns{reference.pin_axial(setting.pin->pin, 0)};
    for (const ComparedChoice& choice : choices) {
        if (choice.run.fault) continue;
        text += "," + tasks::csv_cell(choice.choice, true);
        columns.push_back(choice.run.pin_axial(setting.pin->pin, 0));
    }
    text += "\n";
    for (std::size_t row = 0; row < reference.times.size(); ++row) {
        text += fmt::format("{:.9g}", reference.times[row]);
        for (const auto& column : columns) text += fmt::format(",{:.9g}", column[row]);
        text += "\n";
    }
    return text;
}

Plot pin_plot(const std::vector<ComparedChoice>& choices, const Trajectory& reference, const CompareSetting& setting) {
    Plot plot = empty_plot(setting, "Axial force");
    const auto add = [&](const std::string& name, const Trajectory& run, const std::string& colour, Line line, double width) {
        Series series{name, {}, Mark::none, line, colour, width};
        const std::vector<double> force = run.pin_axial(setting.pin->pin, 0);
        for (std::size_t k = 0; k < force.size(); ++k) series.points.push_back({1e3 * run.times[k], force[k]});
        plot.series.push_back(std::move(series));
    };
    add("reference", reference, "#bbbbbb", Line::solid, 5.0);  // below the others, which mostly hide one another
    for (const ComparedChoice& choice : choices) {
        const std::size_t number = plot.series.size() - 1;
        if (!choice.run.fault) add(choice.choice, choice.run, palette(number), line_of(number), 1.6);
    }
    return plot;
}

Plot pin_error_plot(const std::vector<ComparedChoice>& choices, const Trajectory& reference, const CompareSetting& setting) {
    Plot plot = empty_plot(setting, "Error of the axial force");
    plot.y.label = "|force - reference| [N]";
    plot.y.scale = Scale::logarithmic;
    const std::vector<double> should = reference.pin_axial(setting.pin->pin, 0);
    for (const ComparedChoice& choice : choices) {
        if (choice.run.fault) continue;
        Series series{choice.choice, {}, Mark::none, line_of(plot.series.size()), ""};
        const std::vector<double> force = choice.run.pin_axial(setting.pin->pin, 0);
        for (std::size_t k = 0; k < should.size(); ++k)
            series.points.push_back({1e3 * choice.run.times[k], std::abs(force[k] - should[k])});
        plot.series.push_back(std::move(series));
    }
    return plot;
}

void declare_front(CLI::App& app, CLI::Option* front, FrontArguments& arguments) {
    app.add_option("--confirm", arguments.confirm, "With --front: length of the run that confirms a recommendation")
        ->type_name("TIME")
        ->capture_default_str()
        ->needs(front);
    app.add_option("--confirm-against", arguments.reference,
                   "Reference of that run (default: leapfrog-chebyshev at a quarter of its automatic step, refined)")
        ->type_name("CHOICE")
        ->needs(front);
}

ConfirmSettings confirm_settings(const FrontArguments& arguments, double interval) {
    ConfirmSettings settings;
    settings.duration = read_time("--confirm", arguments.confirm);
    settings.interval = interval;
    if (!arguments.reference.empty()) settings.reference = read_choice(arguments.reference);
    return settings;
}

void require_reliable(const std::string& scene, const std::string& choice, const Trajectory& reference) {
    if (!reference.watch.reliable())
        throw tasks::SimulationError(fmt::format("{}: the reference {} is {}", scene, choice, unreliable_remark({}, reference.watch)));
}

namespace {

const ConfirmSettings& announced(const ConfirmSettings& settings, const std::function<void(const std::string&)>& progress) {
    progress(fmt::format("the reference of the confirmation, over {}", time_text(settings.duration)));
    return settings;
}

/// The next choice to confirm: the cheapest that is on the front or would be recommended. nullptr: none
ComparedChoice* next_candidate(std::vector<ComparedChoice>& choices) {
    std::vector<tasks::TradeoffPoint> points;
    for (const ComparedChoice& choice : choices) points.push_back(choice.point());
    std::vector<bool> requested = tasks::pareto_front(points);
    for (std::size_t k = 0; k < choices.size(); ++k) choices[k].front_result.front = requested[k];
    for (const double error : recommended_errors) {
        if (const auto best = recommended(points, error, tradeoff_safety)) requested[*best] = true;
    }
    ComparedChoice* cheapest = nullptr;
    for (std::size_t k = 0; k < choices.size(); ++k) {
        if (!requested[k] || choices[k].front_result.confirmed) continue;
        if (cheapest == nullptr || choices[k].median() < cheapest->median()) cheapest = &choices[k];
    }
    return cheapest;
}

}  // namespace

ParetoFront::ParetoFront(const tasks::Scene& scene, const ConfirmSettings& settings, const engine::Cancellation& cancel,
                         std::function<void(const std::string&)> progress)
    : cancel_(cancel),
      progress_(std::move(progress)),
      duration_(settings.duration),
      confirmation_(scene, announced(settings, progress_), cancel) {}

/// Rejects choices whose step is unstable, and those whose short run is unreliable.
void ParetoFront::judge_steps(std::vector<ComparedChoice>& choices) {
    progress_("largest stable steps");
    for (ComparedChoice& choice : choices) {
        choice.front_result.stable_step = confirmation_.stable_step(choice.settings);
        if (confirmation_.beyond_stability(choice.settings))
            choice.front_result.objection = "beyond stability";
        else if (!choice.run.fault && !choice.run.watch.reliable())
            choice.front_result.objection = "unreliable";
    }
}

void ParetoFront::judge(std::vector<ComparedChoice>& choices, CompareSetting& setting) {
    judge_steps(choices);
    for (ComparedChoice* choice = next_candidate(choices); choice != nullptr && !cancel_.requested(); choice = next_candidate(choices)) {
        progress_(fmt::format("{} over {}, about {} of wall time", choice->choice, time_text(duration_),
                              time_text(duration_ * choice->median())));
        choice->front_result.confirmed = confirmation_.check(choice->settings);
        choice->front_result.objection = choice->front_result.confirmed->objection;
    }
    setting.front = true;
    setting.confirm = duration_;
    setting.confirm_reference = confirmation_.reference_text();
    setting.confirm_watch = confirmation_.reference().watch;
}

}  // namespace cvtflow::bench
