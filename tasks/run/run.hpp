#pragma once
/// A whole run of a scene: settle if needed, integrate, record, sum up. The work of `cvtflow run`, as a function.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/record/run/output_rule.hpp"
#include "tasks/run/checkpoint.hpp"
#include "tasks/run/run_report.hpp"

namespace cvtflow::tasks {

/// How far a run has come; delivered at output times.
struct Progress {
    double begin, time, until;  ///< [s]; settling has begin < 0 = until
    double wall;                ///< since the run began [s]
    const Counters& counters;
    [[nodiscard]] bool settling() const noexcept { return begin < 0.0; }
};

struct RunOptions {
    engine::Permit file;                            ///< record to write; empty: none. A text permits a new file
    std::function<void(const Progress&)> progress;  ///< called at every output time, serially
    const engine::Cancellation* cancel = nullptr;
    std::string checkpoint;                          ///< file to write checkpoints to; empty: none
    double checkpoint_every = 0.0;                   ///< wall time between checkpoints, at output times; 0: only if the run ends early [s]
    std::function<void(const std::string&)> notice;  ///< receives warnings before the run begins
    const Checkpoint* from = nullptr;                ///< checkpoint to resume; `file` is then the record to continue (record_to_continue)
    bool replace = false;                            ///< with `from`: whether a file of that name that is not the run's own is replaced
    std::string replaces;                            ///< identity of the run whose record `file` replaces; empty: of none
    bool mixed = false;                              ///< with `from`: whether the checkpoint may be of another version of the program
};

/// Runs the scene to run.until. A fault ends the run with what was recorded so far on file and is part of the report.
/// A run that ends early (cancelled, budget) writes a checkpoint if RunOptions::checkpoint is set. A finished one deletes its checkpoint,
/// if the record contains its state.
/// @throws SimulationError (also if the run would end before its checkpoint), engine::RecordError, std::invalid_argument before the run;
/// engine::RecordError during it (disk full)
[[nodiscard]] RunReport run_scene(const Scene& scene, const RunOptions& options);

/// Settling ended before t = 0.
class SettlingFault : public SimulationError {
public:
    explicit SettlingFault(Fault why) : SimulationError("settling: " + why.message()), fault(why) {}
    Fault fault;
};

/// Settles a scene's geometric start and writes the state at t = 0.
/// @return EnergyLedger::balance_error_ratio(): above 1 the state is wrong; also stored in the file
/// @throws as run_scene; SettlingFault, and then writes nothing
double settle_scene(const Scene& scene, const engine::Permit& state_file, const RunOptions& options);

}  // namespace cvtflow::tasks
