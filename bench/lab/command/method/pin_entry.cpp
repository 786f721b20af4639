#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "bench/lab/command/command.hpp"
#include "bench/lab/measure/settled_start.hpp"
#include "bench/lab/report/comparison_report.hpp"
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

struct PinEntryArguments {
    SceneArguments scene;
    OutputArguments output;
    std::vector<std::string> candidates;
    std::string reference = "rk4@12.5ns", duration = "1ms", interval = "12us";
    int rounds = 3;
    std::optional<int> pin;
    bool quiet = false;
};

void write_files(OutputFolder& folder, const std::string& scene, const Comparison& comparison, const ComparisonOptions& options) {
    folder.write("comparison.csv", comparison_csv(comparison, options));
    folder.write("comparison.json", comparison_json(scene, comparison, options));
    if (!comparison.pin) return;
    folder.write("pin-force.csv", pin_csv(comparison));
    folder.write("pin-force.svg", svg(pin_plot(scene, comparison)));
    folder.write("pin-force-error.svg", svg(pin_error_plot(scene, comparison)));
}

ExitStatus pin_entry(const PinEntryArguments& arguments) {
    std::vector<Candidate> candidates;
    for (const std::string& text : arguments.candidates) candidates.push_back(read_candidate(text));
    ComparisonOptions options;
    options.reference = read_candidate(arguments.reference);
    options.duration = read_time("--time", arguments.duration);
    options.output_interval = read_time("--interval", arguments.interval);
    options.rounds = arguments.rounds;
    options.pin = arguments.pin;
    const LoadedScene loaded = load_scene(arguments.scene);
    const tasks::Scene& scene = loaded.scene;
    if (options.pin >= scene.parameters.chain.pins)
        throw UsageError(fmt::format("--pin {}: the chain has pins 0 to {}", *options.pin, scene.parameters.chain.pins - 1));
    if (!arguments.quiet) {
        options.progress = [](const std::string& what) { print_error(what); };
        if (!loaded.notice.empty()) options.progress(loaded.notice);
    }
    const tasks::FrozenStart start = settled_start(scene, arguments.scene.settle, "comparisons");
    const engine::Cancellation& cancel = catch_interrupts();
    const Comparison comparison = compare(scene.parameters, start, candidates, options, cancel);
    if (cancel.requested()) return ExitStatus::cancelled;
    OutputFolder folder(arguments.output);
    write_files(folder, scene.name, comparison, options);
    fmt::print("{}: {} from t = {}, against {}; one thread, medians of {}, alternating\n", scene.name, time_text(options.duration),
               time_text(start.time), candidate_name(options.reference), plural(options.rounds, "round"));
    fmt::print("{}\n{}",
               !comparison.pin
                   ? std::string("  no pin enters the driving sheaves in this time\n")
                   : field("pin", fmt::format("{}, enters the driving sheaves at {}", *comparison.pin, time_text(comparison.entry))),
               comparison_table(comparison, options));
    const std::string brief = too_short(comparison.reference_watch);
    if (!brief.empty()) fmt::print("{}", field("too short", brief));
    if (!comparison.reference_watch.reliable()) print_error("the reference is " + unreliable_remark({}, comparison.reference_watch));
    if (!folder.written().empty()) fmt::print("\n{}", folder.written());
    return ExitStatus::finished;
}

constexpr const char* pin_entry_explanation =
    "All candidates start from the same state and run with transitions. fewer by, faster by: evaluations and time of the first candidate "
    "divided\nby those of this one. err: ‖value - reference‖/‖reference‖ over all outputs, for the axial force of all tips, the tension of "
    "all links, and the\naxial force of the pin that enters the driving sheaves first (or --pin). Steps are shortened to divide the "
    "interval. METHOD@auto: automatic\nsteps; the table shows the last one; the first milliseconds take longer because steps are chosen "
    "there. residual: residual of the energy\nbalance over the losses; runs whose balance does not close are unreliable, whatever their "
    "errors.\n"
    "Example: cvtflow-lab pin-entry baseline rk4@50ns dumka3-p5@2us dumka3-p7@3us -o results/speed";

}  // namespace

Action declare_pin_entry(CLI::App& app) {
    const auto arguments = std::make_shared<PinEntryArguments>();
    declare_scene(app, arguments->scene);
    app.add_option("METHOD@STEP", arguments->candidates, "Methods with their steps; speed-ups refer to the first")
        ->required()
        ->type_name("");
    app.add_option("--time", arguments->duration, "Simulated time")->type_name("TIME")->capture_default_str();
    app.add_option("--interval", arguments->interval, "Time between outputs")->type_name("TIME")->capture_default_str();
    app.add_option("--reference", arguments->reference, "Reference of the errors")->type_name("METHOD@STEP")->capture_default_str();
    app.add_option("--rounds", arguments->rounds, "Rounds of timing; 0: none")
        ->type_name("N")
        ->check(CLI::Range(0, 1000))
        ->capture_default_str();
    app.add_option("--pin", arguments->pin, "Pin whose force is compared (default: the first that enters the driving sheaves)")
        ->type_name("N")
        ->check(CLI::NonNegativeNumber);
    declare_fresh_start(app, arguments->scene);
    declare_output(app, arguments->output);
    app.add_flag("-q,--quiet", arguments->quiet, "No progress; results are printed all the same");
    app.footer(pin_entry_explanation);
    return [arguments] { return pin_entry(*arguments); };
}

}  // namespace cvtflow::bench
