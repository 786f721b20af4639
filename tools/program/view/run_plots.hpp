#pragma once
/// Pictures of records.

#include <optional>
#include <string>
#include <vector>

#include "tools/program/plot/plot.hpp"
#include "tools/program/view/recorded_run.hpp"

namespace cvtflow::tools {

/// Curves over time, a plot per unit; several runs in each. Of runs that are longer than 60 pin periods, means over these.
/// @param words channels and groups; none: the overview   @param every_output also of long runs
/// @throws UsageError for a word that names nothing
[[nodiscard]] std::vector<Plot> time_plots(const std::vector<RecordedRun>& runs, const std::vector<std::string>& words, bool every_output);

/// Their amplitudes over orders of the pins that pass in the first run; over frequency where the record does not tell that.
[[nodiscard]] std::vector<Plot> order_plots(const std::vector<RecordedRun>& runs, const std::vector<std::string>& words);

/// The way of the followed pin in the plane of the chain. @throws UsageError if a record does not have it
[[nodiscard]] Plot round_plot(const std::vector<RecordedRun>& runs);

/// Losses of one run by kind over time, their means and shares in the legend, largest first. @param every_output as above
/// @throws UsageError if it has none
[[nodiscard]] Plot loss_plot(const RecordedRun& run, bool every_output);

/// Points thinned so that a line through them looks the same: the least and the largest of each of `columns` stretches.
[[nodiscard]] std::vector<Point> thinned(const std::vector<Point>& points, std::size_t columns);

/// What is drawn, as CSV: series, x, y, the labels of both axes.
[[nodiscard]] std::string csv(const std::vector<Plot>& plots);

}  // namespace cvtflow::tools
