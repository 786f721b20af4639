#pragma once
/// Functions shared by the commands for sweeps.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tasks/batch/batch.hpp"
#include "tools/program/guard.hpp"

namespace cvtflow::tools {

/// Help of --keep-going.
inline constexpr const char* keep_going_meaning = "Continue a sweep if its first dozen cases all fail with the same message";

/// The sweep whose results a folder contains. @throws SimulationError, engine::RecordError
[[nodiscard]] std::string sweep_of(const std::string& folder);

struct SweepOutput {
    bool quiet = false;  ///< errors only, and with `json` the summary
    bool json = false;   ///< progress and summary as lines of JSON
};

/// Runs or continues a sweep, together with every other process that runs it in that folder; shows progress and a summary.
ExitStatus run_sweep(const tasks::Sweep& sweep, tasks::BatchOptions options, SweepOutput output);

/// Lines of a summary: statuses, how many cases failed and with which messages, how many have which notes.
[[nodiscard]] std::string tally_text(const tasks::CaseTally& tally);
/// Members of a JSON object for them: statuses, failed, failures, notes.
[[nodiscard]] nlohmann::ordered_json tally_json(const tasks::CaseTally& tally);

}  // namespace cvtflow::tools
