#include <fmt/format.h>
#include <algorithm>
#include <charconv>
#include <filesystem>
#include <map>
#include <numeric>
#include <queue>

#include "engine/record/run/part_file.hpp"
#include "tasks/batch/batch.hpp"
#include "tasks/batch/case_engine.hpp"
#include "tasks/batch/results/sweep_files.hpp"

namespace cvtflow::tasks {

namespace {

/// Cost of every strand.
std::vector<double> strand_costs(const Sweep& sweep) {
    Scene scene = sweep.scene;
    CaseCosts cost(sweep);
    std::vector<double> costs(static_cast<std::size_t>(sweep.cases() / sweep.strand()), 0.0);
    for (long number = 0; number < sweep.cases(); ++number) {
        sweep.apply_case(number, scene);
        costs[static_cast<std::size_t>(number / sweep.strand())] +=
            cost.of_run(scene, number % sweep.strand() != 0) +
            (number % sweep.strand() == 0 && cost.settles(scene) ? cost.of_settling(scene) : 0.0);
    }
    return costs;
}

}  // namespace

namespace fs = std::filesystem;

std::string Shard::text() const { return claims() ? fmt::format("worker {}", number) : fmt::format("{}/{}", number, of); }

std::optional<Shard> Shard::from(std::string_view text) noexcept {
    constexpr std::string_view claiming = "worker ";
    const bool claims = text.starts_with(claiming);
    if (claims) text.remove_prefix(claiming.size());
    const auto read = [&text](int& number) {
        const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), number);
        text.remove_prefix(static_cast<std::size_t>(rest - text.data()));
        return error == std::errc{} && number >= 1;
    };
    Shard shard{0, 0};
    if (!read(shard.number)) return {};
    if (claims) return text.empty() ? std::optional(shard) : std::nullopt;
    if (!text.starts_with('/')) return {};
    text.remove_prefix(1);
    if (!read(shard.of) || !text.empty() || shard.number > shard.of || shard.of > max_shards) return {};
    return shard;
}

std::string workers_folder(const std::string& folder) { return (fs::path(folder) / "workers").string(); }
void make_workers_folder(const std::string& folder) {
    for (const std::string& made : {folder, workers_folder(folder)}) static_cast<void>(engine::FolderLock::if_free(made));
}
std::string claims_file(const std::string& folder) { return (fs::path(workers_folder(folder)) / "claims").string(); }
std::string shard_folder(const std::string& folder, const Shard& shard) {
    return shard.whole() ? folder : (fs::path(workers_folder(folder)) / fmt::format("{:04}", shard.number)).string();
}

std::optional<Shard> shard_in(const std::string& folder) {
    const std::string file = (fs::path(folder) / "cases.h5").string();
    std::error_code absent;
    if (!fs::exists(file, absent)) return {};
    return Shard::from(engine::CaseReader(file).head().attribute("shard"));
}

std::vector<long> shard_cases(const Sweep& sweep, const Shard& shard) {
    std::vector<long> cases;
    if (shard.whole()) {
        cases.resize(static_cast<std::size_t>(sweep.cases()));
        std::iota(cases.begin(), cases.end(), 0L);
        return cases;
    }
    const std::vector<double> costs = strand_costs(sweep);
    std::vector<std::size_t> order(costs.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return costs[a] > costs[b]; });
    using Load = std::pair<double, int>;  // of equal loads the shard with the smaller number
    std::priority_queue<Load, std::vector<Load>, std::greater<>> loads;
    for (int i = 1; i <= shard.of; ++i) loads.emplace(0.0, i);
    for (const std::size_t strand : order) {
        const auto [load, number] = loads.top();
        loads.pop();
        loads.emplace(load + costs[strand], number);
        if (number != shard.number) continue;
        for (long k = 0; k < sweep.strand(); ++k) cases.push_back(static_cast<long>(strand) * sweep.strand() + k);
    }
    std::sort(cases.begin(), cases.end());
    return cases;
}

namespace {

/// Folders of workers that have tables, also with the names of version 0.3, DIR/shard-0001-of-0008. Sorted.
std::vector<std::string> parts_of(const std::string& folder) {
    std::vector<std::string> parts;
    std::error_code unreadable;
    for (const std::string& place : {folder, workers_folder(folder)})
        for (const auto& entry : fs::directory_iterator(place, unreadable))
            if (fs::exists(entry.path() / "cases.h5", unreadable)) parts.push_back(entry.path().string());
    std::sort(parts.begin(), parts.end());
    return parts;
}

class Merge {
public:
    Merge(const std::string& folder, bool mixed) : folder_(folder), mixed_(mixed) {
        report_.file = (fs::path(folder) / "cases.h5").string();
    }

    MergeReport run(bool partial) {
        const std::vector<std::string> parts = parts_of(folder_);
        if (parts.empty()) throw SimulationError(folder_ + ": contains no tables of workers to merge");
        const engine::FolderLock lock(folder_);
        for (const std::string& part : parts) add((fs::path(part) / "cases.h5").string());
        find_missing();
        const bool whole = report_.missing_cases.empty() && report_.missing_shards.empty();
        if (whole || partial) write(whole);
        return report_;
    }

private:
    /// Notes whose rows a table has. @throws SimulationError  not of the division of the others
    void note_shard(const std::string& file, const std::string& text) {
        const Shard shard = Shard::from(text).value_or(Shard{});
        if (shards_.empty()) division_ = shard;
        if (shard.of != division_.of)
            throw SimulationError(
                fmt::format("{}: rows of {}, beside those of {}: remove the wrong ones", file, shard.text(), division_.text()));
        shards_.insert(shard.number);
    }

    /// A case may be there twice, with equal results: its first row is taken.
    void add(const std::string& file) {
        const engine::CaseTable part = read_results(file);
        if (!table_) {
            table_ = part;
            table_->rows.clear();
        }
        require_same_sweep(file, part, *table_);
        require_same_origin(file, *table_, part, mixed_);
        note_shard(file, part.attribute("shard"));
        if (const std::string error = part.attribute("continuation_error"); !error.empty()) errors_.push_back(error);
        const std::size_t number = part.layout.column("case");
        for (std::size_t i = 0; i < part.size(); ++i) {
            const auto row = part.row(i);
            if (!seen_.insert(part.layout.integer(row, number)).second) continue;
            report_.tally.add(part.layout, row);
            table_->rows.insert(table_->rows.end(), row.begin(), row.end());
        }
    }

    void find_missing() {
        report_.cases = cases_of(*table_, folder_);
        report_.rows = static_cast<long>(table_->size());
        for (long number = 0; number < report_.cases; ++number) {
            if (!seen_.contains(number)) report_.missing_cases.push_back(number);
        }
        for (int number = 1; number <= division_.of; ++number)
            if (!shards_.contains(number)) report_.missing_shards.push_back(shard_folder(folder_, {number, division_.of}));
    }

    /// A table with more cases than the workers have is not of these workers.
    void require_no_more_cases() const {
        std::error_code absent;
        if (!fs::exists(report_.file, absent)) return;
        const std::size_t there = engine::CaseReader(report_.file).size();
        if (there <= table_->size()) return;
        throw engine::RecordError(
            fmt::format("{}: has {} cases, the workers have {}; move it away to merge them", report_.file, there, table_->size()));
    }

    void write(bool whole) {
        const engine::Permit permit = permit_table(report_.file, table_->attribute("definition"));
        require_no_more_cases();
        sort_rows(*table_);
        report_.results_hash = results_hash(*table_);
        table_->set({"shard", Shard{}.text()});
        table_->set({"continuation_error", fmt::format("{}", fmt::join(errors_, "; "))});
        table_->set({"status", whole ? "finished" : "incomplete"});
        table_->set({"missing_cases", fmt::format("{}", fmt::join(report_.missing_cases, " "))});
        table_->set({"results_hash", report_.results_hash});
        engine::write_cases(permit, *table_);
    }

    std::string folder_;
    bool mixed_;
    MergeReport report_;
    std::optional<engine::CaseTable> table_;
    std::set<std::int64_t> seen_;
    Shard division_;
    std::set<int> shards_;
    std::vector<std::string> errors_;
};

}  // namespace

bool awaits_workers(const std::string& folder) try {
    const std::string file = (fs::path(folder) / "cases.h5").string();
    std::error_code absent;
    if (!fs::exists(file, absent)) return true;
    const std::string status = engine::CaseReader(file).head().attribute("status");
    return fs::exists(claims_file(folder), absent) ? status == "incomplete" : status != "finished";
} catch (const engine::RecordError&) {
    return false;  // damaged: recovered or reported where it is continued
}

WorkerPlaces::WorkerPlaces(const Sweep& sweep, const std::string& folder) : sweep_(sweep), folder_(folder) {
    std::error_code absent;
    if (fs::exists(fs::path(folder) / "cases.h5", absent) && !fs::exists(claims_file(folder), absent))
        throw SimulationError(folder + ": this sweep was begun without workers; continue it without --worker");
    make_workers_folder(folder);
    const engine::CaseTable here = empty_table(sweep);
    for (const std::string& part : parts_of(folder)) {
        try {
            const std::string file = (fs::path(part) / "cases.h5").string();
            engine::CaseReader table(file);
            require_same_sweep(file, table.head(), here);
            const std::optional<Shard> shard = Shard::from(table.head().attribute("shard"));
            if (shard && !shard->claims())
                throw SimulationError(fmt::format("{}: this sweep was begun with --shard {}; continue it so", part, shard->text()));
        } catch (const engine::RecordError&) {}  // damaged: recovered or reported by the worker that takes this place
    }
}

/// Whether a worker has not done all that it has claimed. @throws engine::RecordError
bool WorkerPlaces::has_work(int number, const std::vector<engine::Claim>& claims) const {
    const std::string file = shard_folder(folder_, {number, 0}) + "/cases.h5";
    std::error_code absent;
    const bool claimed = std::ranges::any_of(claims, [&](const engine::Claim& claim) { return claim.worker == number; });
    if (!claimed || !fs::exists(file, absent)) return claimed;
    try {
        OrderedRows rows(file);
        return std::ranges::any_of(claims, [&](const engine::Claim& claim) {
            for (long k = claim.first; claim.worker == number && k < std::min(claim.end(), sweep_.cases()); ++k)
                if (rows.of_case(k).empty()) return true;
            return false;
        });
    } catch (const engine::RecordError&) {
        return true;  // damaged: the worker that takes this place recovers or reports it
    }
}

std::optional<WorkerPlace> WorkerPlaces::next() {
    const std::vector<engine::Claim> claims = engine::read_claims(claims_file(folder_));
    const bool open = claims.empty() || claims.back().end() < sweep_.cases();
    std::set<int> workers;
    for (const engine::Claim& claim : claims) workers.insert(claim.worker);
    for (int number = 1; open || number <= (workers.empty() ? 0 : *workers.rbegin()); ++number) {
        if (!open) number = *workers.lower_bound(number);
        if (!open && finished_.contains(number)) continue;
        std::unique_ptr<engine::FolderLock> lock = engine::FolderLock::if_free(shard_folder(folder_, {number, 0}));
        if (lock == nullptr) continue;
        if (open || has_work(number, claims)) return WorkerPlace{number, std::move(lock)};
        finished_.insert(number);
    }
    done_ = !open && finished_.size() >= workers.size();
    return {};
}

MergeReport merge(const std::string& folder, bool partial, bool mixed) { return Merge(folder, mixed).run(partial); }

long FolderProgress::running() const noexcept {
    return std::count_if(parts.begin(), parts.end(), [](const Part& part) { return part.running; });
}

FolderProgress folder_progress(const std::string& folder) {
    FolderProgress progress;
    std::set<std::int64_t> seen;
    std::error_code absent;
    const bool whole = fs::exists(fs::path(folder) / "cases.h5", absent);
    for (const std::string& each : whole ? std::vector{folder} : parts_of(folder)) {
        const std::string file = (fs::path(each) / "cases.h5").string();
        engine::CaseTable table = read_results(file);
        if (progress.parts.empty()) {
            progress.cases = cases_of(table, file);
            progress.head.layout = table.layout;
            progress.head.attributes = table.attributes;
        }
        require_same_sweep(file, table, progress.head);
        for (std::size_t row = 0; row < table.size(); ++row)
            if (seen.insert(table.layout.integer(table.row(row), table.layout.column("case"))).second)
                progress.tally.add(table.layout, table.row(row));
        const long done = static_cast<long>(table.size());
        progress.parts.push_back({each, done, done, engine::being_written((fs::path(each) / "lock").string())});
    }
    std::map<std::string, long> claimed;
    for (const engine::Claim& claim : engine::read_claims(claims_file(folder)))
        claimed[shard_folder(folder, {claim.worker, 0})] += claim.cases;
    for (FolderProgress::Part& part : progress.parts)
        if (const auto found = claimed.find(part.folder); found != claimed.end()) part.claimed = found->second;
    return progress;
}

}  // namespace cvtflow::tasks
