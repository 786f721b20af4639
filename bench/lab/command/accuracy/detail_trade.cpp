/// cvtflow-lab detail: what each dial of detail, or each level, costs and what it changes.

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
    app.add_option("--step", arguments->step, "Its step, or \"auto\"")->type_name("TIME")->capture_default_str();
    app.add_option("--settle", arguments->settle, "How long each variant settles: strands and shafts swing into the new detail")
        ->type_name("TIME")
        ->capture_default_str();
    app.add_option("--average", arguments->average, "How long it is averaged; slip and efficiency need 16 pin periods")
        ->type_name("TIME")
        ->capture_default_str();
    app.add_option("--control", arguments->control, "How long ratio control looks for the thrust ratio (\"0 s\": not)")
        ->type_name("TIME")
        ->capture_default_str();
    CLI::Option* all = app.add_flag("--all", arguments->all, "Every combination of the dials of halves (48) instead of one dial at a time");
    app.add_flag("--rungs", arguments->rungs,
                 "The levels of cvtflow list detail, each with its own step, against the finest one at a quarter of its step;\n"
                 "without SCENE at seven operating points: three ratios, three loads, a shift, a ramp of the load")
        ->excludes(all);
    declare_output(app, arguments->output);
    app.footer(
        "Each variant starts from the scene's settled state at full detail, brought over to its own coordinates.\n"
        "What the energy balance calls unreliable has a status and no figures.\n"
        "Exit status 1: full detail breaks down or is unreliable; 5: other variants are (stderr says why).");
    return [arguments] {
        if (arguments->rungs) return report_ladder(*arguments, arguments->output);
        if (arguments->scenes.empty()) arguments->scenes = {"baseline", "low", "overdrive"};
        return report_details(*arguments, arguments->output);
    };
}

}  // namespace cvtflow::bench
