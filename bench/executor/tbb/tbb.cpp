/// The executors on oneTBB: two on flow graphs, one on parallel loops, and the pins of threads in its arenas.

#include <oneapi/tbb/flow_graph.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/partitioner.h>
#include <unistd.h>

#include <atomic>
#include <deque>

#include "bench/executor/compared_executors.hpp"
#include "bench/executor/tbb/pinned_section.hpp"
#include "engine/executor/run.hpp"

namespace cvtflow::bench {

using namespace engine;
namespace flow = oneapi::tbb::flow;

struct ArenaPins::Guest {
    std::atomic<pid_t> thread{0};  // 0: none
    cpu_set_t before;
};

ArenaPins::ArenaPins(oneapi::tbb::task_arena& arena, int slots)
    : task_scheduler_observer(arena), slots_(slots), guests_(std::make_unique<Guest[]>(static_cast<std::size_t>(slots))) {
    observe(true);
}

ArenaPins::~ArenaPins() {
    observe(false);  // returns when no callback is under way
    for (int slot = 0; slot < slots_; ++slot) {
        const Guest& guest = guests_[static_cast<std::size_t>(slot)];
        if (const pid_t thread = guest.thread.load(); thread != 0) sched_setaffinity(thread, sizeof guest.before, &guest.before);
    }
}

void ArenaPins::on_scheduler_entry(bool /*worker*/) {
    const int slot = bench::slot();
    if (slot < 0 || slot >= slots_ || !processors_.known()) return;
    Guest& guest = guests_[static_cast<std::size_t>(slot)];
    const cpu_set_t only = processors_.only(slot);
    if (sched_getaffinity(0, sizeof guest.before, &guest.before) != 0) return;
    if (sched_setaffinity(0, sizeof only, &only) == 0) guest.thread.store(gettid());
}

void ArenaPins::on_scheduler_exit(bool /*worker*/) {
    const int slot = bench::slot();
    if (slot < 0 || slot >= slots_) return;
    Guest& guest = guests_[static_cast<std::size_t>(slot)];
    if (guest.thread.exchange(0) == gettid()) sched_setaffinity(0, sizeof guest.before, &guest.before);
}

/// A task graph as a oneTBB flow graph: one continue_node per task, its edges, and per cycle a node that starts it.
class TaskNodes {
public:
    using Message = oneapi::tbb::flow::continue_msg;
    using Node = oneapi::tbb::flow::continue_node<Message>;

    /// Built inside the arena in which it will run; graph and run outlive it.
    TaskNodes(oneapi::tbb::flow::graph& graph, const engine::Run& run);

    /// Tasks of the cycle run, in the order of their edges.
    void start(int cycle) { starts_[static_cast<std::size_t>(cycle)].try_put(Message()); }

    /// `end` receives a message from each task of the cycle without successors.
    void order_before(int cycle, oneapi::tbb::flow::receiver<Message>& end);

private:
    const engine::TaskGraph& tasks_;
    std::deque<Node> nodes_;                                         ///< [task]
    std::deque<oneapi::tbb::flow::broadcast_node<Message>> starts_;  ///< [cycle]
};

TaskNodes::TaskNodes(flow::graph& graph, const Run& run) : tasks_(run.graph()) {
    for (int task = 0; task < tasks_.size(); ++task) {
        nodes_.emplace_back(graph, [&run, task](const Message&) noexcept { run.task(task, slot()); });
    }
    for (int task = 0; task < tasks_.size(); ++task) {
        for (const int after : tasks_.successors(task)) {
            flow::make_edge(nodes_[static_cast<std::size_t>(task)], nodes_[static_cast<std::size_t>(after)]);
        }
    }
    for (int cycle = 0; cycle < tasks_.cycles(); ++cycle) {
        auto& start = starts_.emplace_back(graph);
        for (const int task : tasks_.topological(cycle)) {
            if (tasks_.predecessor_count(task) == 0) flow::make_edge(start, nodes_[static_cast<std::size_t>(task)]);
        }
    }
}

void TaskNodes::order_before(int cycle, flow::receiver<Message>& end) {
    for (const int task : tasks_.topological(cycle)) {
        if (tasks_.successors(task).empty()) flow::make_edge(nodes_[static_cast<std::size_t>(task)], end);
    }
}

// All cycles live in one graph. The last tasks of a cycle send to its `close`, which counts them, asks the controller and sends to the
// `start` of the next cycle.
//
//              ┌─► task ─┐
//     start[c] ┤         ├─► close[c] ── decides c' ┄┄► start[c']
//              └─► task ─┘
//
// The dotted arrow is a message without an edge: an edge into a continue_node would count as one more predecessor and the ring would
// never begin; broadcast nodes do not count. `close` is lightweight, that is, it runs inside the last task instead of being a separate
// task that another thread may have to steal (about 1 µs). Cycles follow one another, so that one decision is made at a time, and
// the reference counts of oneTBB order what the tasks wrote before it.

void FlowMessages::execute(Run& run, int first) {
    using Close = flow::continue_node<TaskNodes::Message, flow::lightweight>;
    PinnedSection section(options());
    section.execute([&](oneapi::tbb::task_group_context& context) {
        flow::graph graph(context);
        TaskNodes nodes(graph, run);
        std::deque<Close> closes;
        for (int cycle = 0; cycle < run.graph().cycles(); ++cycle) {
            auto& close = closes.emplace_back(graph, [&](const TaskNodes::Message&) noexcept {
                if (const int next = run.decide(slot()); next != Controller::stop) nodes.start(next);
            });
            nodes.order_before(cycle, close);
        }
        nodes.start(first);
        graph.wait_for_all();
    });
}

void FlowPerCycle::execute(Run& run, int first) {
    PinnedSection section(options());
    section.execute([&](oneapi::tbb::task_group_context& context) {
        oneapi::tbb::flow::graph graph(context);
        TaskNodes nodes(graph, run);
        for (int cycle = first; cycle != Controller::stop; cycle = run.decide(0)) {
            nodes.start(cycle);
            graph.wait_for_all();
        }
    });
}

namespace {

void run_level(const Run& run, std::span<const int> tasks, oneapi::tbb::task_group_context& context) {
    if (tasks.size() == 1) {
        run.tasks(tasks, slot());
        return;
    }
    oneapi::tbb::parallel_for(
        std::size_t{0}, tasks.size(), [&](std::size_t i) noexcept { run.task(tasks[i], slot()); }, oneapi::tbb::static_partitioner(),
        context);
}

}  // namespace

void TbbLoop::execute(Run& run, int first) {
    PinnedSection section(options());
    section.execute([&](oneapi::tbb::task_group_context& context) {
        for (int cycle = first; cycle != Controller::stop; cycle = run.decide(0)) {
            for (int level = 0; level < run.graph().levels(cycle); ++level) run_level(run, run.graph().level(cycle, level), context);
        }
    });
}

}  // namespace cvtflow::bench
