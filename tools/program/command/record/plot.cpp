#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/base/text.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/drawing.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/program.hpp"
#include "tools/program/text/text.hpp"
#include "tools/program/view/described.hpp"

namespace cvtflow::tools {

namespace {

using Json = nlohmann::json;

struct PlotArguments {
    std::vector<std::string> words;
    std::string output, x, y, colour, with;
    std::vector<std::string> where;
    bool orders = false, round = false, losses = false, wear = false, every_output = false, si = false, force = false;
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

Json records_of(const PlotArguments& arguments, const PlotWords& words) {
    if (!arguments.y.empty() || !arguments.colour.empty() || !arguments.where.empty())
        throw UsageError("--y, --colour and --where are for sweeps; " + words.files.front() + " is not a sweep");
    if ((!arguments.with.empty() || !arguments.x.empty()) && (arguments.wear || arguments.round || arguments.orders || arguments.losses))
        throw UsageError("--with and --x are for curves of channels, and for sweeps");
    Json records = Json::array();
    for (const std::string& file : words.files) records.push_back(described(RecordedRun(file)));
    return records;
}

Json sweeps_of(const PlotArguments& arguments, const PlotWords& words) {
    if (arguments.orders || arguments.round || arguments.losses || arguments.wear || !words.channels.empty())
        throw UsageError("channels, --orders, --round, --losses and --wear are for records; " + words.files.front() + " is a sweep");
    if (arguments.x.empty() || arguments.y.empty())
        throw UsageError("a sweep needs --x COLUMN and --y COLUMN; cvtflow table shows its columns");
    if (!arguments.with.empty() && !arguments.colour.empty()) throw UsageError("--with adds points to curves, not to a map (--colour)");
    Json sweeps = Json::array();
    for (const std::string& file : words.files) {
        SweepView sweep = read_sweep(file);
        for (const std::string& condition : arguments.where) sweep.keep(condition);
        sweeps.push_back(described(sweep));
    }
    return sweeps;
}

/// The drawing function of the package, and its options.
Json request_of(const PlotArguments& arguments, const PlotWords& words) {
    const bool sweep = is_sweep(words.files.front());
    const std::pair<bool, const char*> kinds[] = {{!arguments.colour.empty(), "map"}, {sweep, "cases"},
                                                  {arguments.wear, "wear"},           {arguments.round, "round"},
                                                  {arguments.orders, "orders"},       {arguments.losses, "losses"}};
    const auto* kind = std::ranges::find(kinds, true, &std::pair<bool, const char*>::first);
    Json request{{"command", "plot"},
                 {"known", known_json()},
                 {"kind", kind == std::end(kinds) ? "curves" : kind->second},
                 {"options",
                  {{"channels", words.channels},
                   {"x", arguments.x},
                   {"y", arguments.y},
                   {"colour", arguments.colour},
                   {"where", arguments.where},
                   {"every_output", arguments.every_output},
                   {"si", arguments.si}}}};
    request[sweep ? "sweeps" : "records"] = sweep ? sweeps_of(arguments, words) : records_of(arguments, words);
    if (!arguments.with.empty()) request["with"] = described(read_measured(arguments.with));
    return request;
}

ExitStatus plot(const PlotArguments& arguments) {
    const PlotWords words = sorted_words(arguments.words);
    const std::string path = picture_path(arguments.output, words.files.front(), "plot.svg");
    const std::string kind = std::filesystem::path(path).extension().string();
    if (kind != ".svg" && kind != ".png" && kind != ".csv")
        throw UsageError(fmt::format("-o {}: expected FILE.svg, FILE.png or FILE.csv", path));
    std::vector<std::string> files = words.files;
    if (!arguments.with.empty()) files.push_back(arguments.with);
    const std::vector<std::filesystem::path> inputs = read_files(files);
    engine::require_no_input(path, inputs);
    Json request = request_of(arguments, words);
    const std::string of = subject_of(request);
    request["format"] = kind.substr(1);
    request["mark"] = mark_of("picture", of);
    const engine::Permit permit(path, kind == ".csv"
                                          ? engine::OutputRule{.inputs = inputs, .force = arguments.force, .named = true, .devices = true}
                                          : marked_rule("picture", of, inputs, arguments.force));
    engine::write_whole(permit, drawn(request));
    fmt::print("{}\n", engine::visible(path));
    return ExitStatus::finished;
}

}  // namespace

Action declare_plot(CLI::App& app) {
    const auto arguments = std::make_shared<PlotArguments>();
    with_default_place(app.add_option("FILE", arguments->words,
                                      "Records or sweeps, then channels or groups of channels (default: channels without a group)"),
                       true)
        ->required()
        ->type_name("... [CHANNEL ...]");
    app.add_option("-o,--output", arguments->output,
                   "Picture or table to write: FILE.svg, FILE.png or FILE.csv (default: beside the input, .svg)")
        ->type_name("FILE");
    app.add_flag("--orders", arguments->orders, "Draw amplitudes over orders of the pin passing frequency");
    app.add_flag("--every-output", arguments->every_output,
                 "Draw every output, also for more than 60 pin periods (default then, but for lengths: means over each period)");
    app.add_flag("--round", arguments->round, "Draw quantities of the followed pin around the chain's path");
    app.add_flag("--losses", arguments->losses, "Draw mean losses by kind as bars with their shares; over time: cvtflow plot FILE loss");
    app.add_flag("--wear", arguments->wear, "Draw wear over the sheaves' radii and over the tips (record.channels = wear/*)");
    app.add_option("--x", arguments->x, "Along the horizontal axis: column of a sweep, or channel of a record instead of time")
        ->type_name("COLUMN");
    app.add_option("--y", arguments->y, "Sweeps: column along the vertical axis")->type_name("COLUMN");
    app.add_option("--colour", arguments->colour, "Sweeps: column drawn as a map with contours")->type_name("COLUMN");
    app.add_option("--with", arguments->with, "Measured data as points: a CSV with headings such as \"time [ms]\", \"slip [%]\"")
        ->type_name("FILE");
    declare_repeated(app, "--where", arguments->where, "Sweeps: only cases with that value; may be repeated", "COLUMN=VALUE");
    app.add_flag("--si", arguments->si, si_meaning);
    app.add_flag("--force", arguments->force, force_meaning);
    app.footer(
        "cvtflow plot run.h5 slip efficiency          cvtflow plot a.h5 b.h5 shaft_1/speed   (both in one picture)\n"
        "cvtflow plot run.h5 'tips/axial_force[7]'    cvtflow plot run.h5 tight_tension --orders -o orders.png\n"
        "cvtflow plot SWEEP --x load.torque --y start.ratio --colour slip_mean --where clamping.driven=20000\n"
        "cvtflow plot run.h5 --x ratio slip           cvtflow plot run.h5 --x shaft_1/speed efficiency tight_tension\n"
        "cvtflow plot run.h5 slip --with bench.csv    cvtflow plot SWEEP --x load.torque --y efficiency --with bench.csv\n"
        "For channels of more than four numbers, minimum, mean and maximum are drawn.\n"
        "A picture of the same scene or sweep is replaced, any other file only with --force.");
    return [arguments] { return plot(*arguments); };
}

}  // namespace cvtflow::tools
