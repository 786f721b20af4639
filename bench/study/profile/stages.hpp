#pragma once
/// Distribution of the time of a recorded run: by stage of the step and by thread, and the losses between tasks.

#include <string>
#include <vector>

#include "bench/executor/span_recorder.hpp"
#include "engine/graph/task_graph.hpp"

namespace cvtflow::bench {

struct StageRow {
    std::string name;
    char letter;  ///< letter in bar charts, unique while letters and digits last
    bool task;
};

/// Activities of a thread, a row each: entering the run, the stages of tasks as their graphs name them, controller, waiting, leaving. There
/// is no list of stages: a method that adds cycles to a graph names their stages there.
class StageTable {
public:
    StageTable();
    /// Adds the stages of a graph's tasks that are not there yet, in the order of its tasks.
    void add(const engine::TaskGraph& graph);

    [[nodiscard]] const std::vector<StageRow>& rows() const noexcept { return rows_; }
    [[nodiscard]] std::size_t size() const noexcept { return rows_.size(); }
    /// Row of a stage. @throws std::invalid_argument if no graph that was added has it
    [[nodiscard]] std::size_t row(const std::string& name) const;
    /// Row of a span that is no task.
    [[nodiscard]] std::size_t row(int code) const noexcept;

private:
    std::vector<StageRow> rows_;
};

/// Time of one thread [s], a number per row of the table that it was summed up with.
struct ThreadTimes {
    std::vector<double> seconds;  ///< [s]
    [[nodiscard]] double at(std::size_t row) const noexcept { return row < seconds.size() ? seconds[row] : 0.0; }
    [[nodiscard]] double controller() const noexcept { return from_end(3); }
    [[nodiscard]] double wait() const noexcept { return from_end(2); }
    [[nodiscard]] double tasks() const noexcept;
    [[nodiscard]] double total() const noexcept;

private:
    [[nodiscard]] double from_end(std::size_t place) const noexcept {
        return seconds.size() < place ? 0.0 : seconds[seconds.size() - place];
    }
};

using Spans = std::vector<std::vector<Span>>;  // [thread]

/// One recorded run of an executor.
struct RecordedPass {
    std::vector<ThreadTimes> threads;
    double wall = 0.0;        ///< time from the first thread's entering to the last one's leaving [s]
    double cycles = 0.0;      ///< runs of a sub-graph; fractional only if stamps were lost
    double levels = 0.0;      ///< levels within these: each ends with a synchronisation [1]
    double task_count = 0.0;  ///< [1]

    [[nodiscard]] int active() const noexcept;  ///< number of threads that ran any task
    [[nodiscard]] double sum(std::size_t row) const noexcept;
    [[nodiscard]] double tasks() const noexcept;       ///< task time of all threads [s]
    [[nodiscard]] double controller() const noexcept;  ///< [s]
    [[nodiscard]] double wait() const noexcept;        ///< waiting time of all threads [s]

    /// Time that every active thread loses per cycle, neither in a task nor because the controller works [s]:
    ///
    ///     (sum of the waits of the n active threads - (n - 1) x controller time) / (n x cycles)
    ///
    /// which is (n x time - n x controller - sum of task times) / (n x cycles) without entering and leaving. Uneven segments are part of
    /// it.
    [[nodiscard]] double synchronisation() const noexcept;
    /// Minimum effective task granularity: task length at which half of a thread's time is lost; the loss per level, of which each has a
    /// task per thread [s].
    [[nodiscard]] double min_task() const noexcept;
    /// Longest over mean task time of all threads, over the whole run: 1 is even, the number of threads if only one worked.
    [[nodiscard]] double imbalance() const noexcept;
    /// Share of the time between entering and leaving that is no task, for a run of one thread: the serial share of Amdahl's law.
    [[nodiscard]] double serial_share() const noexcept;
};

/// Sums a run up. Spans of exactly one run, from SpanRecorder::spans(); the table contains the graph.
[[nodiscard]] RecordedPass sum_up(const engine::TaskGraph& graph, const StageTable& stages, const Spans& spans);

}  // namespace cvtflow::bench
