#pragma once
/// How far the sweep in a folder is: of one process, of shards or of workers, running or not.

#include <string>
#include <vector>

#include "engine/record/case_table.hpp"
#include "tasks/batch/results/results.hpp"

namespace cvtflow::tasks {

struct FolderProgress {
    /// The folder itself, or that of a shard or worker.
    struct Part {
        std::string folder;
        long done = 0;         ///< cases in its table
        long claimed = 0;      ///< cases that a worker has claimed; otherwise as `done`
        bool running = false;  ///< a process writes into it
    };

    engine::CaseTable head;   ///< attributes and columns of the sweep, no rows
    long cases = 0;           ///< of the sweep
    CaseTally tally;          ///< of cases that are done, each once
    std::vector<Part> parts;  ///< empty: the folder contains no table of a sweep

    [[nodiscard]] long running() const noexcept;  ///< number of parts
};

/// Reads all tables of the folder; writes and locks nothing.
/// @throws engine::RecordError  a table that cannot be read; SimulationError  tables of different sweeps
[[nodiscard]] FolderProgress folder_progress(const std::string& folder);

}  // namespace cvtflow::tasks
