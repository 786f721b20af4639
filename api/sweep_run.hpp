#pragma once
/// Sweeps for hosts. Internal to api.

#include <functional>
#include <string>

#include "engine/executor/cancellation.hpp"
#include "tasks/batch/batch.hpp"

namespace cvtflow::api {

/// Runs the cases that are missing in the folder; tuned before and verified after, where the sweep has an accuracy.
/// @param progress called after each case, by one thread at a time   @return whether all cases are in the table; false after a cancellation
/// @throws Error (record, state, argument)
[[nodiscard]] bool run_sweep(const tasks::Sweep& sweep, const std::string& folder, int threads, engine::Cancellation& cancel,
                             std::function<void(const tasks::BatchProgress&)> progress);

}  // namespace cvtflow::api
