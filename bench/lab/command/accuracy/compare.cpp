#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/lab/command/command.hpp"
#include "bench/lab/plot/plot.hpp"
#include "bench/lab/text/text.hpp"
#include "bench/method/implicit/catalogue.hpp"
#include "bench/method/implicit/linear_plan.hpp"
#include "bench/study/error_measure.hpp"
#include "tasks/run/run.hpp"
#include "tasks/scene/csv.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/text/report_columns.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

/// One choice of method and step.
struct ComparedChoice {
    std::string choice;                 ///< choice in the user's words: "rk4@50ns"
    std::vector<std::string> settings;  ///< settings of the scene that it means
    Trajectory run;                     ///< run of the last round
    TrajectoryErrors errors;
    double pin_error = std::numeric_limits<double>::quiet_NaN();  ///< error of the pin's axial force
    std::vector<double> seconds;                                  ///< wall time per simulated second, of each round

    [[nodiscard]] double median() const;
    [[nodiscard]] double mean_step() const { return run.simulated / static_cast<double>(std::max(1L, run.counters.steps)); }
};

/// Settings of the measurement.
struct CompareSetting {
    std::string scene;
    std::string reference, duration, interval;  ///< options in the user's words
    WatchResult reference_watch;
    int rounds = 0;
    bool newton = false;          ///< columns of Newton's method
    std::optional<PinEntry> pin;  ///< pin whose force is compared
};

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
    for (const char* key : {"status", "residual", "error_ratio", "pin_periods", "long_enough", "mean_slip", "efficiency"})
        columns.push_back({prefix + key, "", [of, key](const ComparedChoice& c) {
                               const ordered_json watch = of(c);
                               return watch.contains(key) ? watch[key] : ordered_json();
                           }});
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
    return columns;
}

double ComparedChoice::median() const {
    std::vector<double> sorted = seconds;
    std::sort(sorted.begin(), sorted.end());
    return sorted[sorted.size() / 2];
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
    return json_text(json);
}

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

/// Time since the start and the force on the sheave at -z, a column for the reference and for each choice that came to the end.
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

/// Distance from the reference.
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

struct CompareArguments {
    SceneArguments scene;
    std::vector<std::string> choices;
    std::string reference = "rk4@12.5ns", duration = "240us", interval = "12us", pin;
    int rounds = 3;
    bool newton = false, quiet = false;
    OutputArguments output;
};

const std::vector<std::string> usual_choices{"rk4@50ns", "dumka3-p5@2us", "dumka3-p7@3us", "leapfrog-sweep@auto"};
/// All variants of Newton's method and all linearly implicit methods, at 2 us.
std::vector<std::string> implicit_choices() {
    std::vector<std::string> choices;
    for (const bench::NewtonVariant& variant : bench::newton_variants()) choices.push_back(std::string(variant.name) + "@2us");
    for (const bench::LinearPlan& plan : bench::linear_plans()) choices.push_back(plan.name + "@2us");
    return choices;
}

void say(const CompareArguments& arguments, const std::string& what) {
    if (!arguments.quiet) print_error(what);
}

/// A state for runs to begin with, if the scene has none.
std::optional<engine::SavedState> settled(const CompareArguments& arguments, const tasks::Scene& scene) {
    tasks::Simulation simulation(scene);
    if (!simulation.needs_settling()) return std::nullopt;
    say(arguments, fmt::format("settling {} first", time_text(scene.parameters.start.settling_time)));
    tasks::SilentObserver silent;
    if (const tasks::Fault fault = simulation.advance({.until = 0.0}, silent, catch_interrupts())) throw tasks::SettlingFault(fault);
    return simulation.saved_state();
}

/// --pin N. @throws UsageError for a pin that the chain does not have
void require_pin(const std::string& pin, int pins) {
    int number = -1;
    if (pin.empty() || pin == "first") return;
    if (!CLI::detail::lexical_cast(pin, number) || number < 0 || number >= pins)
        throw UsageError(fmt::format("--pin {}: the chain has pins 0 to {}; or \"first\"", pin, pins - 1));
}

/// Whose force is compared: --pin first, --pin N; nothing without --pin, or if no pin enters.
std::optional<PinEntry> pin_of(const std::string& pin, const Trajectory& reference, const model::Parameters& parameters) {
    if (pin.empty()) return std::nullopt;
    return pin == "first" ? first_entry(reference, parameters) : std::optional<PinEntry>({std::stoi(pin), 0.0});
}

/// All choices in alternating rounds, so that other load affects them equally. Empty: interrupted.
std::vector<ComparedChoice> measure_all(const CompareArguments& arguments, const ErrorMeasure& measure,
                                        const engine::Cancellation& cancel) {
    std::vector<ComparedChoice> choices;
    for (const std::string& choice : arguments.choices) {
        choices.emplace_back();
        choices.back().choice = choice;
        choices.back().settings = read_choice(choice);
    }
    for (int round = 0; round < arguments.rounds; ++round) {
        say(arguments, fmt::format("round {} of {}", round + 1, arguments.rounds));
        for (ComparedChoice& choice : choices) {
            if (cancel.requested()) return {};
            choice.run = measure.run(choice.settings);
            choice.errors = measure.errors(choice.run).overall;
            choice.seconds.push_back(choice.run.wall_per_second());
        }
    }
    return choices;
}

/// Prints faults and warnings.
void complain(const std::string& choice, const Trajectory& run) {
    const std::string remark = run.fault ? run.fault.message() : unreliable_remark(run.fault, run.watch);
    if (!remark.empty()) print_error(choice + ": " + remark);
}

void write_files(const CompareArguments& arguments, const std::vector<ComparedChoice>& choices, const Trajectory& reference,
                 const CompareSetting& setting) {
    OutputFolder folder(arguments.output);
    folder.write("compare_" + setting.scene + ".csv", compare_csv(choices, setting));
    folder.write("compare_" + setting.scene + ".json", compare_json(choices, setting));
    if (setting.pin) {
        folder.write("pin-force.csv", pin_csv(choices, reference, setting));
        folder.write("pin-force.svg", svg(pin_plot(choices, reference, setting)));
        folder.write("pin-force-error.svg", svg(pin_error_plot(choices, reference, setting)));
    }
    fmt::print("{}", folder.written());
}

void report(const CompareArguments& arguments, const std::vector<ComparedChoice>& choices, const Trajectory& reference,
            const CompareSetting& setting) {
    fmt::print("{}: errors against {} over {} from the settled start, {} transitions; {}; medians of {}, alternating\n", setting.scene,
               setting.reference, setting.duration, reference.counters.detected, reference.schedule, plural(setting.rounds, "round"));
    if (setting.pin && arguments.pin == "first")
        fmt::print("{}", field("pin", fmt::format("{}, enters the driving sheaves at {}", setting.pin->pin, time_text(setting.pin->time))));
    if (!setting.pin && !arguments.pin.empty()) fmt::print("{}", field("pin", "none enters the driving sheaves in this time"));
    fmt::print("{}", compare_table(choices, setting));
    const std::string brief = too_short(reference.watch);
    if (!brief.empty()) fmt::print("{}", field("too short", brief));
    write_files(arguments, choices, reference, setting);
}

CompareSetting setting_of(const CompareArguments& arguments, const std::string& scene, const Trajectory& reference) {
    CompareSetting setting;
    setting.scene = scene;
    setting.reference = arguments.reference;
    setting.duration = arguments.duration;
    setting.interval = arguments.interval;
    setting.reference_watch = reference.watch;
    setting.rounds = arguments.rounds;
    setting.newton = arguments.newton;
    return setting;
}

ExitStatus run_compare(const CompareArguments& arguments) try {
    for (const std::string& choice : arguments.choices) static_cast<void>(read_choice(choice));
    const LoadedScene loaded = load_scene(arguments.scene);
    if (!loaded.notice.empty()) say(arguments, loaded.notice);
    const engine::Cancellation& cancel = catch_interrupts();
    tasks::Scene scene = loaded.scene;
    if (scene.run.schedule == "auto") tasks::set_value(scene, "run.schedule=serial");
    MeasureSettings settings{read_time("--duration", arguments.duration), read_time("--interval", arguments.interval),
                             read_choice(arguments.reference)};
    require_pin(arguments.pin, scene.parameters.chain.pins);
    settings.start = settled(arguments, scene);
    const ErrorMeasure measure(scene, settings, cancel);
    CompareSetting setting = setting_of(arguments, scene.name, measure.reference());
    setting.pin = pin_of(arguments.pin, measure.reference(), scene.parameters);
    complain("the reference, " + arguments.reference, measure.reference());
    std::vector<ComparedChoice> choices = measure_all(arguments, measure, cancel);
    if (choices.empty()) return ExitStatus::cancelled;
    for (ComparedChoice& choice : choices) {
        if (setting.pin) choice.pin_error = pin_error(choice.run, measure.reference(), setting.pin->pin);
        complain(choice.choice, choice.run);
    }
    report(arguments, choices, measure.reference(), setting);
    return ExitStatus::finished;
} catch (const tasks::SimulationError&) {  // a reference that was interrupted
    if (catch_interrupts().requested()) return ExitStatus::cancelled;
    throw;
}

constexpr const char* explanation =
    "Errors: relative, Euclidean norm over all tips (links) and outputs. fewer, faster: evaluations and time of the first choice\n"
    "divided by those of this one. Steps are shortened to divide the interval. METHOD@auto: automatic steps, timed over at least\n"
    "4 ms because choosing them takes most time at the start. residual: residual of the energy balance over the losses; runs whose\n"
    "balance does not close are unreliable, whatever their errors. run.schedule = \"auto\" means serial here.\n"
    "--newton: iterations, Jacobians and halvings per step of the trapezoidal rule; fell back: steps that needed an additional\n"
    "Jacobian; unconverged: steps that used the best iterate.\n"
    "  cvtflow-lab compare baseline rk4@50ns dumka3-p5@2us fitted@3us dopri54@1us~1e-3\n"
    "  cvtflow-lab compare baseline --pin first --duration 1ms -o results/pin\n"
    "  cvtflow-lab compare baseline --newton --duration 48us";

}  // namespace

Action declare_compare(CLI::App& app) {
    const auto arguments = std::make_shared<CompareArguments>();
    declare_scene(app, arguments->scene);
    app.add_option("CHOICE", arguments->choices,
                   "METHOD@STEP, METHOD@auto, or METHOD@LONGEST~TOLERANCE; ratios refer to the first one (default: five, "
                   "all implicit ones with --newton)")
        ->type_name("");
    app.add_option("--reference", arguments->reference, "Reference of the errors")->type_name("CHOICE")->capture_default_str();
    app.add_option("--duration", arguments->duration, "Simulated time")->type_name("TIME")->capture_default_str();
    app.add_option("--interval", arguments->interval, "Time between outputs")->type_name("TIME")->capture_default_str();
    app.add_option("--rounds", arguments->rounds, "Rounds of timing; choices alternate")->check(CLI::Range(1, 100))->capture_default_str();
    app.add_option("--pin", arguments->pin, "Also compare the axial force of a pin: N, or first: the first that enters the driving sheaves")
        ->type_name("N");
    app.add_flag("--newton", arguments->newton, "Also show how Newton's method converged");
    declare_fresh_start(app, arguments->scene);
    declare_output(app, arguments->output);
    app.add_flag("-q,--quiet", arguments->quiet, "No progress; results are printed all the same");
    app.footer(explanation);
    return [arguments] {
        if (arguments->choices.empty()) arguments->choices = arguments->newton ? implicit_choices() : usual_choices;
        return run_compare(*arguments);
    };
}

}  // namespace cvtflow::bench
