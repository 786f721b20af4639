#include "bench/study/profile/counted_work.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <queue>
#include <set>
#include <stdexcept>

#include "bench/count/instructions.hpp"
#include "bench/executor/span_recorder.hpp"
#include "bench/study/profile/measure.hpp"
#include "tasks/step/control/cycle_sequence.hpp"
#include "tasks/step/control/energy_ledger.hpp"

namespace cvtflow::bench {

using namespace tasks;

namespace {

constexpr long steps = 256;  // steps of the recording: some cycles do not run in every step

/// Tasks of a step with a number of segments.
struct CountedStep {
    std::vector<double> all;       ///< work of all tasks, by number of threads - 1 [instructions per step]
    std::vector<double> parallel;  ///< work of parallel tasks
    std::vector<StageWork> stages;
    double step = 0.0;  ///< [s]
};

/// Number of runs of each cycle in a step. Transitions, which come every so often, are left out.
std::vector<double> runs_per_step(const engine::TaskGraph& graph, const std::vector<Span>& spans) {
    std::vector<double> runs(static_cast<std::size_t>(graph.cycles()), 0.0);
    for (const Span& span : spans) {
        if (span.what >= 0) runs[static_cast<std::size_t>(graph.task(span.what).cycle)] += 1.0;
    }
    for (int cycle = 0; cycle < graph.cycles(); ++cycle) {
        const std::size_t tasks = graph.topological(cycle).size();
        if (cycle == locate_cycle || cycle == truncate_cycle) runs[static_cast<std::size_t>(cycle)] = 0.0;
        if (tasks > 0) runs[static_cast<std::size_t>(cycle)] /= static_cast<double>(tasks) * static_cast<double>(steps);
    }
    return runs;
}

/// Work of the tasks of cycles [instructions]. Takes a step in place: the trial is of no further use.
class WorkCounter {
public:
    /// @param runs of each cycle per step; one that does not run has no work
    WorkCounter(const Simulation& simulation, const std::vector<double>& runs)
        : graph_(simulation.integrator().runner().graph()),
          integrator_(const_cast<Integrator&>(simulation.integrator())),
          runs_(runs),
          counted_(runs.size(), false),
          work_(static_cast<std::size_t>(graph_.size()), 0.0) {}

    /// Cycles of the method inside the step that comes next, one of several runs in its second, since a first stage combines no slopes.
    /// Then all others. @throws SimulationError if the step fails
    [[nodiscard]] std::vector<double> count() {
        std::vector<int> begun(runs_.size(), 0);
        CycleSequence step = integrator_.method().step();
        for (int cycle = step.next(); cycle != engine::Controller::stop; cycle = step.next()) {
            const auto k = static_cast<std::size_t>(cycle);
            if (++begun[k] == (runs_[k] > 1.5 ? 2 : 1)) count(cycle);
            for (const int task : graph_.topological(cycle)) graph_.call(task)(&integrator_.workspace());
        }
        step.rethrow();
        if (step.fault()) throw SimulationError(step.fault().message());
        for (int cycle = 0; cycle < graph_.cycles(); ++cycle) {
            if (!counted_[static_cast<std::size_t>(cycle)]) count(cycle);
        }
        return work_;
    }

private:
    void count(int cycle) {
        if (runs_[static_cast<std::size_t>(cycle)] == 0.0) return;
        const auto& tasks = graph_.topological(cycle);
        std::vector<std::function<void()>> bodies;
        for (const int task : tasks) bodies.emplace_back([call = graph_.call(task), this] { call(&integrator_.workspace()); });
        const std::vector<Counted> counted = count_each(bodies);
        if (counted.size() != bodies.size())
            throw std::runtime_error("this system does not let a process count another one's instructions");
        for (std::size_t k = 0; k < counted.size(); ++k)
            work_[static_cast<std::size_t>(tasks[k])] = static_cast<double>(counted[k].instructions);
        counted_[static_cast<std::size_t>(cycle)] = true;
    }

    const engine::TaskGraph& graph_;
    Integrator& integrator_;
    const std::vector<double>& runs_;
    std::vector<bool> counted_;  ///< [cycle]
    std::vector<double> work_;   ///< [task]
};

/// Stages of which every task is alone on its level.
std::set<std::string> sequential_stages(const engine::TaskGraph& graph) {
    std::set<std::string> alone, beside;
    for (int cycle = 0; cycle < graph.cycles(); ++cycle) {
        for (int level = 0; level < graph.levels(cycle); ++level) {
            for (const int task : graph.level(cycle, level))
                (graph.level(cycle, level).size() == 1 ? alone : beside).insert(graph.task(task).stage_name());
        }
    }
    for (const std::string& name : beside) alone.erase(name);
    return alone;
}

std::vector<double> step_times(const engine::TaskGraph& graph, const std::vector<double>& runs, std::span<const double> work, int most) {
    std::vector<double> times;
    for (int threads = 1; threads <= most; ++threads) {
        double time = 0.0;
        for (int cycle = 0; cycle < graph.cycles(); ++cycle)
            time += runs[static_cast<std::size_t>(cycle)] * makespan(graph, cycle, work, threads);
        times.push_back(time);
    }
    return times;
}

std::vector<StageWork> counted_stages(const engine::TaskGraph& graph, const std::vector<double>& runs, const std::vector<double>& work) {
    std::vector<StageWork> stages;
    for (int task = 0; task < graph.size(); ++task) {
        const std::string name = graph.task(task).stage_name();
        const double instructions = runs[static_cast<std::size_t>(graph.task(task).cycle)] * work[static_cast<std::size_t>(task)];
        const auto known = std::find_if(stages.begin(), stages.end(), [&](const StageWork& stage) { return stage.stage == name; });
        if (known != stages.end())
            known->instructions += instructions;
        else if (instructions > 0.0)
            stages.push_back({name, instructions});
    }
    return stages;
}

/// @param sequential [in, out] stages without parallel tasks, from the first graph of several segments
CountedStep count_step(const Scene& scene, int segments, std::set<std::string>& sequential) {
    SpanRecorder recorder(1, 1000000);
    Schedule schedule;
    schedule.assembly.kind = scene.run.assembly;
    schedule.segments = segments;
    Trial trial(scene, schedule, &recorder);
    trial.settle();
    const double begin = trial.simulation().time();
    trial.run(4);                                                                           // searches for the automatic step
    while (trial.simulation().time() - begin < EnergyLedger::dense_time) trial.run(steps);  // losses are sampled more often than later
    recorder.clear();
    trial.run(steps);
    if (recorder.lost(0) > 0) throw std::logic_error("the recording of the counted steps is too short");
    const engine::TaskGraph& graph = trial.simulation().integrator().runner().graph();
    if (sequential.empty() && segments > 1) sequential = sequential_stages(graph);
    const std::vector<double> runs = runs_per_step(graph, recorder.spans(0));
    std::vector<double> work = WorkCounter(trial.simulation(), runs).count();
    CountedStep step{step_times(graph, runs, work, segments), {}, counted_stages(graph, runs, work), trial.simulation().step()};
    for (int task = 0; task < graph.size(); ++task) {
        if (sequential.contains(graph.task(task).stage_name())) work[static_cast<std::size_t>(task)] = 0.0;
    }
    step.parallel = step_times(graph, runs, work, segments);
    return step;
}

WorkRow row_of(int links, int threads, const std::vector<int>& segments, const std::vector<CountedStep>& counted) {
    const double all = counted.front().all.front(), parallel = counted.front().parallel.front();
    WorkRow row{.threads = threads, .links = (links + threads - 1) / threads, .even = even_speed_up(links, threads)};
    for (std::size_t k = 0; k < segments.size(); ++k) {
        const auto busy = static_cast<std::size_t>(std::min(threads, segments[k])) - 1;
        const double claimed = parallel / counted[k].parallel[busy], step_claimed = all / counted[k].all[busy];
        if (segments[k] <= threads) {
            row.segments = segments[k];
            row.longest = counted[k].parallel[busy];
            row.fixed = claimed;
            row.step_fixed = step_claimed;
        }
        if (claimed > row.claimed) row.claimed = claimed, row.claimed_segments = segments[k];
        row.step_claimed = std::max(row.step_claimed, step_claimed);
    }
    return row;
}

}  // namespace

double even_speed_up(int links, int threads) noexcept {
    const int longest = (links + threads - 1) / threads;
    return static_cast<double>(links) / longest;
}

double makespan(const engine::TaskGraph& graph, int cycle, std::span<const double> work, int threads) {
    std::priority_queue<double, std::vector<double>, std::greater<>> idle_from;
    for (int thread = 0; thread < threads; ++thread) idle_from.push(0.0);
    std::vector<double> ready(static_cast<std::size_t>(graph.size()), 0.0);
    double end = 0.0;
    for (const int task : graph.topological(cycle)) {
        const double finished = std::max(idle_from.top(), ready[static_cast<std::size_t>(task)]) + work[static_cast<std::size_t>(task)];
        idle_from.pop();
        idle_from.push(finished);
        for (const int next : graph.successors(task))
            ready[static_cast<std::size_t>(next)] = std::max(ready[static_cast<std::size_t>(next)], finished);
        end = std::max(end, finished);
    }
    return end;
}

std::vector<int> shortening_segments(int links) {
    std::vector<int> numbers;
    for (int number = 1; number <= links; ++number) {
        const auto longest = [links](int segments) { return (links + segments - 1) / segments; };
        if (number == 1 || longest(number) < longest(number - 1)) numbers.push_back(number);
    }
    return numbers;
}

CountedWork count_work(const Scene& scene, const std::vector<int>& segments, const std::function<void(const std::string&)>& progress) {
    const int links = scene.parameters.chain.pins;
    std::vector<CountedStep> counted(segments.size());
    std::set<std::string> sequential;
    for (std::size_t k = segments.size(); k-- > 0;) {
        if (progress) progress(fmt::format("counting a step of {} segments", segments[k]));
        counted[k] = count_step(scene, segments[k], sequential);
    }
    CountedWork result{{}, counted.front().stages, counted.front().step};
    for (int threads = 1; threads <= links; ++threads) result.rows.push_back(row_of(links, threads, segments, counted));
    return result;
}

}  // namespace cvtflow::bench
