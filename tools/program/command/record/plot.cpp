#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string>

#include "tools/program/arguments.hpp"
#include "tools/program/command/command.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/view/run_plots.hpp"
#include "tools/program/view/sweep_view.hpp"
#include "tools/program/view/wear_plots.hpp"

namespace cvtflow::tools {

namespace {

struct PlotArguments {
    std::vector<std::string> words;
    std::string output, x, y, colour;
    std::vector<std::string> where;
    bool orders = false, round = false, losses = false, wear = false, every_output = false, force = false;
};

/// Files come first, then channels.
struct PlotWords {
    std::vector<std::string> files, channels;
};

PlotWords sorted_words(const std::vector<std::string>& words) {
    PlotWords sorted;
    for (const std::string& word : words) {
        std::error_code unknown;
        const bool file = sorted.files.empty() || (sorted.channels.empty() && std::filesystem::exists(word, unknown));
        (file ? sorted.files : sorted.channels).push_back(word);
    }
    return sorted;
}

std::vector<Plot> plots_of_runs(const PlotArguments& arguments, const PlotWords& words, std::string& of) {
    if (!arguments.x.empty() || !arguments.y.empty() || !arguments.colour.empty() || !arguments.where.empty())
        throw UsageError("--x, --y, --colour and --where are for sweeps; " + words.files.front() + " is not a sweep");
    std::vector<RecordedRun> runs;
    for (const std::string& file : words.files) runs.emplace_back(file);
    of = runs.front().name();
    if (arguments.wear && runs.size() > 1) throw UsageError("--wear draws one record");
    if (arguments.wear) return wear_plots(runs.front());
    if (arguments.round) return {round_plot(runs)};
    if (arguments.orders) return order_plots(runs, words.channels);
    if (!arguments.losses) return time_plots(runs, words.channels, arguments.every_output);
    std::vector<Plot> plots;
    for (const RecordedRun& run : runs) plots.push_back(loss_plot(run, arguments.every_output));
    return plots;
}

/// @param of receives the name of the sweep, or of the scene above
std::vector<Plot> plots_of_sweeps(const PlotArguments& arguments, const PlotWords& words, std::string& of) {
    if (arguments.orders || arguments.round || arguments.losses || arguments.wear || !words.channels.empty())
        throw UsageError("channels, --orders, --round, --losses and --wear are for records; " + words.files.front() + " is a sweep");
    if (arguments.x.empty() || arguments.y.empty())
        throw UsageError("a sweep needs --x COLUMN and --y COLUMN; cvtflow table shows its columns");
    std::vector<Plot> plots;
    for (const std::string& file : words.files) {
        SweepView sweep = read_sweep(file);
        if (of.empty()) of = sweep.name;
        for (const std::string& condition : arguments.where) sweep.keep(condition);
        plots.push_back(arguments.colour.empty() ? sweep_curves(sweep, arguments.x, arguments.y)
                                                 : sweep_map(sweep, arguments.x, arguments.y, arguments.colour));
        for (const std::string& condition : arguments.where) plots.back().subtitle += ", " + condition;
    }
    return plots;
}

ExitStatus plot(const PlotArguments& arguments) {
    const PlotWords words = sorted_words(arguments.words);
    const std::string path = picture_path(arguments.output, words.files.front(), "plot.svg");
    const std::string kind = std::filesystem::path(path).extension().string();
    if (kind != ".svg" && kind != ".png" && kind != ".csv")
        throw UsageError(fmt::format("-o {}: expected FILE.svg, FILE.png or FILE.csv", path));
    const std::vector<std::filesystem::path> inputs = read_files(words.files);
    engine::require_no_input(path, inputs);
    std::string of;
    const std::vector<Plot> plots =
        is_sweep(words.files.front()) ? plots_of_sweeps(arguments, words, of) : plots_of_runs(arguments, words, of);
    if (plots.empty()) throw UsageError("nothing to draw: name a channel (cvtflow info " + words.files.front() + ")");
    const std::string text = kind == ".csv" ? csv(plots) : marked(svg(plots), mark_of("picture", of));
    engine::OutputRule rule = kind == ".csv" ? engine::OutputRule{.named = true, .devices = true} : marked_rule("picture", of);
    rule.inputs = inputs;
    rule.force = arguments.force;
    const engine::Permit permit(path, rule);
    engine::write_whole(permit, kind == ".png" ? png_of(path, text, mark_of("picture", of)) : text);
    fmt::print("{}\n", path);
    return ExitStatus::finished;
}

}  // namespace

Action declare_plot(CLI::App& app) {
    const auto arguments = std::make_shared<PlotArguments>();
    app.add_option("FILE", arguments->words, "Records or sweeps, then channels or groups of channels (default: channels without a group)")
        ->required()
        ->type_name("... [CHANNEL ...]");
    app.add_option("-o,--output", arguments->output,
                   "Picture or table to write: FILE.svg, FILE.png or FILE.csv (default: beside the input, .svg)")
        ->type_name("FILE");
    app.add_flag("--orders", arguments->orders, "Draw amplitudes over orders of the pin passing frequency");
    app.add_flag("--every-output", arguments->every_output,
                 "Draw every output, also for more than 60 pin periods (default then: means over each period)");
    app.add_flag("--round", arguments->round, "Draw quantities of the followed pin around the chain's path");
    app.add_flag("--losses", arguments->losses, "Draw losses by kind, with means and shares");
    app.add_flag("--wear", arguments->wear, "Draw wear over the sheaves' radii and over the tips (record.channels = wear/*)");
    app.add_option("--x", arguments->x, "Sweeps: column along the horizontal axis")->type_name("COLUMN");
    app.add_option("--y", arguments->y, "Sweeps: column along the vertical axis")->type_name("COLUMN");
    app.add_option("--colour", arguments->colour, "Sweeps: column drawn as a map with contours")->type_name("COLUMN");
    declare_repeated(app, "--where", arguments->where, "Sweeps: only cases with that value; may be repeated", "COLUMN=VALUE");
    app.add_flag("--force", arguments->force, force_meaning);
    app.footer(
        "cvtflow plot run.h5 slip efficiency          cvtflow plot a.h5 b.h5 shaft_1/speed   (both in one picture)\n"
        "cvtflow plot run.h5 'tips/axial_force[7]'    cvtflow plot run.h5 tight_tension --orders -o orders.png\n"
        "cvtflow plot SWEEP --x load.torque --y start.ratio --colour slip_mean --where clamping.driven=20000\n"
        "For channels of more than four numbers, minimum, mean and maximum are drawn. PNG requires rsvg-convert (librsvg2-bin).\n"
        "A picture of the same scene or sweep is replaced, any other file only with --force.");
    return [arguments] { return plot(*arguments); };
}

}  // namespace cvtflow::tools
