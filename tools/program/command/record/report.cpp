#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>

#include "engine/base/text.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/html/page.hpp"
#include "tools/program/output.hpp"
#include "tools/program/program.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

namespace {

struct ReportArguments {
    std::vector<std::string> files;
    std::string output, with;
    bool force = false;
};

/// The page shows what was recorded; the chain needs the machine as well.
void warn_without_machine(const RecordedRun& run, const std::string& file) {
    const auto* text = engine::attribute_value<std::string>(run.reader().attributes(), "parameters");
    if (text == nullptr || run.scene()) return;
    try {
        static_cast<void>(tasks::parse_scene(*text, "scene", tasks::StartState::recorded));
    } catch (const tasks::SceneError& error) {
        to_stderr(fmt::format("{}: {}: the page shows no chain: cannot read the parameters of its machine: {}\n", program_name(), file,
                              error.what()));
    }
}

struct MadePage {
    std::string text, of;  ///< of: name of the scene or sweep
};

/// @param measured nullptr: none
MadePage page_of(const std::vector<std::string>& files, const Measured* measured) {
    if (is_sweep(files.front())) {
        if (files.size() > 1) throw UsageError("a report covers one sweep, or one or more records");
        const SweepView sweep = read_sweep(files.front());
        return {sweep_page(sweep, measured), sweep.name};
    }
    std::vector<RecordedRun> runs;
    for (const std::string& file : files) {
        runs.emplace_back(file);
        warn_without_machine(runs.back(), file);
    }
    return {run_page(runs, measured), runs.front().name()};
}

ExitStatus report(const ReportArguments& arguments) {
    const std::string path = picture_path(arguments.output, arguments.files.front(), "report.html");
    std::vector<std::string> files = arguments.files;
    if (!arguments.with.empty()) files.push_back(arguments.with);
    const std::vector<std::filesystem::path> inputs = read_files(files);
    engine::require_no_input(path, inputs);
    const std::optional<Measured> measured = arguments.with.empty() ? std::nullopt : std::optional(read_measured(arguments.with));
    const MadePage page = page_of(arguments.files, measured ? &*measured : nullptr);
    engine::write_whole({path, marked_rule("page", page.of, inputs, arguments.force)}, marked(page.text, mark_of("page", page.of)));
    fmt::print("{} ({})\n", engine::visible(path), size_text(static_cast<double>(page.text.size())));
    return ExitStatus::finished;
}

}  // namespace

Action declare_report(CLI::App& app) {
    const auto arguments = std::make_shared<ReportArguments>();
    app.add_option("FILE", arguments->files, "Records (several are compared), or one sweep (its folder, cases.h5, or CSV)")
        ->required()
        ->type_name("...");
    app.add_option("-o,--output", arguments->output, "Page to write (default: beside the input, .html)")->type_name("FILE");
    app.add_option("--with", arguments->with, "Measured data beside the results: a CSV as plot --with takes it")->type_name("FILE");
    app.add_flag_callback("--si", show_si, si_meaning);
    app.add_flag("--force", arguments->force, force_meaning);
    app.footer(
        "The page is one file and needs no network: status and warnings, differences of several records, key figures, scene, curves,\n"
        "running chain, tip forces, losses, spectra, provenance. A page of the same scene or sweep is replaced, any other file only with "
        "--force. Long records are thinned "
        "to minima and maxima, and the page states it.");
    return [arguments] { return report(*arguments); };
}

}  // namespace cvtflow::tools
