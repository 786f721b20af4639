#include "tasks/batch/folder_progress.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "engine/record/run/part_file.hpp"
#include "tasks/batch/batch.hpp"

namespace cvtflow::tasks {

namespace {

namespace fs = std::filesystem;

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
