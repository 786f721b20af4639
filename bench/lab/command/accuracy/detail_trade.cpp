/// cvtflow-lab detail: cost and errors of each key of detail, or of each level.

#include <CLI/CLI.hpp>
#include <memory>

#include "bench/lab/command/command.hpp"
#include "bench/lab/report/detail_report.hpp"
#include "bench/lab/report/ladder_report.hpp"

namespace cvtflow::bench {

using namespace tools;

Action declare_detail(CLI::App& app) {
    struct Arguments : DetailArguments {
        OutputArguments output;
    };
    const auto arguments = std::make_shared<Arguments>();
    app.add_option("SCENE", arguments->scenes, "Scenes with settled states of full detail (default: baseline low overdrive)");
    app.add_option("--set", arguments->settings, "Change a key of the scenes")->type_name("KEY=VALUE");
    app.add_option("--method", arguments->method, "Method of integration")->type_name("NAME")->capture_default_str();
    app.add_option("--step", arguments->step, "Step, or \"auto\"")->type_name("TIME")->capture_default_str();
    app.add_option("--settle", arguments->settle, "Settling time of each variant, in which strands and shafts adapt to its detail")
        ->type_name("TIME")
        ->capture_default_str();
    app.add_option("--average", arguments->average, "Time that averages cover; slip and efficiency require 16 pin periods")
        ->type_name("TIME")
        ->capture_default_str();
    app.add_option("--control", arguments->control, "Time that ratio control has to find the thrust ratio (\"0 s\": no search)")
        ->type_name("TIME")
        ->capture_default_str();
    CLI::Option* all =
        app.add_flag("--all", arguments->all, "Every combination of detail with pin halves (48) instead of one change at a time");
    app.add_flag("--levels", arguments->levels,
                 "The levels of cvtflow list detail, each at its automatic step; reference: the finest level at a quarter of its step.\n"
                 "Without SCENE at seven operating points: three ratios, three loads, a shift, a ramp of the load")
        ->excludes(all);
    declare_output(app, arguments->output);
    app.footer(
        "Each variant starts from the scene's settled state at full detail, converted to its coordinates.\n"
        "Unreliable variants (energy balance) have a status and no figures.\n"
        "Exit status 1: full detail fails or is unreliable; 5: other variants do (stderr states the reason).");
    return [arguments] {
        if (arguments->levels) return report_ladder(*arguments, arguments->output);
        if (arguments->scenes.empty()) arguments->scenes = {"baseline", "low", "overdrive"};
        return report_details(*arguments, arguments->output);
    };
}

}  // namespace cvtflow::bench
