#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "tools/program/command/command.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/text/batch_text.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

namespace {

constexpr std::size_t named_cases = 20, named_shards = 5;

std::string missing_text(const tasks::MergeReport& report) {
    std::string text;
    const auto shards = report.missing_shards.size();
    const std::vector<std::string> named(report.missing_shards.begin(),
                                         report.missing_shards.begin() + static_cast<std::ptrdiff_t>(std::min(named_shards, shards)));
    for (const std::string& shard : named) text += fmt::format("cvtflow: {}: this shard has no results\n", shard);
    if (shards > named_shards) text += fmt::format("cvtflow: … and {} more; {} shards have no results\n", shards - named_shards, shards);
    if (report.missing_cases.empty()) return text;
    const std::vector<long> first(
        report.missing_cases.begin(),
        report.missing_cases.begin() + static_cast<std::ptrdiff_t>(std::min(named_cases, report.missing_cases.size())));
    return text + fmt::format("cvtflow: {} of {} cases are missing: {}{}\n", report.missing_cases.size(), report.cases,
                              fmt::join(first, ", "), report.missing_cases.size() > named_cases ? ", …" : "");
}

ExitStatus merge(const std::string& folder, bool partial, bool mixed) {
    const tasks::MergeReport report = tasks::merge(folder, partial, mixed);
    const bool whole = report.missing_cases.empty() && report.missing_shards.empty();
    if (!whole) to_stderr(missing_text(report));
    if (!whole && !partial) {
        print_error("nothing was written; run the missing shards, or use --partial to join the available ones");
        return ExitStatus::incomplete;
    }
    fmt::print("{}: {} of {} cases\n{}{}", report.file, report.rows, report.cases, tally_text(report.tally),
               field("results hash", report.results_hash));
    const bool accurate = say_verdict(folder, report.file, false);
    return !whole ? ExitStatus::incomplete : accurate ? exit_status(report.tally) : ExitStatus::inaccurate;
}

}  // namespace

Action declare_merge(CLI::App& app) {
    const auto folder = std::make_shared<std::string>();
    const auto partial = std::make_shared<bool>(false), mixed = std::make_shared<bool>(false);
    app.add_option("DIR", *folder, "Folder of all shards")->required()->type_name("");
    app.add_flag("--partial", *partial, "Join the available cases although others are missing");
    app.add_flag("--mixed", *mixed, mixed_meaning);
    app.footer("Missing shards and cases are listed.\n\n" + std::string(exit_status_help));
    return [folder, partial, mixed] { return merge(*folder, *partial, *mixed); };
}

}  // namespace cvtflow::tools
