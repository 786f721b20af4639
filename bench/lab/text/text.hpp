#pragma once
/// Texts of several commands: methods with steps, as written on the command line (METHOD@STEP, METHOD@auto, METHOD@LONGEST~TOLERANCE);
/// description of a method that is a table of stages; results of a run's energy watch as text and columns, the same in every command that
/// compares runs; drawings of graphs, in Graphviz' language.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/study/run_watch.hpp"
#include "engine/graph/task_graph.hpp"
#include "engine/method/stage_plan.hpp"

namespace cvtflow::bench {

/// A time above 0 with or without its unit [s]. @throws tasks::SceneError that begins with the option
[[nodiscard]] double read_time(const std::string& option, const std::string& text);

/// "dumka3-p5@2us", "leapfrog-sweep@auto", "dopri54@1us~1e-3" (a tolerance) as settings of a scene. @throws tasks::SceneError
[[nodiscard]] std::vector<std::string> read_choice(const std::string& choice);

/// Lines with everything that is derived from the table: stages, order, stability, growth and gain, error estimate.
/// @param length growth and gain are measured on [-length, 0]; 0: on the real interval of stability
[[nodiscard]] std::string method_figures(const engine::StagePlan& plan, double length = 0.0);

/// The table itself, a line per stage.
[[nodiscard]] std::string method_table(const engine::StagePlan& plan);

/// Residual of the energy balance over the losses, "3.1e-05"; "-" for a run that ended early.
[[nodiscard]] std::string residual_cell(const tasks::Fault& fault, const WatchResult& watch);
/// Remark on a run whose balance does not close; empty for others.
[[nodiscard]] std::string unreliable_remark(const tasks::Fault& fault, const WatchResult& watch);
/// "240 us are 0.3 pin periods: slip and efficiency are means over at least 16 (about 11 ms here)"; empty if it is long enough.
[[nodiscard]] std::string too_short(const WatchResult& watch);

/// Status and figures of a run as an object; names and numbers alone for a fault.
[[nodiscard]] nlohmann::ordered_json watch_json(const tasks::Fault& fault, const WatchResult& watch);

/// One cycle of a frozen graph, levels from left to right.
[[nodiscard]] std::string to_dot(const engine::TaskGraph& graph, int cycle);

}  // namespace cvtflow::bench
