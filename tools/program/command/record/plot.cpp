#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zlib.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>

#include "engine/base/text.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/output.hpp"
#include "tools/program/program.hpp"
#include "tools/program/text/text.hpp"
#include "tools/program/view/run_plots.hpp"
#include "tools/program/view/sweep_view.hpp"

extern char** environ;

namespace cvtflow::tools {

namespace {

struct PlotArguments {
    std::vector<std::string> words;
    std::string output, x, y, colour, with;
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

std::optional<Measured> measured_of(const PlotArguments& arguments) {
    return arguments.with.empty() ? std::nullopt : std::optional(read_measured(arguments.with));
}

std::vector<Plot> plots_of_runs(const PlotArguments& arguments, const PlotWords& words, std::string& of) {
    if (!arguments.y.empty() || !arguments.colour.empty() || !arguments.where.empty())
        throw UsageError("--y, --colour and --where are for sweeps; " + words.files.front() + " is not a sweep");
    std::vector<RecordedRun> runs;
    for (const std::string& file : words.files) runs.emplace_back(file);
    of = runs.front().name();
    const std::optional<Measured> measured = measured_of(arguments);
    if ((measured || !arguments.x.empty()) && (arguments.wear || arguments.round || arguments.orders || arguments.losses))
        throw UsageError("--with and --x are for curves of channels, and for sweeps");
    if (arguments.wear && runs.size() > 1) throw UsageError("--wear draws one record");
    if (arguments.wear) return wear_plots(runs.front());
    if (arguments.round) return {round_plot(runs)};
    if (arguments.orders) return order_plots(runs, words.channels);
    if (!arguments.losses) return time_plots(runs, words.channels, arguments.every_output, measured ? &*measured : nullptr, arguments.x);
    std::vector<Plot> plots;
    for (const RecordedRun& run : runs) plots.push_back(loss_plot(run));
    return plots;
}

/// @param of receives the name of the sweep, or of the scene above
std::vector<Plot> plots_of_sweeps(const PlotArguments& arguments, const PlotWords& words, std::string& of) {
    if (arguments.orders || arguments.round || arguments.losses || arguments.wear || !words.channels.empty())
        throw UsageError("channels, --orders, --round, --losses and --wear are for records; " + words.files.front() + " is a sweep");
    if (arguments.x.empty() || arguments.y.empty())
        throw UsageError("a sweep needs --x COLUMN and --y COLUMN; cvtflow table shows its columns");
    const std::optional<Measured> measured = measured_of(arguments);
    if (measured && !arguments.colour.empty()) throw UsageError("--with adds points to curves, not to a map (--colour)");
    std::vector<Plot> plots;
    for (const std::string& file : words.files) {
        SweepView sweep = read_sweep(file);
        if (of.empty()) of = sweep.name;
        for (const std::string& condition : arguments.where) sweep.keep(condition);
        plots.push_back(arguments.colour.empty() ? sweep_curves(sweep, arguments.x, arguments.y, measured ? &*measured : nullptr)
                                                 : sweep_map(sweep, arguments.x, arguments.y, arguments.colour));
        for (const std::string& condition : arguments.where) plots.back().subtitle += ", " + condition;
    }
    return plots;
}

using TemporaryFile = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

/// An anonymous temporary file that contains the text, positioned at its beginning.
TemporaryFile file_with(const std::string& text) {
    TemporaryFile file(std::tmpfile(), std::fclose);
    if (!file || std::fwrite(text.data(), 1, text.size(), file.get()) != text.size() || std::fflush(file.get()) != 0)
        throw std::runtime_error(fmt::format("cannot write a temporary file: {}", std::strerror(errno)));
    std::rewind(file.get());
    return file;
}

std::string contents_of(std::FILE* file) {
    std::rewind(file);
    std::string bytes;
    char block[65536];
    for (std::size_t count = 0; (count = std::fread(block, 1, sizeof block, file)) > 0;) bytes.append(block, count);
    return bytes;
}

std::string big_endian(std::uint32_t number) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(number >> shift & 0xFFU);
    return bytes;
}

/// A text behind the first chunk, which the format fixes at 33 bytes.
std::string with_text(std::string png, const std::string& text) {
    constexpr std::size_t behind_header = 33;
    if (png.size() < behind_header) return png;
    const std::string chunk = "tEXtSoftware" + std::string(1, '\0') + text;
    const auto sum = crc32(0, reinterpret_cast<const Bytef*>(chunk.data()), static_cast<uInt>(chunk.size()));
    png.insert(behind_header,
               big_endian(static_cast<std::uint32_t>(chunk.size() - 4)) + chunk + big_endian(static_cast<std::uint32_t>(sum)));
    return png;
}

/// A picture as PNG, by rsvg-convert, with a text chunk that contains `mark`. @param path in messages
/// @throws std::runtime_error if rsvg-convert is missing (names the package) or fails
std::string png_of(const std::string& path, const std::string& svg, const std::string& mark) {
    const TemporaryFile input = file_with(svg), output = file_with("");
    std::string program = "rsvg-convert", format = "--format=png", zoom = "--zoom=2";
    char* words[] = {program.data(), format.data(), zoom.data(), nullptr};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, fileno(input.get()), STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, fileno(output.get()), STDOUT_FILENO);
    pid_t child = -1;
    const int failed = posix_spawnp(&child, words[0], &actions, nullptr, words, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failed == ENOENT)
        throw std::runtime_error(path +
                                 ": PNG requires the program rsvg-convert (Debian: apt-get install librsvg2-bin); SVG and CSV do not");
    if (failed != 0) throw std::runtime_error(fmt::format("{}: cannot run rsvg-convert: {}", path, std::strerror(failed)));
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
    std::string png = contents_of(output.get());
    if (status != 0 || png.empty()) throw std::runtime_error(path + ": rsvg-convert could not make it");
    return with_text(std::move(png), mark);
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
    std::string of;
    const std::vector<Plot> plots =
        is_sweep(words.files.front()) ? plots_of_sweeps(arguments, words, of) : plots_of_runs(arguments, words, of);
    if (plots.empty()) throw UsageError("nothing to draw: name a channel (cvtflow info " + words.files.front() + ")");
    const std::string text = kind == ".csv" ? csv(plots) : marked(svg(plots), mark_of("picture", of));
    const engine::Permit permit(path, kind == ".csv"
                                          ? engine::OutputRule{.inputs = inputs, .force = arguments.force, .named = true, .devices = true}
                                          : marked_rule("picture", of, inputs, arguments.force));
    engine::write_whole(permit, kind == ".png" ? png_of(path, text, mark_of("picture", of)) : text);
    fmt::print("{}\n", engine::visible(path));
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
    app.add_flag_callback("--si", show_si, si_meaning);
    app.add_flag("--force", arguments->force, force_meaning);
    app.footer(
        "cvtflow plot run.h5 slip efficiency          cvtflow plot a.h5 b.h5 shaft_1/speed   (both in one picture)\n"
        "cvtflow plot run.h5 'tips/axial_force[7]'    cvtflow plot run.h5 tight_tension --orders -o orders.png\n"
        "cvtflow plot SWEEP --x load.torque --y start.ratio --colour slip_mean --where clamping.driven=20000\n"
        "cvtflow plot run.h5 --x ratio slip           cvtflow plot run.h5 --x shaft_1/speed efficiency tight_tension\n"
        "cvtflow plot run.h5 slip --with bench.csv    cvtflow plot SWEEP --x load.torque --y efficiency --with bench.csv\n"
        "For channels of more than four numbers, minimum, mean and maximum are drawn. PNG requires rsvg-convert (librsvg2-bin).\n"
        "A picture of the same scene or sweep is replaced, any other file only with --force.");
    return [arguments] { return plot(*arguments); };
}

}  // namespace cvtflow::tools
