#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "bench/lab/command/command.hpp"
#include "bench/lab/report/compare_report.hpp"
#include "bench/lab/text/text.hpp"
#include "bench/method/implicit/catalogue.hpp"
#include "bench/method/implicit/linear_plan.hpp"
#include "tasks/run/run.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

struct CompareArguments {
    SceneArguments scene;
    std::vector<std::string> choices;
    std::string reference = "rk4@12.5ns", duration = "240us", interval = "12us", pin;
    int rounds = 3;
    bool newton = false, quiet = false;
    OutputArguments output;
};

const std::vector<std::string> usual_choices{"rk4@50ns", "dumka3-p5@2us", "dumka3-p7@3us", "leapfrog-chebyshev@auto",
                                             "leapfrog-sweep@auto"};
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
