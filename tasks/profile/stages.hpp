#pragma once
/// Where the time of a recorded run goes: by stage of the step and by thread, and what is lost between tasks.

#include <array>
#include <string_view>
#include <vector>

#include "engine/executor/stamp_recorder.hpp"
#include "engine/graph/task_graph.hpp"

namespace cvtflow::tasks {

/// In the order of a step; tasks from `combine` to `transition`.
enum class Stage { enter, combine, contact, chain, force, boundary, cholesky, transition, controller, wait, exit };

struct StageRow {
    Stage stage;
    std::string_view name;
    char letter;   ///< in bar charts
    bool task;
};

/// One row per stage, in order.
[[nodiscard]] const std::array<StageRow, 11>& stages() noexcept;

/// Stage of a task by its name: "contact[3]" → contact, "forward" and "reverse[0]" → cholesky, "detect[1]" → transition.
/// @throws std::invalid_argument for a name that no graph of this program uses
[[nodiscard]] Stage stage_of(std::string_view task_name);

/// Time of one thread by stage [s].
struct ThreadTimes {
    std::array<double, 11> seconds{};
    [[nodiscard]] double at(Stage stage) const noexcept { return seconds[static_cast<std::size_t>(stage)]; }
    [[nodiscard]] double tasks() const noexcept;
    [[nodiscard]] double total() const noexcept;
};

using Spans = std::vector<std::vector<engine::Span>>;   // [thread]

/// One recorded run of an executor.
struct RecordedPass {
    std::vector<ThreadTimes> threads;
    double wall = 0.0;        ///< from the first thread's entering to the last one's leaving [s]
    double cycles = 0.0;      ///< runs of a sub-graph; fractional only if stamps were lost
    double levels = 0.0;      ///< levels within these: each ends with a synchronisation
    double task_count = 0.0;

    [[nodiscard]] int active() const noexcept;           ///< threads that ran any task
    [[nodiscard]] double sum(Stage stage) const noexcept;
    [[nodiscard]] double tasks() const noexcept;         ///< [s], of all threads

    /// Time that every active thread loses per cycle, neither in a task nor because the controller works [s]:
    ///
    ///     (sum of the waits of the n active threads - (n - 1) x controller time) / (n x cycles)
    ///
    /// which is (n x time - n x controller - sum of task times) / (n x cycles) without entering and leaving. Uneven segments are part of it.
    [[nodiscard]] double synchronisation() const noexcept;
    /// Minimum effective task granularity: task length at which half of a thread's time is lost; the loss per level, of which each has a
    /// task per thread [s].
    [[nodiscard]] double least_task() const noexcept;
    /// Longest over mean task time of all threads, over the whole run: 1 is even, the number of threads if only one worked.
    [[nodiscard]] double imbalance() const noexcept;
    /// Share of the time between entering and leaving that is no task, for a run of one thread: what Amdahl's law calls serial.
    [[nodiscard]] double serial_share() const noexcept;
};

/// Sums a run up. Spans of exactly one run, as StampRecorder::spans() gives them.
[[nodiscard]] RecordedPass sum_up(const engine::TaskGraph& graph, const Spans& spans);

}  // namespace cvtflow::tasks
