#pragma once
/// Minimum length of tasks: efficiency of executors against the length of a task, as Task Bench does it (Slaughter et al., SC20), on our
/// graph.
///
/// A cycle is a stencil like that of a chain's segments: levels of equally many tasks, each of which waits for itself and its two
/// neighbours of the level before, in a ring. Between cycles the controller is called, as in a step. Every task does the same arithmetic,
/// which depends on itself. The total work of a measurement is the same for every length, so that short tasks are many.

#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "bench/study/profile/statistics.hpp"
#include "engine/graph/task_graph.hpp"
#include "engine/thread/executor_options.hpp"

namespace cvtflow::bench {

struct GranularityOptions {
    std::vector<std::string> executors{};            ///< none: all
    int threads = 0;                                 ///< threads of the parallel executors; 0: all usable ones
    std::vector<int> tasks{1, 2, 4, 8, 16, 32, 64};  ///< tasks per level
    std::vector<double> lengths{0.1e-6, 0.2e-6, 0.5e-6, 1e-6, 2e-6, 5e-6, 10e-6, 20e-6, 50e-6, 100e-6};  ///< ascending task lengths [s]
    int levels = 8;                                                                                      ///< levels per cycle
    double work = 4e-3;      ///< work per measurement, all tasks together [s]
    double timeout = 20e-3;  ///< time after which a measurement ends even if work is left [s]
    int rounds = 5;
    engine::Wait wait = engine::Wait::balanced;
    bool pin = false;
};

/// One executor on levels of tasks of one length.
struct GranularityPoint {
    std::string executor;
    int threads = 1;
    int tasks = 1;
    double length = 0.0;  ///< nominal [s]
    double cycle = 0.0;   ///< median time of a cycle [s]
    double ideal = 0.0;   ///< median time of a cycle without any overhead: the work of a bare loop, whole tasks shared evenly [s]
    Spread efficiency{};  ///< ideal over cycle of the same round [1]
};

struct Granularity {
    std::vector<GranularityPoint> points;  ///< points by number of tasks, length, executor
    double calibrated = 0.0;               ///< smallest share of the requested processors that calibrations before and after got
    int requested = 1;                     ///< threads, or the usable processors if these are fewer

    [[nodiscard]] bool crowded() const noexcept;
    /// Executors in the order of the points.
    [[nodiscard]] std::vector<std::string> executors() const;
    /// Numbers of tasks in the order of the points.
    [[nodiscard]] std::vector<int> tasks() const;
    /// Points of one executor and number of tasks, by length.
    [[nodiscard]] std::vector<GranularityPoint> curve(const std::string& executor, int tasks) const;
};

/// The stencil. @throws std::invalid_argument unless both are positive
[[nodiscard]] engine::TaskGraph stencil_graph(int levels, int tasks);

/// Time of a level of whole tasks, shared evenly by the threads, over the time of all tasks one after the other [1].
[[nodiscard]] double ideal_share(int tasks, int threads) noexcept;

/// Minimum effective task granularity: the length from which on the efficiency is at least `share`, interpolated in the logarithm of the
/// length [s]. The shortest length if the whole curve is (then it is an upper bound); infinity if its last point is not.
/// @param curve ascending lengths
[[nodiscard]] double effective_granularity(std::span<const GranularityPoint> curve, double share = 0.5) noexcept;

/// @param progress called with a line before every round; may be empty
/// @throws SceneError for an unknown executor; std::invalid_argument for numbers that are not positive
[[nodiscard]] Granularity measure_granularity(const GranularityOptions& options,
                                              const std::function<void(const std::string&)>& progress = {});

}  // namespace cvtflow::bench
