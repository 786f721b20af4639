#include "tools/program/text/batch_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "engine/record/table/torn_table.hpp"
#include "tasks/batch/results/results.hpp"
#include "tasks/batch/results/torn_results.hpp"
#include "tasks/schedule/schedule.hpp"
#include "tasks/tuning/verified_sweep.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/progress.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::tools {

namespace {

std::string progress_line(const tasks::BatchProgress& p) {
    const double rate = static_cast<double>(p.done) / std::max(p.wall, 1e-9), left = p.left();
    return fmt::format("{} of {} cases, {:.3g} a second{}{}", p.before + p.done, p.cases, rate,
                       std::isnan(left) ? "" : fmt::format(", {} left", clock_text(left)),
                       p.failed > 0 ? fmt::format(", {} failed", p.failed) : "");
}

}  // namespace

tasks::Sweep load_sweep(const std::string& path) {
    std::error_code unreadable;
    std::string file = path;
    for (const auto& folder : scene_folders()) {  // a ready sweep by its name
        if (path.find('/') != std::string::npos || path.ends_with(".toml") || std::filesystem::exists(file, unreadable)) break;
        file = (folder / "sweeps" / (path + ".toml")).string();
    }
    if (std::filesystem::exists(file, unreadable)) return tasks::read_sweep(file, find_scene);
    if (path.find('/') != std::string::npos || path.ends_with(".toml")) return tasks::read_sweep(path, find_scene);
    std::vector<std::string> names;
    for (const ReadyScene& ready : ready_sweeps()) names.push_back(ready.name);
    const auto scenes = tasks::ready_scenes();
    const bool scene = std::ranges::find(scenes, path, &tasks::ReadyScene::name) != scenes.end();
    throw tasks::SceneError(fmt::format("no sweep '{}'; ready sweeps: {}{}", path, fmt::join(names, ", "),
                                        scene ? fmt::format("; to run the scene of that name: cvtflow run {}", path) : ""));
}

std::string sweep_of(const std::string& folder) {
    std::error_code unreadable;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder, unreadable)) {
        if (entry.path().filename() != "cases.h5") continue;
        const std::string file = entry.path().string();
        try {
            return engine::CaseReader(file).head().attribute("sweep_path");
        } catch (const engine::RecordError& error) {
            if (!engine::torn_while_growing(file, tasks::mark_of_a_sweep)) throw;
            throw engine::RecordError(
                fmt::format("{}\n  to continue with the intact rows: cvtflow batch SWEEP -o {}", error.what(), folder));
        }
    }
    throw tasks::SimulationError(folder + ": contains no sweep");
}

void require_statuses(const std::string& option, const std::vector<std::string>& given) {
    const auto names = tasks::status_names();
    for (const std::string& name : given) {
        if (std::find(names.begin(), names.end(), name) == names.end())
            throw UsageError(fmt::format("{} {}: not one of {}", option, name, fmt::join(names, ", ")));
    }
}

std::string tally_text(const tasks::CaseTally& tally) {
    std::vector<std::string> parts;
    for (const auto& [status, count] : tally.statuses()) parts.push_back(fmt::format("{} {}", count, status));
    std::string text = field("statuses", parts.empty() ? "none" : fmt::format("{}", fmt::join(parts, ", ")));
    const long failed = tally.failed();
    if (failed > 0)
        text += field("failed", fmt::format("{} of {} ({:.3g} %)", failed, plural(tally.rows(), "case"),
                                            100.0 * static_cast<double>(failed) / static_cast<double>(tally.rows())));
    long named = 0;
    for (const tasks::CaseTally::Failure& failure : tally.failures()) {
        named += failure.cases;
        text += field("", fmt::format("{} {}: {} (first: case {})", failure.cases, failure.status, failure.error, failure.first));
    }
    if (named > 0 && named < failed) text += field("", fmt::format("{} with other messages", failed - named));
    parts.clear();
    for (const auto& [name, count] : tally.notes()) parts.push_back(fmt::format("{} {} of {}", name, count, tally.rows()));
    return text + (parts.empty() ? "" : field("notes", fmt::format("{}", fmt::join(parts, ", "))));
}

ExitStatus exit_status(const tasks::CaseTally& tally) noexcept {
    return tally.failed() == 0 ? ExitStatus::finished : ExitStatus::incomplete;
}

namespace {

void print_end(const tasks::Sweep& sweep, const tasks::BatchReport& report, const std::string& folder) {
    const tasks::BatchProgress& p = report.progress;
    fmt::print("{}: {}\n", sweep.name,
               report.finished ? "finished"
                               : fmt::format("stopped after {} of {} cases; to continue: cvtflow resume {}{}", p.before + p.done, p.cases,
                                             folder, report.hopeless.empty() ? "" : " --keep-going"));
    fmt::print("{}", field("cases", fmt::format("{} now in {:.2f} s on {}, {:.3g} a second{}", p.done, p.wall,
                                                plural(report.threads, "thread"), static_cast<double>(p.done) / std::max(p.wall, 1e-9),
                                                p.before > 0 ? fmt::format("; {} before", p.before) : "")));
    fmt::print("{}{}{}", tally_text(report.tally), field("results hash", report.results_hash), field("table", report.folder + "/cases.h5"));
    if (!report.continuation_error.empty()) fmt::print("{}", field("continuation error", report.continuation_error));
}

/// Repeats some cases at reference accuracy, if the sweep has a target accuracy. @return whether it is met
bool verified(const tasks::Sweep& asked, const tasks::TunedSweep& tuned, tasks::BatchReport& report, bool quiet) {
    if (!(asked.accuracy.target > 0.0) || catch_interrupts().requested()) return true;
    const auto say = [quiet](const std::string& what) { tools::say(quiet, what); };
    std::vector<std::string> remarks;
    try {
        remarks = tasks::verify_sweep(asked, tuned, report.folder, catch_interrupts(), say);
    } catch (const tasks::SimulationError&) {
        if (!catch_interrupts().requested()) throw;
        return true;
    }
    for (const std::string& remark : remarks) print_error("not verified: " + remark);
    const std::string file = report.folder + "/cases.h5";
    report.results_hash = engine::CaseReader(file).head().attribute("results_hash");
    return say_verdict(asked.name, file, quiet) && (remarks.empty() || tasks::sweep_verdict(file).verified > 0);
}

/// In the child.
ExitStatus run_part(const tasks::Sweep& asked, const tasks::TunedSweep& tuned, tasks::BatchOptions options, bool quiet) {
    const tasks::Sweep& sweep = tuned.sweep;
    tasks::BatchReport report;
    const engine::Cancellation& interrupted = catch_interrupts();
    {
        StatusLine line(quiet);
        options.cancel = &interrupted;
        options.progress = [&line](const tasks::BatchProgress& progress) {
            if (line.due()) line.show(progress_line(progress));
        };
        options.notice = [&line](const std::string& what) { line.say(what); };
        if (options.part.only) options.threads = 1;
        report = tasks::run_batch(sweep, options);
    }
    if (options.part.only && !interrupted.requested()) return ExitStatus::finished;
    const bool accurate = !report.finished || verified(asked, tuned, report, quiet);
    if (!quiet) {
        print_end(sweep, report, options.folder);
        print_notices();
    }
    if (!report.hopeless.empty()) {
        print_error(fmt::format("{}: {}; --keep-going runs the others", sweep.name, report.hopeless));
        return ExitStatus::incomplete;
    }
    if (!report.finished || interrupted.requested()) return ExitStatus::cancelled;
    return accurate ? exit_status(report.tally) : ExitStatus::inaccurate;
}

}  // namespace

bool say_verdict(const std::string& name, const std::string& file, bool quiet) {
    const tasks::SweepVerdict verdict = tasks::sweep_verdict(file);
    if (!(verdict.target > 0.0)) return true;
    if (!quiet || !verdict.held()) print_error(fmt::format("{}: {}{}", name, verdict.held() ? "" : "misses its target: ", verdict.text()));
    return verdict.held();
}

namespace {

/// In the parent: once for all children.
tasks::TunedSweep tuned_here(const tasks::Sweep& sweep, const std::string& folder, bool quiet) {
    if (!(sweep.accuracy.target > 0.0)) return {sweep, {}, std::nullopt};
    const auto say = [quiet](const std::string& what) { tools::say(quiet, what); };
    tasks::TunedSweep tuned = tasks::tuned_sweep(sweep, folder, catch_interrupts(), say);
    say(fmt::format("{}: {} for {:g} % (largest error at the corners: {:.2g} %){}", sweep.name, tuned.kept.choice.text(),
                    100.0 * sweep.accuracy.target, 100.0 * tuned.kept.error,
                    tuned.result ? fmt::format(", found in {}", clock_text(tuned.result->wall)) : ", from the cache"));
    return tuned;
}

}  // namespace

ExitStatus run_sweep(const tasks::Sweep& sweep, tasks::BatchOptions options, bool quiet) try {
    if (options.threads <= 0) options.threads = tasks::usable_threads();
    const tasks::TunedSweep tuned = tuned_here(sweep, options.folder, quiet);
    engine::SharedSlots journal(options.threads);
    options.journal = &journal;
    const auto work = [&](const tasks::SweepPart& part) {
        tasks::BatchOptions here = options;
        here.part = part;
        return guarded([&] { return static_cast<int>(run_part(sweep, tuned, here, quiet)); });
    };
    return static_cast<ExitStatus>(tasks::supervise(journal, work, print_error));
} catch (const tasks::AccuracyError& error) {
    print_error(error.what());
    return ExitStatus::inaccurate;
} catch (const tasks::SimulationError&) {  // tuning that was interrupted
    if (catch_interrupts().requested()) return ExitStatus::cancelled;
    throw;
}

}  // namespace cvtflow::tools
