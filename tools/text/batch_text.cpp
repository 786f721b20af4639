#include "tools/text/batch_text.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "engine/record/table/torn_table.hpp"
#include "tasks/batch/results/results.hpp"
#include "tasks/batch/results/torn_results.hpp"
#include "tasks/schedule/schedule.hpp"
#include "tools/guard.hpp"
#include "tools/output/interrupt.hpp"
#include "tools/ready_scenes.hpp"
#include "tools/text/text.hpp"

namespace cvtflow::tools {

namespace {

using Clock = std::chrono::steady_clock;

/// A line on stderr: redrawn on a terminal, one every ten seconds elsewhere.
class BatchDisplay {
public:
    explicit BatchDisplay(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO) != 0) {}
    ~BatchDisplay() {
        if (drawn_) to_stderr("\r\x1b[K");
    }
    BatchDisplay(const BatchDisplay&) = delete;
    BatchDisplay& operator=(const BatchDisplay&) = delete;

    void show(const tasks::BatchProgress& p) {
        const double since = std::chrono::duration<double>(Clock::now() - last_).count();
        if (quiet_ || since < (terminal_ ? 0.1 : 10.0)) return;
        last_ = Clock::now();
        const double rate = static_cast<double>(p.done) / std::max(p.wall, 1e-9);
        const double left = static_cast<double>(p.cases - p.before - p.done) / rate;
        const std::string line = fmt::format("{} of {} cases, {:.3g} a second, {} left{}", p.before + p.done, p.cases, rate,
                                             clock_text(left), p.failed > 0 ? fmt::format(", {} failed", p.failed) : "");
        to_stderr(fmt::format("{}{}{}", terminal_ ? "\r" : "", line, terminal_ ? "\x1b[K" : "\n"));
        drawn_ = terminal_;
    }

    /// A line that stays.
    void tell(const std::string& what) {
        if (quiet_) return;
        if (drawn_) to_stderr("\r\x1b[K");
        drawn_ = false;
        print_error(what);
    }

private:
    bool quiet_, terminal_, drawn_ = false;
    Clock::time_point last_{};
};

}  // namespace

tasks::Sweep load_sweep(const std::string& path) {
    std::error_code unreadable;
    std::string file = path;
    for (const auto& folder : scene_folders()) {  // a ready sweep by its name
        if (path.find('/') != std::string::npos || path.ends_with(".toml") || std::filesystem::exists(file, unreadable)) break;
        file = (folder / "sweeps" / (path + ".toml")).string();
    }
    return tasks::read_sweep(std::filesystem::exists(file, unreadable) ? file : path, find_scene);
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
                fmt::format("{}\n  to go on with the rows that are whole: cvtflow batch SWEEP -o {}", error.what(), folder));
        }
    }
    throw tasks::SimulationError(folder + ": no sweep has written into it");
}

void require_statuses(const std::string& option, const std::vector<std::string>& given) {
    const auto names = tasks::status_names();
    for (const std::string& name : given) {
        if (std::find(names.begin(), names.end(), name) == names.end())
            throw UsageError(fmt::format("{} {}: not one of {}", option, name, fmt::join(names, ", ")));
    }
}

std::string statuses_text(const std::map<std::string, long>& statuses) {
    std::vector<std::string> parts;
    for (const auto& [status, count] : statuses) parts.push_back(fmt::format("{} {}", count, status));
    return parts.empty() ? "none" : fmt::format("{}", fmt::join(parts, ", "));
}

namespace {

void print_end(const tasks::Sweep& sweep, const tasks::BatchReport& report, const std::string& folder) {
    const tasks::BatchProgress& p = report.progress;
    fmt::print("{}: {}\n", sweep.name,
               report.finished
                   ? "finished"
                   : fmt::format("stopped with {} of {} cases; to go on: cvtflow resume {}", p.before + p.done, p.cases, folder));
    fmt::print("{}", field("cases", fmt::format("{} now in {:.2f} s on {}, {:.3g} a second{}", p.done, p.wall,
                                                plural(report.threads, "thread"), static_cast<double>(p.done) / std::max(p.wall, 1e-9),
                                                p.before > 0 ? fmt::format("; {} before", p.before) : "")));
    fmt::print("{}{}{}", field("statuses", statuses_text(report.statuses)), field("results hash", report.results_hash),
               field("table", report.folder + "/cases.h5"));
    if (!report.continuation_error.empty()) fmt::print("{}", field("continuation error", report.continuation_error));
}

/// In the child.
ExitStatus run_part(const tasks::Sweep& sweep, tasks::BatchOptions options, bool quiet) {
    tasks::BatchReport report;
    const engine::Cancellation& interrupted = catch_interrupts();
    {
        BatchDisplay display(quiet);
        options.cancel = &interrupted;
        options.progress = [&display](const tasks::BatchProgress& progress) { display.show(progress); };
        options.notice = [&display](const std::string& what) { display.tell(what); };
        if (options.part.only >= 0) options.threads = 1;
        report = tasks::run_batch(sweep, options);
    }
    if (options.part.only >= 0 && !interrupted.requested()) return ExitStatus::finished;
    if (!quiet) {
        print_end(sweep, report, options.folder);
        print_notices();
    }
    if (!report.finished) return ExitStatus::cancelled;
    return report.statuses.size() == 1 && report.statuses.contains("ok") ? ExitStatus::finished : ExitStatus::incomplete;
}

}  // namespace

ExitStatus run_sweep(const tasks::Sweep& sweep, tasks::BatchOptions options, bool quiet) {
    if (options.threads <= 0) options.threads = tasks::usable_threads();
    engine::SharedSlots journal(options.threads);
    options.journal = &journal;
    const auto work = [&](const tasks::SweepPart& part) {
        tasks::BatchOptions here = options;
        here.part = part;
        return guarded([&] { return static_cast<int>(run_part(sweep, here, quiet)); });
    };
    return static_cast<ExitStatus>(tasks::supervise(journal, work, print_error));
}

}  // namespace cvtflow::tools
