#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/lab/choice.hpp"
#include "bench/lab/command/command.hpp"
#include "bench/lab/show.hpp"
#include "bench/method/implicit/catalogue.hpp"
#include "bench/method/implicit/linear_plan.hpp"
#include "bench/study/error_measure.hpp"
#include "tasks/run/run.hpp"
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

double ComparedChoice::median() const {
    std::vector<double> sorted = seconds;
    std::sort(sorted.begin(), sorted.end());
    return sorted[sorted.size() / 2];
}

/// Status and figures of a run; of a run that failed the status alone, the others are unknown.
Json watch_json(const tasks::Fault& fault, const WatchResult& watch) {
    const auto known = [&](const Json& value) { return fault ? Json() : value; };
    return named("status,residual,error_ratio,pin_periods,long_enough,mean_slip,efficiency",
                 {watch.status(fault), known(watch.residual), known(watch.balance_error_ratio), known(watch.pin_periods()),
                  known(watch.long_enough()), known(watch.means.slip), known(watch.means.efficiency)});
}

/// How Newton's method converged; unknown of other methods.
Json newton_json(const std::optional<NewtonStatistics>& newton) {
    const auto per_step = [&](long NewtonStatistics::*count) {
        return newton ? Json(static_cast<double>((*newton).*count) / static_cast<double>(std::max(1L, newton->steps))) : Json();
    };
    const auto known = [&](auto NewtonStatistics::*count) { return newton ? Json((*newton).*count) : Json(); };
    using Newton = NewtonStatistics;
    return named("newton_iterations,newton_most,newton_jacobians,newton_halvings,newton_fell_back,newton_unconverged",
                 {per_step(&Newton::iterations), known(&Newton::most), per_step(&Newton::jacobians), per_step(&Newton::backtracks),
                  known(&Newton::refreshed), known(&Newton::unconverged)});
}

/// A row of the table. @param first  choice that the ratios refer to
Json choice_json(const ComparedChoice& choice, const ComparedChoice& first, bool pin, bool newton) {
    const Trajectory& run = choice.run;
    Json row = named(
        "method,mean_step,steps,evaluations,transitions,evaluations_per_second,wall_seconds_per_second,fewer_by,faster_by,"
        "error_axial_force,error_tension,error_slip,error_losses",
        {choice.choice, choice.mean_step(), run.counters.steps, run.counters.evaluations, run.counters.detected,
         number_json(run.evaluations_per_second()), number_json(choice.median()),
         number_json(first.run.evaluations_per_second() / run.evaluations_per_second()), number_json(first.median() / choice.median()),
         number_json(choice.errors.axial_force), number_json(choice.errors.tension), number_json(choice.errors.slip),
         number_json(choice.errors.losses)});
    if (pin) row["error_pin"] = number_json(choice.pin_error);
    if (newton) row.update(newton_json(run.newton));
    row.update(watch_json(run.fault, run.watch));
    return row;
}

/// Force of a pin on the sheave at -z over the time since the start: of the reference and of each choice that came to the end.
Json force_json(const std::vector<ComparedChoice>& choices, const Trajectory& reference, int pin) {
    Json courses = Json::array();
    for (const ComparedChoice& choice : choices)
        if (!choice.run.fault) courses.push_back(Json::array({choice.choice, choice.run.pin_axial(pin, 0)}));
    return {{"times", reference.times}, {"reference", reference.pin_axial(pin, 0)}, {"choices", std::move(courses)}};
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

/// A state for runs to begin with, if the scene has none.
std::optional<engine::SavedState> settled(const CompareArguments& arguments, const tasks::Scene& scene) {
    tasks::Simulation simulation(scene);
    if (!simulation.needs_settling()) return std::nullopt;
    say(arguments.quiet, fmt::format("settling {} first", time_text(scene.parameters.start.settling_time)));
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
        say(arguments.quiet, fmt::format("round {} of {}", round + 1, arguments.rounds));
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
    if (run.fault || run.watch.reliable()) {
        if (run.fault) print_error(choice + ": " + run.fault.message());
        return;
    }
    print_error(fmt::format("{}: unreliable: the residual of the energy balance is {:.2g} times the tolerance", choice,
                            run.watch.balance_error_ratio));
}

Json results_of(const CompareArguments& arguments, const std::vector<ComparedChoice>& choices, const Trajectory& reference,
                const std::string& scene, const std::optional<PinEntry>& pin) {
    Json file = named("scene,provenance,reference,reference_watch,duration,interval,rounds",
                      {scene, provenance_json(), arguments.reference, watch_json({}, reference.watch), arguments.duration,
                       arguments.interval, arguments.rounds});
    if (pin) file["pin"] = pin->pin, file["entry"] = pin->time;
    for (const ComparedChoice& choice : choices)
        file["choices"].push_back(choice_json(choice, choices.front(), pin.has_value(), arguments.newton));
    const WatchResult& watch = reference.watch;
    return named(
        "file,transitions,schedule,asked_pin,force,compared_time,enough_pin_periods,enough_time",
        {file, reference.counters.detected, reference.schedule, arguments.pin, pin ? force_json(choices, reference, pin->pin) : Json(),
         watch.duration, enough_pin_periods, enough_pin_periods * watch.pin_period});
}

ExitStatus run_compare(const CompareArguments& arguments) try {
    for (const std::string& choice : arguments.choices) static_cast<void>(read_choice(choice));
    const LoadedScene loaded = load_scene(arguments.scene);
    say(arguments.quiet, loaded.notice);
    const engine::Cancellation& cancel = catch_interrupts();
    tasks::Scene scene = loaded.scene;
    if (scene.run.schedule == "auto") tasks::set_value(scene, "run.schedule=serial");
    MeasureSettings settings{read_time("--duration", arguments.duration), read_time("--interval", arguments.interval),
                             read_choice(arguments.reference)};
    require_pin(arguments.pin, scene.parameters.chain.pins);
    settings.start = settled(arguments, scene);
    const ErrorMeasure measure(scene, settings, cancel);
    const std::optional<PinEntry> pin = pin_of(arguments.pin, measure.reference(), scene.parameters);
    complain("the reference, " + arguments.reference, measure.reference());
    std::vector<ComparedChoice> choices = measure_all(arguments, measure, cancel);
    if (choices.empty()) return ExitStatus::cancelled;
    for (ComparedChoice& choice : choices) {
        if (pin) choice.pin_error = pin_error(choice.run, measure.reference(), pin->pin);
        complain(choice.choice, choice.run);
    }
    show("compare", results_of(arguments, choices, measure.reference(), scene.name, pin), arguments.output);
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
