#include "tasks/batch/batch.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>

#include "engine/executor/tbb/job_pool.hpp"
#include "engine/record/run/part_file.hpp"
#include "tasks/batch/case_engine.hpp"
#include "tasks/batch/results/sweep_files.hpp"
#include "tasks/batch/shared_work.hpp"
#include "tasks/schedule/schedule.hpp"

namespace cvtflow::tasks {

namespace fs = std::filesystem;

namespace {

const engine::Cancellation never;

/// Continued cases to run once more: the last one of a strand and others, spread evenly over `sweep.checked` strands. Ascending.
std::vector<long> cases_to_check(const Sweep& sweep) {
    const std::size_t strand = static_cast<std::size_t>(sweep.strand());
    constexpr std::size_t other_place = 19;
    const std::size_t strands = static_cast<std::size_t>(sweep.cases()) / strand;
    const std::size_t requested = strand > 1 ? std::min(strands, static_cast<std::size_t>(sweep.checked)) : 0;
    std::vector<long> chosen;
    for (std::size_t k = 0; k < requested; ++k) {
        const std::size_t in_strand = strand - 1 - other_place * k % (strand - 1);  // not only the last ones, but never the first
        chosen.push_back(static_cast<long>(((2 * k + 1) * strands / (2 * requested)) * strand + in_strand));
    }
    return chosen;
}

/// Largest difference of each scalar in some cases that are repeated: continued ones from their start without continuation, steady ones for
/// three times as long.
class RepeatedCases {
public:
    /// @param stated  beside the differences, their share of the stated errors, instead of the values
    RepeatedCases(const Sweep& sweep, bool stated) : sweep_(sweep), stated_(stated), largest_(sweep.scalars.size()), size_(largest_) {}

    /// @param rows  the case's among them   @param again the case once more, with all scalars
    void add(const SweepRows& rows, const CaseResult& again);
    /// "2 cases, at most: slip mean 1.2e-04 (0.8 %), ratio final 3e-07 (3e-05 %)", of the value then, or "(0.8 times its stated error)",
    /// with advice where that is exceeded; empty without cases
    [[nodiscard]] std::string text() const;

private:
    const Sweep& sweep_;
    bool stated_;
    int cases_ = 0;
    std::vector<double> largest_, size_;  ///< [scalars of the sweep]
};

void RepeatedCases::add(const SweepRows& rows, const CaseResult& again) {
    ++cases_;
    for (std::size_t i = 0; i < largest_.size(); ++i) {
        const std::string& column = sweep_.scalars[i].column;
        const double value = rows.number(again.number, column), difference = std::abs(value - again.scalars[i]);
        const double size = stated_ ? rows.number(again.number, std::string(error_prefix) + column) * sweep_.scalars[i].error_scale(value)
                                    : std::abs(again.scalars[i]);
        const bool less = stated_ ? difference * size_[i] <= largest_[i] * size : difference < largest_[i] || difference == 0.0;
        if (!std::isfinite(size) || (cases_ > 1 && less)) continue;
        largest_[i] = difference;
        size_[i] = size;
    }
}

std::string RepeatedCases::text() const {
    std::vector<std::string> parts;
    bool exceeded = false;
    for (std::size_t i = 0; i < largest_.size(); ++i) {
        const double quotient = size_[i] > 0.0 ? largest_[i] / size_[i] : 0.0;
        exceeded = exceeded || (stated_ && quotient > 1.0);
        const std::string share = !(size_[i] > 0.0) ? ""
                                  : stated_         ? fmt::format(" ({:.2g} times its stated error)", quotient)
                                                    : fmt::format(" ({:.2g} %)", 100.0 * quotient);
        parts.push_back(fmt::format("{} {:.2g}{}", sweep_.scalars[i].text, largest_[i], share));
    }
    if (cases_ == 0) return "";
    return fmt::format("{} {}, at most: {}{}", cases_, cases_ == 1 ? "case" : "cases", fmt::join(parts, ", "),
                       exceeded ? "; errors are larger than stated: a smaller run.steady" : "");
}

/// Whether the first cases of a session all fail with the same message: the others would, too.
class FailingAlike {
public:
    /// @param sought  otherwise never hopeless
    explicit FailingAlike(bool sought) : open_(sought) {}
    /// Called by one thread at a time.
    void add(const CaseResult& result) {
        if (!open_) return;
        const std::string text = fmt::format("{}: {}", status_name(result.status), result.error);
        open_ = result.status != CaseStatus::ok && (count_ == 0 || text == text_);
        text_ = text;
        if (open_ && ++count_ == first_cases) hopeless_.request();
    }
    /// Some case of the sweep has ended well: it is not hopeless.
    void disprove() noexcept { open_ = false; }
    [[nodiscard]] bool hopeless() const noexcept { return hopeless_.requested(); }
    [[nodiscard]] std::string text() const { return fmt::format("the first {} cases all failed alike: {}", first_cases, text_); }

private:
    static constexpr long first_cases = 12;
    bool open_;
    engine::Cancellation hopeless_;
    long count_ = 0;
    std::string text_;
};

/// Makes the folder of a sweep, which writes into real folders only. @throws engine::RecordError
void make_folder(const std::string& folder) {
    std::error_code error, absent;
    fs::create_directory(folder, error);
    if (!fs::is_directory(folder, absent)) {
        const std::string missing = engine::missing_folder(folder);
        throw engine::RecordError(fmt::format("{}: cannot create: {}", folder,
                                              !missing.empty() ? missing
                                              : error          ? error.message()
                                                               : "a file with that name exists"));
    }
    for (const char* inside : {"", "/claims", "/records", "/continuation", "/states"}) {
        if (fs::is_symlink(folder + inside, absent))
            throw engine::RecordError(folder + inside + ": a symbolic link; a sweep writes into real folders only");
    }
}

/// One session of a sweep in a folder.
class Session {
public:
    Session(const Sweep& sweep, const BatchOptions& options)
        : sweep_(sweep),
          options_(options),
          cancel_(options.cancel != nullptr ? *options.cancel : never),
          threads_(options.threads > 0 ? options.threads : usable_threads()),
          starts_(sweep, fs::path(options.folder) / "states"),
          control_(options.grace, cancel_, options.notice),
          failing_alike_(!options.keep_going && !options.part.only),
          rows_(begin()) {}

    BatchReport run() {
        progress_.cases = sweep_.cases();
        progress_.before = static_cast<long>(rows_.size());
        BatchReport report{options_.folder, progress_, {}, rows_.facts().finished(), {}, threads_, {}, {}, {}};
        if (!report.finished) {
            for (const std::string& line : rows_.files().damage()) tell(line + "; its case runs again");
            engine::RowWriter writer(options_.folder, engine::checked_heading(heading_of(rows_.facts().columns)));
            engine::Claims claims(options_.folder, writer.name(), options_.silence);
            work(writer, claims);
            rows_.refresh();
            report.finished = !stopping() && !options_.part.only && end(claims);
            writer.finish();
        }
        describe(report);
        return report;
    }

private:
    SweepRows begin() {
        const SweepFacts facts = begin_results(options_.folder, sweep_);
        if (!options_.retry.empty() && options_.part.attempt == 0) drop_rows(options_.folder, facts, options_.retry);
        SweepRows rows(options_.folder);
        for (const long number : rows.files().numbers()) {
            if (rows.text(number, "status") != status_name(CaseStatus::ok)) continue;
            failing_alike_.disprove();
            break;
        }
        return rows;
    }

    void tell(const std::string& what) const {
        if (options_.notice) options_.notice(what);
    }

    /// Runs what is left. Jobs are strands of cases; without continuation, single cases.
    void work(engine::RowWriter& writer, engine::Claims& claims) {
        const StrandEnds ends(sweep_, places().continuation);
        SharedWork shared(
            sweep_, rows_, claims, [&ends](long number) { return ends.exists(number); }, options_.notice);
        if (options_.part.only) shared.restrict_to(*options_.part.only);
        Engines engines(static_cast<std::size_t>(threads_));
        std::vector<std::vector<CaseToRun>> jobs(engines.size());
        started_ = std::chrono::steady_clock::now();
        const auto next = [&](int worker) -> std::optional<long> {
            if (stopping()) return {};
            auto& job = jobs[static_cast<std::size_t>(worker)];
            job = shared.next([this] { return stopping(); });
            return job.empty() ? std::nullopt : std::optional(job.front().number);
        };
        engine::run_jobs(threads_, options_.pin, next, [&](int worker, long /*first*/) {
            CaseEngine& engine = engine_of(worker, engines, control_);
            for (const CaseToRun& each : jobs[static_cast<std::size_t>(worker)]) {
                if (stopping()) return;
                const CaseResult& result = run_noted(engine, worker, each.number);
                if (result.status == CaseStatus::stopped) return;
                if (!each.is_new) continue;
                writer.append(engine::checked_line(row_of(sweep_, result)));
                ended(result);
            }
        });
    }

    [[nodiscard]] bool stopping() const noexcept { return cancel_.requested() || failing_alike_.hopeless(); }

    using Engines = std::vector<std::unique_ptr<CaseEngine>>;
    /// Engine of a worker, made when its first case comes.
    CaseEngine& engine_of(int worker, Engines& engines, BatchControl& control) {
        auto& engine = engines[static_cast<std::size_t>(worker)];
        if (!engine) engine = std::make_unique<CaseEngine>(sweep_, starts_, control, places());
        return *engine;
    }

    const CaseResult& run_noted(CaseEngine& engine, int worker, long number) {
        if (!options_.part.crashed.empty() && options_.part.only == number) return engine.book_crash(number, options_.part.crashed);
        if (options_.journal != nullptr) options_.journal->set(worker, number);
        const CaseResult& result = engine.run(number);
        if (options_.journal != nullptr) options_.journal->set(worker, engine::SharedSlots::none);
        return result;
    }

    void ended(const CaseResult& result) {
        mutex_.guard([&] {
            ++progress_.done;
            progress_.failed += result.status != CaseStatus::ok;
            if (progress_.done == threads_) {
                progress_.warm = progress_.done;
                progress_.warm_wall = progress_.wall;
            }
            failing_alike_.add(result);
            progress_.wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
            if (options_.progress) options_.progress(progress_);
        });
    }

    [[nodiscard]] CasePlaces places() const {
        const fs::path folder(options_.folder);
        if (sweep_.records) fs::create_directories(folder / "records");
        return {folder / "records", folder / "continuation"};
    }

    /// Text of RepeatedCases for some cases that ended well, repeated without continuation. Empty if stopped.
    /// @param longer whether for three times as long, beside their stated errors
    std::string repeat(const std::vector<long>& cases, bool longer) {
        struct Again {
            long number;
            double until;
            CaseResult result;
        };
        std::vector<Again> all;
        for (const long number : cases) {
            if (!rows_.files().has(number) || rows_.text(number, "status") != status_name(CaseStatus::ok)) continue;
            const double times = rows_.text(number, "start") == "extrapolated" ? 12.0 : 6.0;  // its start is better
            all.push_back({number, longer ? sweep_.from + times * (rows_.number(number, "settled_for") - sweep_.from) : 0.0, {}});
        }
        BatchControl control(options_.grace, cancel_, options_.notice);
        Engines engines(static_cast<std::size_t>(threads_));
        const auto next = [&, job = 0L](int) mutable -> std::optional<long> {
            return job < std::ssize(all) && !cancel_.requested() ? std::optional(job++) : std::nullopt;
        };
        engine::run_jobs(threads_, options_.pin, next, [&](int worker, long job) {
            Again& again = all[static_cast<std::size_t>(job)];
            again.result = engine_of(worker, engines, control).run_from_own_start(again.number, again.until);
        });
        RepeatedCases changes(sweep_, longer);
        for (const Again& again : all) {
            if (again.result.number < 0 || again.result.status == CaseStatus::stopped) return {};
            if (again.result.status == CaseStatus::ok) changes.add(rows_, again.result);
        }
        return changes.text();
    }

    /// Ends the sweep where all cases have rows: repeats some of them and writes the results. One process does, the others wait for it.
    /// @return whether it is finished
    bool end(engine::Claims& claims) {
        if (static_cast<long>(rows_.size()) < sweep_.cases()) return false;
        constexpr unsigned pause = 200'000;
        while (!claims.take("end")) {
            if (cancel_.requested()) return false;
            if (SweepFacts facts = read_facts(options_.folder); facts.finished()) {
                rows_ = SweepRows(options_.folder, std::move(facts));
                return true;
            }
            usleep(pause);
        }
        SweepFacts facts = rows_.facts();
        facts.set({"continuation_error", repeat(cases_to_check(sweep_), false)});
        facts.set({"steady_check",
                   repeat(draw_cases(sweep_.cases(), sweep_.steady() ? sweep_.confirmation.cases : 0, sweep_.confirmation.seed), true)});
        if (cancel_.requested()) return false;
        facts.set({"status", "finished"});
        facts.set({"results_hash", rows_.hash()});
        write_results(options_.folder, facts, rows_.file());
        claims.remove();
        remove_ends(places().continuation, sweep_);
        rows_ = SweepRows(options_.folder, std::move(facts));
        return true;
    }

    void describe(BatchReport& report) {
        progress_.before = static_cast<long>(rows_.size()) - progress_.done;
        report.progress = progress_;
        report.tally = rows_.tally();
        report.results_hash = report.finished ? rows_.facts().text("results_hash") : rows_.hash();
        report.continuation_error = rows_.facts().text("continuation_error");
        report.steady_check = rows_.facts().text("steady_check");
        if (!report.finished && failing_alike_.hopeless()) report.hopeless = failing_alike_.text();
    }

    const Sweep& sweep_;
    const BatchOptions& options_;
    const engine::Cancellation& cancel_;
    int threads_;
    StartStates starts_;
    BatchControl control_;
    FailingAlike failing_alike_;
    SweepRows rows_;
    BatchProgress progress_;
    engine::Mutex mutex_;
    std::chrono::steady_clock::time_point started_;
};

}  // namespace

BatchReport run_batch(const Sweep& sweep, const BatchOptions& options) {
    make_folder(options.folder);
    return Session(sweep, options).run();
}

}  // namespace cvtflow::tasks
