#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "tools/program/command/command.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/html/run_page.hpp"
#include "tools/program/html/sweep_page.hpp"
#include "tools/program/output/output_place.hpp"
#include "tools/program/output/text_file.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

namespace {

struct ReportArguments {
    std::vector<std::string> files;
    std::string output;
};

std::string page_of(const std::vector<std::string>& files) {
    if (is_sweep(files.front())) {
        if (files.size() > 1) throw UsageError("a report is of one sweep, or of records");
        return sweep_page(read_sweep(files.front()));
    }
    std::vector<RecordedRun> runs;
    for (const std::string& file : files) runs.emplace_back(file);
    return run_page(runs);
}

/// Beside what is reported, unless the user says where.
std::string report_path(const ReportArguments& arguments) {
    if (!arguments.output.empty()) return arguments.output;
    std::filesystem::path path(arguments.files.front());
    if (std::filesystem::is_directory(path)) return (path / "report.html").string();
    return path.replace_extension(".html").string();
}

ExitStatus report(const ReportArguments& arguments) {
    const std::string path = report_path(arguments);
    require_no_input(path, {arguments.files.begin(), arguments.files.end()});
    const std::string page = page_of(arguments.files);
    write_text(path, page);
    fmt::print("{} ({})\n", path, size_text(static_cast<double>(page.size())));
    return ExitStatus::finished;
}

}  // namespace

Action declare_report(CLI::App& app) {
    const auto arguments = std::make_shared<ReportArguments>();
    app.add_option("FILE", arguments->files, "A record, several to compare, or a sweep (its folder, cases.h5, or CSV)")
        ->required()
        ->type_name("...");
    app.add_option("-o,--output", arguments->output, "Page to write (default: beside FILE, .html)")->type_name("FILE");
    app.footer(
        "One file that any browser opens without a network: status and warnings first, what was simulated, key figures, curves, the "
        "running\n"
        "chain, spectra, losses, tip forces, provenance. Long records are thinned by least and largest values, and the page says so.");
    return [arguments] { return report(*arguments); };
}

}  // namespace cvtflow::tools
