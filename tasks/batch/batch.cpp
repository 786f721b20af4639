#include "tasks/batch/batch.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>

#include "engine/executor/tbb/job_pool.hpp"
#include "tasks/batch/case_engine.hpp"
#include "tasks/batch/results/sweep_files.hpp"
#include "tasks/schedule/schedule.hpp"

namespace cvtflow::tasks {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t waiting_rows = 64;
constexpr double sync_seconds = 5.0;
const engine::Cancellation never;

/// Continued cases to run once more: the last one of a strand and others, spread evenly over `sweep.checked` strands of a shard. Ascending.
std::vector<long> cases_to_check(const Sweep& sweep, const std::vector<long>& cases) {
    const std::size_t strand = static_cast<std::size_t>(sweep.strand());
    constexpr std::size_t other_place = 19;
    const std::size_t strands = cases.size() / strand;
    const std::size_t requested = strand > 1 ? std::min(strands, static_cast<std::size_t>(sweep.checked)) : 0;
    std::vector<long> chosen;
    for (std::size_t k = 0; k < requested; ++k) {
        const std::size_t in_strand = strand - 1 - other_place * k % (strand - 1);  // not only the last ones, but never the first
        chosen.push_back(cases[((2 * k + 1) * strands / (2 * requested)) * strand + in_strand]);
    }
    return chosen;
}

/// Largest difference of each scalar in some cases that are repeated: continued ones from their start without continuation, steady ones for
/// three times as long.
class RepeatedCases {
public:
    /// @param stated  beside the differences, their share of the stated errors, instead of the values
    RepeatedCases(const Sweep& sweep, bool stated) : sweep_(sweep), stated_(stated), largest_(sweep.scalars.size()), size_(largest_) {}

    /// @param row  of the case   @param again the case once more, with all scalars
    void add(const engine::RowLayout& layout, std::span<const std::byte> row, const CaseResult& again);
    /// "2 cases, at most: slip mean 1.2e-04 (0.8 %), ratio final 3e-07 (3e-05 %)", of the value then, or "(0.8 times its stated error)",
    /// with advice where that is exceeded; empty without cases
    [[nodiscard]] std::string text() const;

private:
    const Sweep& sweep_;
    bool stated_;
    int cases_ = 0;
    std::vector<double> largest_, size_;  ///< [scalars of the sweep]
};

void RepeatedCases::add(const engine::RowLayout& layout, std::span<const std::byte> row, const CaseResult& again) {
    ++cases_;
    for (std::size_t i = 0; i < largest_.size(); ++i) {
        const std::string& column = sweep_.scalars[i].column;
        const double value = layout.real(row, layout.column(column)), difference = std::abs(value - again.scalars[i]);
        const double size = stated_
                                ? layout.real(row, layout.column(std::string(error_prefix) + column)) * sweep_.scalars[i].error_scale(value)
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

/// Cases whose rows stay: no longer to be run. @return those of them that ended well, ascending
std::vector<long> mark_done(const engine::CaseTable& table, const std::vector<std::string>& retry, std::vector<char>& done) {
    const std::size_t number = table.layout.column("case"), status = table.layout.column("status");
    std::vector<long> ok;
    for (std::size_t i = 0; i < table.size(); ++i) {
        const auto row = table.row(i);
        const auto of_case = static_cast<std::size_t>(table.layout.integer(row, number));
        const std::string ended = table.layout.text(row, status);
        if (of_case >= done.size() || std::find(retry.begin(), retry.end(), ended) != retry.end()) continue;
        done[of_case] = 1;
        if (ended == status_name(CaseStatus::ok)) ok.push_back(static_cast<long>(of_case));
    }
    std::sort(ok.begin(), ok.end());
    return ok;
}

/// Takes rows of cases that are to run out of the table, and all but the first row of a case.
void keep_done(engine::CaseTable& table, const std::vector<char>& done) {
    const std::size_t number = table.layout.column("case");
    std::vector<char> requested = done;
    std::vector<std::byte> kept;
    for (std::size_t i = 0; i < table.size(); ++i) {
        const auto row = table.row(i);
        const auto of_case = static_cast<std::size_t>(table.layout.integer(row, number));
        if (of_case >= requested.size() || requested[of_case] == 0) continue;
        requested[of_case] = 0;
        kept.insert(kept.end(), row.begin(), row.end());
    }
    table.rows = std::move(kept);
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

/// One session of a sweep in a folder.
class Session {
public:
    Session(const Sweep& sweep, const BatchOptions& options)
        : sweep_(sweep),
          options_(options),
          folder_(shard_folder(options.folder, options.shard)),
          file_((fs::path(folder_) / "cases.h5").string()),
          lock_(locked(options)),
          cancel_(options.cancel != nullptr ? *options.cancel : never),
          threads_(options.threads > 0 ? options.threads : usable_threads()),
          starts_(sweep, fs::path(options.folder) / "states", options.mixed),
          control_(threads_, options.grace, cancel_, options.notice),
          cases_(options.shard.claims() ? std::vector<long>{} : shard_cases(sweep, options.shard)),
          failing_alike_(!options.keep_going && !options.part.only) {}

    BatchReport run() {
        engine::CaseTable table = read_or_begin();
        if (options_.shard.claims()) take_claimed();
        progress_.cases = static_cast<long>(cases_.size());
        progress_.before = static_cast<long>(table.size());
        {
            permit_ = permit_table(file_, table.attribute("definition"), true);
            engine::CaseWriter writer(permit_, table);
            table.rows = {};  // they are in the file
            work(writer, table.layout);
        }
        return report();
    }

private:
    /// The folder of a process that does not hold it already.
    static std::unique_ptr<engine::FolderLock> locked(const BatchOptions& options) {
        if (options.shard.claims()) return nullptr;
        if (!options.shard.whole()) make_workers_folder(options.folder);
        return std::make_unique<engine::FolderLock>(shard_folder(options.folder, options.shard));
    }

    engine::CaseTable read_or_begin() {
        std::error_code missing;
        if (!options_.shard.whole() && !options_.shard.claims() && fs::exists(claims_file(options_.folder), missing))
            throw SimulationError(options_.folder + ": this sweep was begun with --worker; continue it so");
        engine::CaseTable begin = empty_table(sweep_);
        begin.set({"shard", options_.shard.text()});
        set_mark(begin);
        done_.assign(static_cast<std::size_t>(sweep_.cases()), 0);
        if (!fs::exists(file_, missing)) return begin;
        engine::CaseTable table = read_or_recover(begin);
        require_same_sweep(file_, table, begin);
        require_same_origin(file_, table, begin, options_.mixed);
        if (table.attribute("shard") != begin.attribute("shard"))
            throw SimulationError(
                fmt::format("{}: results of shard {}, not {}", file_, table.attribute("shard"), begin.attribute("shard")));
        const std::vector<long> ok = mark_done(table, options_.part.attempt == 0 ? options_.retry : std::vector<std::string>{}, done_);
        if (!ok.empty()) failing_alike_.disprove();
        StrandEnds(sweep_, places().continuation).reopen_broken(ok, done_);
        keep_done(table, done_);
        table.set({"status", "running"});
        return table;
    }

    /// The strands of a worker so far: those that it has claimed, and of rows in its table whose claims were lost. Ascending.
    void take_claimed() {
        std::vector<char> taken = done_;
        for (const engine::Claim& claim : engine::read_claims(claims_file(options_.folder))) {
            for (long number = claim.first; claim.worker == options_.shard.number && number < std::min(claim.end(), sweep_.cases());
                 ++number)
                taken[static_cast<std::size_t>(number)] = 1;
        }
        const auto strand = sweep_.strand();
        for (auto first = taken.begin(); first != taken.end(); first += strand) {
            if (std::find(first, first + strand, char{1}) == first + strand) continue;
            for (long k = 0; k < strand; ++k) cases_.push_back(first - taken.begin() + k);
        }
        taken_ = std::ssize(cases_);
    }

    /// Claims more cases for a worker, but not again those of rows whose claims were lost. @return whether there are any
    bool claim() {
        if (!options_.shard.claims() || options_.part.only) return false;
        const std::size_t before = cases_.size();
        while (cases_.size() == before) {
            const engine::Claim claimed =
                engine::claim_cases(claims_file(options_.folder), options_.shard.number, sweep_.cases(), sweep_.strand());
            if (claimed.cases == 0) return false;
            for (long number = claimed.first; number < claimed.end(); ++number) {
                if (!std::binary_search(cases_.begin(), cases_.begin() + taken_, number)) cases_.push_back(number);
            }
        }
        return true;
    }

    /// The existing table; if a power cut has torn it, its intact rows.
    engine::CaseTable read_or_recover(const engine::CaseTable& begin) {
        try {
            return read_results(file_);
        } catch (const engine::RecordError& error) {
            std::optional<engine::CaseTable> left = recover_results(file_, begin);
            if (!left) throw;
            if (options_.notice)
                options_.notice(fmt::format("{}; intact rows are kept: {}; the other cases run again", error.what(), left->size()));
            return *std::move(left);
        }
    }

    /// Runs what is left. Jobs are strands of cases; without continuation, single cases.
    void work(engine::CaseWriter& writer, const engine::RowLayout& layout) {
        using Clock = std::chrono::steady_clock;
        Clock::time_point synced = Clock::now();
        engine::WriterThread rows(waiting_rows, layout.bytes(), [&](std::span<const std::byte> row) {
            writer.append(row);
            if (std::chrono::duration<double>(Clock::now() - synced).count() < sync_seconds) return;
            writer.sync();
            synced = Clock::now();
        });
        Engines engines(static_cast<std::size_t>(threads_));
        std::vector<std::vector<std::byte>> buffers(engines.size(), std::vector<std::byte>(layout.bytes()));
        started_ = Clock::now();
        engine::run_jobs(
            threads_, options_.pin, [&](int) { return next(); },
            [&](int worker, long first) {
                CaseEngine& engine = engine_of(worker, engines, control_);
                for (long number = first; number < first + sweep_.strand() && !stopping(); ++number) {
                    if (!open(number)) continue;
                    const CaseResult& result = run_noted(engine, worker, number);
                    if (result.status == CaseStatus::stopped) return;
                    auto& row = buffers[static_cast<std::size_t>(worker)];
                    fill_row(layout, sweep_, result, row);
                    rows.post(row);
                    engine.forget_checkpoint();
                    ended(result);
                }
            });
        rows.finish();
        writer.sync();
    }

    [[nodiscard]] bool stopping() const noexcept { return cancel_.requested() || failing_alike_.hopeless(); }

    /// Whether a case is to be run now.
    [[nodiscard]] bool open(long number) const noexcept {
        return done_[static_cast<std::size_t>(number)] == 0 && (!options_.part.only || options_.part.only == number);
    }

    using Engines = std::vector<std::unique_ptr<CaseEngine>>;
    /// Engine of a worker, made when its first case comes.
    CaseEngine& engine_of(int worker, Engines& engines, BatchControl& control) {
        auto& engine = engines[static_cast<std::size_t>(worker)];
        if (!engine) engine = std::make_unique<CaseEngine>(sweep_, starts_, control, places());
        return *engine;
    }

    const CaseResult& run_noted(CaseEngine& engine, int worker, long number) {
        if (!options_.part.crashed.empty()) return engine.book_crash(number, options_.part.crashed);
        if (options_.journal != nullptr) options_.journal->set(worker, number);
        const CaseResult& result = engine.run(number);
        if (options_.journal != nullptr) options_.journal->set(worker, engine::SharedSlots::none);
        return result;
    }

    std::optional<long> next() {
        while (!stopping() && (position_ < cases_.size() || claim())) {
            const long number = cases_[position_];
            position_ += static_cast<std::size_t>(sweep_.strand());
            for (long k = number; k < number + sweep_.strand(); ++k) {
                if (open(k)) return number;
            }
        }
        control_.idle();
        return {};
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
        const fs::path folder(folder_);
        if (sweep_.records) fs::create_directories(folder / "records");
        return {folder / "checkpoints", folder / "records", folder / "continuation", options_.checkpoint_every, options_.mixed};
    }

    /// Text of RepeatedCases for some cases that ended well, repeated without continuation. Empty if stopped.
    /// @param longer whether for three times as long, beside their stated errors
    std::string repeat(OrderedRows& rows, const std::vector<long>& cases, bool longer) {
        struct Again {
            long number;
            double until;
            CaseResult result;
        };
        std::vector<Again> all;
        const engine::RowLayout& layout = rows.head().layout;
        for (const long number : cases) {
            const auto row = rows.of_case(number);
            if (row.empty() || layout.text(row, layout.column("status")) != status_name(CaseStatus::ok)) continue;
            const double times = layout.text(row, layout.column("start")) == "extrapolated" ? 12.0 : 6.0;  // its start is better
            all.push_back(
                {number, longer ? sweep_.from + times * (layout.real(row, layout.column("settled_for")) - sweep_.from) : 0.0, {}});
        }
        BatchControl control(threads_, options_.grace, cancel_, options_.notice);
        Engines engines(static_cast<std::size_t>(threads_));
        const auto next = [&, job = 0L](int) mutable -> std::optional<long> {
            if (job < std::ssize(all) && !cancel_.requested()) return job++;
            control.idle();
            return {};
        };
        engine::run_jobs(threads_, options_.pin, next, [&](int worker, long job) {
            Again& again = all[static_cast<std::size_t>(job)];
            again.result = engine_of(worker, engines, control).run_from_own_start(again.number, again.until);
        });
        RepeatedCases changes(sweep_, longer);
        for (const Again& again : all) {
            if (again.result.number < 0 || again.result.status == CaseStatus::stopped) return {};
            if (again.result.status == CaseStatus::ok) changes.add(layout, rows.of_case(again.number), again.result);
        }
        return changes.text();
    }

    /// A finished table is written once more in the order of cases.
    BatchReport report() {
        OrderedRows rows(file_);
        engine::CaseTable head = rows.head();
        progress_.cases = static_cast<long>(cases_.size());
        BatchReport result{folder_,
                           progress_,
                           rows.tally(),
                           rows.size() == cases_.size() && !(options_.shard.claims() && failing_alike_.hopeless()),
                           rows.hash(),
                           threads_,
                           {},
                           head.attribute("continuation_error"),
                           head.attribute("steady_check")};
        if (!result.finished && failing_alike_.hopeless()) result.hopeless = failing_alike_.text();
        const bool checks = result.finished && !options_.shard.claims();  // of workers' cases, when they are merged
        if (checks && (progress_.done > 0 || result.continuation_error.empty()))
            result.continuation_error = repeat(rows, cases_to_check(sweep_, cases_), false);
        if (checks && (progress_.done > 0 || result.steady_check.empty()))
            result.steady_check =
                repeat(rows, draw_cases(sweep_.cases(), sweep_.steady() ? sweep_.confirmation.cases : 0, sweep_.confirmation.seed), true);
        head.set({"continuation_error", result.continuation_error});
        head.set({"steady_check", result.steady_check});
        head.set({"status", result.finished ? "finished" : "interrupted"});
        head.set({"results_hash", result.results_hash});
        engine::write_cases(permit_, head, rows.size(), [&rows](std::size_t first, std::span<std::byte> some) { rows.fill(first, some); });
        std::error_code not_empty;
        fs::remove(places().checkpoints, not_empty);
        if (result.finished) remove_case_files(places().checkpoints, places().continuation, sweep_);
        return result;
    }

    const Sweep& sweep_;
    const BatchOptions& options_;
    std::string folder_, file_;
    engine::Permit permit_;
    std::unique_ptr<engine::FolderLock> lock_;  ///< lock of the folder; nullptr for a worker, whose caller holds it
    const engine::Cancellation& cancel_;
    int threads_;
    StartStates starts_;
    BatchControl control_;
    std::vector<long> cases_;
    std::ptrdiff_t taken_ = 0;  ///< first of a worker's cases, ascending: those that it had when it began
    FailingAlike failing_alike_;
    std::vector<char> done_;
    std::size_t position_ = 0;
    BatchProgress progress_;
    engine::Mutex mutex_;
    std::chrono::steady_clock::time_point started_;
};

}  // namespace

BatchReport run_batch(const Sweep& sweep, const BatchOptions& options) {
    std::error_code reported_later;
    fs::create_directory(options.folder, reported_later);  // the folder of all shards must be there before that of one
    return Session(sweep, options).run();
}

}  // namespace cvtflow::tasks
