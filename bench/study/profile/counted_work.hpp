#pragma once
/// Speed-ups from counted instructions: gain by threads if nothing but the work of tasks took time. Other load has no effect.

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "engine/graph/task_graph.hpp"
#include "tasks/scene/scene.hpp"

namespace cvtflow::bench {

/// Work of one number of threads. "Parallel" tasks have others beside them on their level; the others, the step's sequential tasks, are
/// left out of the first two speed-ups. The controller, which runs between cycles, is no task.
struct WorkRow {
    int threads = 1;
    int segments = 1;           ///< largest counted number that gives no thread more than one segment
    int links = 0;              ///< links of the longest of as many equal segments as threads
    double even = 1.0;          ///< links of the chain over links of this segment
    double longest = 0.0;       ///< parallel work of the slowest thread, a segment per thread [instructions per step]
    double fixed = 1.0;         ///< speed-up of the parallel tasks, a segment per thread [1]
    double claimed = 1.0;       ///< speed-up if threads claim tasks of the best number of segments
    int claimed_segments = 1;   ///< this number of segments
    double step_fixed = 1.0;    ///< speed-up of all tasks, a segment per thread [1]
    double step_claimed = 1.0;  ///< speed-up of all tasks if threads claim them
};

/// Work of all tasks of a stage, as one segment.
struct StageWork {
    std::string stage;
    double instructions = 0.0;  ///< instructions per step
};

struct CountedWork {
    std::vector<WorkRow> rows;      ///< one for every number of threads up to one per link
    std::vector<StageWork> stages;  ///< stages in the order of the graph
    double step = 0.0;              ///< length of the last step [s]
};

/// Links over the links of the longest of M equal segments: speed-up by M threads if nothing but whole links costs time.
[[nodiscard]] double even_speed_up(int links, int threads) noexcept;

/// Least time in which `threads` threads run a cycle, if each takes the next task that is ready: list scheduling in the graph's order.
/// @param work of every task of the graph   @return in units of the work
[[nodiscard]] double makespan(const engine::TaskGraph& graph, int cycle, std::span<const double> work, int threads);

/// Numbers of equal segments at which the longest one becomes shorter: 1, 2, 3 … links. Numbers between them are no faster.
[[nodiscard]] std::vector<int> shortening_segments(int links);

/// Counts every task once, in a step after some others, times how often it runs per step: 2 million instructions for a step of full detail
/// in 18 numbers of segments with AVX-512, 1 to 20 us each.
/// @param segments ascending, from 1: numbers that are counted   @param progress called with a line per number; may be empty
/// @throws as Simulation; std::runtime_error where instructions cannot be counted
[[nodiscard]] CountedWork count_work(const tasks::Scene& scene, const std::vector<int>& segments,
                                     const std::function<void(const std::string&)>& progress = {});

}  // namespace cvtflow::bench
