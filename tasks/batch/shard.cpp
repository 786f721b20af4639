#include <fmt/format.h>
#include <algorithm>
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

std::string shard_folder(const std::string& folder, const Shard& shard) {
    return shard.of == 1 ? folder : (std::filesystem::path(folder) / fmt::format("shard-{:04}-of-{:04}", shard.number, shard.of)).string();
}

std::vector<long> shard_cases(const Sweep& sweep, const Shard& shard) {
    std::vector<long> cases;
    if (shard.of == 1) {
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

namespace fs = std::filesystem;

namespace {

/// Tables of all workers.
std::vector<std::string> worker_tables(const std::string& folder) {
    std::vector<std::string> tables;
    std::error_code absent;
    for (int worker = 1; fs::exists(worker_folder(folder, worker), absent); ++worker) {
        const std::string file = worker_folder(folder, worker) + "/cases.h5";
        if (fs::exists(file, absent)) tables.push_back(file);
    }
    return tables;
}

/// Number of shards, from the names of the folders. @throws SimulationError
int shard_count(const std::string& folder) {
    std::set<int> counts;
    std::error_code unreadable;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, unreadable)) {
        int number = 0, of = 0;
        if (std::sscanf(entry.path().filename().c_str(), "shard-%9d-of-%9d", &number, &of) == 2 && Shard{number, of}.valid())
            counts.insert(of);
    }
    if (counts.empty()) throw SimulationError(folder + ": contains no shards to merge");
    if (counts.size() > 1)
        throw SimulationError(
            fmt::format("{}: shards of different divisions ({}): remove the wrong ones", folder, fmt::join(counts, ", ")));
    return *counts.begin();
}

class Merge {
public:
    Merge(const std::string& folder, bool mixed) : folder_(folder), mixed_(mixed) {
        report_.file = (fs::path(folder) / "cases.h5").string();
    }

    MergeReport run(bool partial) {
        const std::vector<std::string> workers = worker_tables(folder_);
        const int shards = workers.empty() ? shard_count(folder_) : 0;
        const engine::FolderLock lock(folder_);
        for (int number = 1; number <= shards; ++number) add_shard(shard_folder(folder_, {number, shards}));
        for (const std::string& file : workers) add(file, true);
        if (!table_) throw SimulationError(folder_ + ": no shard has results");
        find_missing();
        const bool whole = report_.missing_cases.empty() && report_.missing_shards.empty();
        if (whole || partial) write(whole);
        return report_;
    }

private:
    void add_shard(const std::string& shard) {
        const std::string file = (fs::path(shard) / "cases.h5").string();
        std::error_code missing;
        if (!fs::exists(file, missing)) return report_.missing_shards.push_back(shard);
        add(file, false);
    }

    /// @param repeats  whether a case may be there twice, with equal results; its first row is taken
    void add(const std::string& file, bool repeats) {
        const engine::CaseTable part = read_results(file);
        if (!table_) {
            table_ = part;
            table_->rows.clear();
        }
        require_same_sweep(file, part, *table_);
        require_same_origin(file, *table_, part, mixed_);
        if (const std::string error = part.attribute("continuation_error"); !error.empty()) errors_.push_back(error);
        const std::size_t number = part.layout.column("case");
        for (std::size_t i = 0; i < part.size(); ++i) {
            const auto row = part.row(i);
            const bool repeated = !seen_.insert(part.layout.integer(row, number)).second;
            if (repeated && repeats) continue;
            if (repeated) throw SimulationError(fmt::format("{}: case {} is in two shards", file, part.layout.integer(row, number)));
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
    }

    /// A table with more cases than the shards have is not of these shards.
    void require_no_more_cases() const {
        std::error_code absent;
        if (!fs::exists(report_.file, absent)) return;
        const std::size_t there = engine::CaseReader(report_.file).size();
        if (there <= table_->size()) return;
        throw engine::RecordError(
            fmt::format("{}: has {} cases, the shards have {}; move it away to merge them", report_.file, there, table_->size()));
    }

    void write(bool whole) {
        const engine::Permit permit = permit_table(report_.file, table_->attribute("definition"));
        require_no_more_cases();
        sort_rows(*table_);
        report_.results_hash = results_hash(*table_);
        table_->set({"shard", "1/1"});
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
    std::vector<std::string> errors_;
};

}  // namespace

std::string workers_folder(const std::string& folder) { return (fs::path(folder) / "workers").string(); }
std::string worker_folder(const std::string& folder, int worker) {
    return (fs::path(workers_folder(folder)) / fmt::format("{:04}", worker)).string();
}
std::string claims_file(const std::string& folder) { return (fs::path(workers_folder(folder)) / "claims").string(); }

bool awaits_workers(const std::string& folder) try {
    const std::string file = (fs::path(folder) / "cases.h5").string();
    std::error_code absent;
    if (!fs::exists(file, absent)) return true;
    const std::string status = engine::CaseReader(file).head().attribute("status");
    return fs::exists(workers_folder(folder), absent) ? status == "incomplete" : status != "finished";
} catch (const engine::RecordError&) {
    return false;  // damaged: recovered or reported where it is continued
}

WorkerPlaces::WorkerPlaces(const Sweep& sweep, const std::string& folder) : sweep_(sweep), folder_(folder) {
    std::error_code absent;
    if (fs::exists(fs::path(folder) / "cases.h5", absent) && !fs::exists(workers_folder(folder), absent))
        throw SimulationError(folder + ": this sweep was begun without workers; continue it without --worker");
    for (const auto& entry : fs::directory_iterator(folder, absent))
        if (entry.path().filename().string().starts_with("shard-"))
            throw SimulationError(entry.path().string() + ": this sweep was begun as shards; continue it without --worker");
    for (const std::string& made : {folder, workers_folder(folder)}) static_cast<void>(engine::FolderLock::if_free(made));
    const engine::CaseTable here = empty_table(sweep);
    for (const std::string& file : worker_tables(folder)) {
        try {
            require_same_sweep(file, engine::CaseReader(file).head(), here);
        } catch (const engine::RecordError&) {}  // damaged: recovered or reported by the worker that takes this place
    }
}

/// Whether a worker has not done all that it has claimed. @throws engine::RecordError
bool WorkerPlaces::has_work(int number, const std::vector<engine::Claim>& claims) const {
    const std::string file = worker_folder(folder_, number) + "/cases.h5";
    std::error_code absent;
    const bool claimed = std::ranges::any_of(claims, [&](const engine::Claim& claim) { return claim.worker == number; });
    if (!claimed || !fs::exists(file, absent)) return claimed;
    try {
        OrderedRows rows(file);
        return std::ranges::any_of(claims, [&](const engine::Claim& claim) {
            for (long k = claim.first; claim.worker == number && k < claim.end(); ++k)
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
    int last = 0;
    for (const engine::Claim& claim : claims) last = std::max(last, claim.worker);
    for (int number = 1; open || number <= last; ++number) {
        if (!open && finished_.contains(number)) continue;
        std::unique_ptr<engine::FolderLock> lock = engine::FolderLock::if_free(worker_folder(folder_, number));
        if (lock == nullptr) continue;
        if (open || has_work(number, claims)) return WorkerPlace{number, std::move(lock)};
        finished_.insert(number);
    }
    done_ = !open && static_cast<int>(finished_.size()) >= last;
    return {};
}

MergeReport merge(const std::string& folder, bool partial, bool mixed) { return Merge(folder, mixed).run(partial); }

namespace {

/// The folder itself where it contains a table, otherwise those of its shards and workers. Sorted.
std::vector<std::string> part_folders(const std::string& folder) {
    std::error_code unreadable;
    if (fs::exists(fs::path(folder) / "cases.h5", unreadable)) return {folder};
    std::vector<std::string> parts;
    for (const std::string& place : {folder, workers_folder(folder)})
        for (const auto& entry : fs::directory_iterator(place, unreadable))
            if (fs::exists(entry.path() / "cases.h5", unreadable)) parts.push_back(entry.path().string());
    std::sort(parts.begin(), parts.end());
    return parts;
}

}  // namespace

long FolderProgress::running() const noexcept {
    return std::count_if(parts.begin(), parts.end(), [](const Part& part) { return part.running; });
}

FolderProgress folder_progress(const std::string& folder) {
    FolderProgress progress;
    std::set<std::int64_t> seen;
    for (const std::string& each : part_folders(folder)) {
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
    for (const engine::Claim& claim : engine::read_claims(claims_file(folder))) claimed[worker_folder(folder, claim.worker)] += claim.cases;
    for (FolderProgress::Part& part : progress.parts)
        if (const auto found = claimed.find(part.folder); found != claimed.end()) part.claimed = found->second;
    return progress;
}

}  // namespace cvtflow::tasks
