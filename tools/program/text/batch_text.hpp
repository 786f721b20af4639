#pragma once
/// Functions shared by the commands for sweeps.

#include <string>
#include <vector>

#include "tasks/batch/batch.hpp"
#include "tools/program/exit_status.hpp"

namespace cvtflow::tools {

/// Reads a sweep; scenes by name come from the ready ones.
[[nodiscard]] tasks::Sweep load_sweep(const std::string& path);

/// The sweep whose results a folder contains. @throws SimulationError, engine::RecordError
[[nodiscard]] std::string sweep_of(const std::string& folder);

/// Runs or continues a sweep; shows progress and a summary.
ExitStatus run_sweep(const tasks::Sweep& sweep, tasks::BatchOptions options, bool quiet);

/// Prints the verified errors of a table to stderr, if its sweep has a target accuracy; quiet: only if it is missed.
/// @return whether the target is met, or there is none   @throws engine::RecordError
bool say_verdict(const std::string& name, const std::string& file, bool quiet);

/// @throws UsageError for an unknown status
void require_statuses(const std::string& option, const std::vector<std::string>& given);

/// "38 ok, 2 diverged"
[[nodiscard]] std::string statuses_text(const std::map<std::string, long>& statuses);

}  // namespace cvtflow::tools
