#pragma once
/// Efficiency of executors against the length of tasks, as text, CSV, JSON and pictures.

#include <string>
#include <vector>

#include "bench/study/granularity/granularity.hpp"
#include "tools/program/plot/plot.hpp"

namespace cvtflow::bench {

/// METG(50 %) of every executor (rows) by number of tasks (columns) [us]; "<0.1": the shortest tasks sufficed; "-": none was long enough.
[[nodiscard]] std::string granularity_table(const Granularity& result);
/// A row per point, provenance in every row.
[[nodiscard]] std::string granularity_csv(const Granularity& result);
[[nodiscard]] std::string granularity_json(const Granularity& result, const GranularityOptions& options);
/// Efficiency against length, a curve per executor: one picture for every number of tasks.
[[nodiscard]] std::vector<tools::Plot> efficiency_plots(const Granularity& result);
/// METG(50 %) against the number of tasks, a curve per executor.
[[nodiscard]] tools::Plot granularity_plot(const Granularity& result);

}  // namespace cvtflow::bench
