#pragma once
/// What the commands for sweeps have in common.

#include <string>
#include <vector>

#include "tasks/batch/batch.hpp"
#include "tools/program/exit_status.hpp"

namespace cvtflow::tools {

/// Reads a sweep; scenes by name come from the ready ones.
[[nodiscard]] tasks::Sweep load_sweep(const std::string& path);

/// The sweep that a folder holds results of. @throws SimulationError, engine::RecordError
[[nodiscard]] std::string sweep_of(const std::string& folder);

/// Runs or goes on with a sweep, shows progress and the end.
ExitStatus run_sweep(const tasks::Sweep& sweep, tasks::BatchOptions options, bool quiet);

/// Says on stderr what a table's errors come to, if the sweep asked for an accuracy; quiet: only if it misses it.
/// @return whether it has it, or asked for none   @throws engine::RecordError
bool say_verdict(const std::string& name, const std::string& file, bool quiet);

/// @throws UsageError for a status that no case can have
void require_statuses(const std::string& option, const std::vector<std::string>& given);

/// "38 ok, 2 diverged"
[[nodiscard]] std::string statuses_text(const std::map<std::string, long>& statuses);

}  // namespace cvtflow::tools
