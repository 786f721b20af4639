/// The executors on oneTBB: two on flow graphs, one on parallel loops, and the pins of threads in its arenas.

#include <oneapi/tbb/flow_graph.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/partitioner.h>
#include <oneapi/tbb/task_group.h>
#include <oneapi/tbb/task_scheduler_observer.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <deque>
#include <memory>
#include <optional>

#include "bench/executor/compared_executors.hpp"
#include "engine/executor/tbb/tbb_section.hpp"
#include "engine/thread/pinning.hpp"

#ifdef __cpp_lib_parallel_algorithm  // of libstdc++, which runs it on oneTBB
#include <execution>
#endif

namespace cvtflow::bench {

using namespace engine;
namespace flow = oneapi::tbb::flow;

namespace {

/// Pins threads while they are in an arena: thread in slot i to the i-th processor.
class ArenaPins final : public oneapi::tbb::task_scheduler_observer {
public:
    ArenaPins(oneapi::tbb::task_arena& arena, int slots);
    /// Restores the masks of all threads, also of those that have not left yet and would now leave unobserved.
    ~ArenaPins() override;
    ArenaPins(const ArenaPins&) = delete;
    ArenaPins& operator=(const ArenaPins&) = delete;

    void on_scheduler_entry(bool worker) override;
    void on_scheduler_exit(bool worker) override;

private:
    struct Guest;  // a thread in a slot
    Processors processors_;
    int slots_;
    std::unique_ptr<Guest[]> guests_;
};

/// A separate arena; with `pin`, threads are pinned by their slot.
class PinnedSection : public TbbSection {
public:
    explicit PinnedSection(const ExecutorOptions& options) : TbbSection(options.threads) {
        if (options.pin) pins_.emplace(*own_arena(), options.threads);
    }

private:
    std::optional<ArenaPins> pins_;
};

/// The calling thread's track: its slot in the arena, 0 … threads - 1.
[[nodiscard]] inline int slot() noexcept { return oneapi::tbb::this_task_arena::current_thread_index(); }

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
    const int slot = ::cvtflow::bench::slot();
    if (slot < 0 || slot >= slots_ || !processors_.known()) return;
    Guest& guest = guests_[static_cast<std::size_t>(slot)];
    const cpu_set_t only = processors_.only(slot);
    if (sched_getaffinity(0, sizeof guest.before, &guest.before) != 0) return;
    if (sched_setaffinity(0, sizeof only, &only) == 0) guest.thread.store(gettid());
}

void ArenaPins::on_scheduler_exit(bool /*worker*/) {
    const int slot = ::cvtflow::bench::slot();
    if (slot < 0 || slot >= slots_) return;
    Guest& guest = guests_[static_cast<std::size_t>(slot)];
    if (guest.thread.exchange(0) == gettid()) sched_setaffinity(0, sizeof guest.before, &guest.before);
}

/// A task graph as a oneTBB flow graph: one continue_node per task, its edges, and per cycle a node that starts it.
class TaskNodes {
public:
    using Message = flow::continue_msg;
    using Node = flow::continue_node<Message>;

    /// Built inside the arena in which it will run; graph and run outlive it.
    TaskNodes(flow::graph& graph, const Run& run);

    /// Tasks of the cycle run, in the order of their edges.
    void start(int cycle) { starts_[static_cast<std::size_t>(cycle)].try_put(Message()); }

    /// `end` receives a message from each task of the cycle without successors.
    void order_before(int cycle, flow::receiver<Message>& end);

private:
    const TaskGraph& tasks_;
    std::deque<Node> nodes_;                            ///< [task]
    std::deque<flow::broadcast_node<Message>> starts_;  ///< [cycle]
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

/// A flow graph that persists through the whole run and goes from cycle to cycle by messages: the textbook form. Its messages are small
/// tasks from oneTBB's pool, which grows during the first cycles.
void run_by_messages(Run& run, const ExecutorOptions& options, int first) {
    using Close = flow::continue_node<TaskNodes::Message, flow::lightweight>;
    PinnedSection section(options);
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

/// A flow graph that is started and waited for in every cycle: the form that OpenModelica's --parmodauto uses for right-hand sides.
void run_per_cycle(Run& run, const ExecutorOptions& options, int first) {
    PinnedSection section(options);
    section.execute([&](oneapi::tbb::task_group_context& context) {
        flow::graph graph(context);
        TaskNodes nodes(graph, run);
        for (int cycle = first; cycle != Controller::stop; cycle = run.decide(0)) {
            nodes.start(cycle);
            graph.wait_for_all();
        }
    });
}

void run_level(const Run& run, std::span<const int> tasks, oneapi::tbb::task_group_context& context) {
    if (tasks.size() == 1) {
        run.tasks(tasks, slot());
        return;
    }
    oneapi::tbb::parallel_for(
        std::size_t{0}, tasks.size(), [&](std::size_t i) noexcept { run.task(tasks[i], slot()); }, oneapi::tbb::static_partitioner(),
        context);
}

/// Forked and joined at every level: one parallel_for with static partitioner, in a separate arena.
void run_loops(Run& run, const ExecutorOptions& options, int first) {
    PinnedSection section(options);
    section.execute([&](oneapi::tbb::task_group_context& context) {
        for (int cycle = first; cycle != Controller::stop; cycle = run.decide(0)) {
            for (int level = 0; level < run.graph().levels(cycle); ++level) run_level(run, run.graph().level(cycle, level), context);
        }
    });
}

#ifdef __cpp_lib_parallel_algorithm
void run_level_by_algorithm(const Run& run, std::span<const int> tasks) {
    if (tasks.size() == 1) {
        run.tasks(tasks, slot());
        return;
    }
    std::for_each(std::execution::par, tasks.begin(), tasks.end(), [&](int task) noexcept { run.task(task, slot()); });
}

/// The standard library's parallel algorithms: the simplest parallel code in C++. The algorithm's context is bound to that of the task
/// around it: here the section's, else the host's, which may be cancelled.
void run_algorithms(Run& run, const ExecutorOptions& options, int first) {
    PinnedSection section(options);
    section.execute([&](oneapi::tbb::task_group_context& context) {
        oneapi::tbb::task_group(context).run_and_wait([&]() noexcept {
            for (int cycle = first; cycle != Controller::stop; cycle = run.decide(slot())) {
                for (int level = 0; level < run.graph().levels(cycle); ++level)
                    run_level_by_algorithm(run, run.graph().level(cycle, level));
            }
        });
    });
}

constexpr Way std_par{"std_par", run_algorithms};

constexpr auto make_std_par = make<std_par>;
#else
constexpr std::nullptr_t make_std_par = nullptr;
#endif

constexpr Way flow_messages{"flow_messages", run_by_messages}, flow_per_cycle{"flow_per_cycle", run_per_cycle},
    tbb_loop{"tbb_loop", run_loops};

}  // namespace

Runtime tbb_runtime() {
    const auto row = [](std::string_view name, std::string_view description, auto make_it, std::string_view needs = {}) {
        return ExecutorRow{name, description, true, Waiting::fixed, needs, make_it};
    };
    return {"",
            {row("flow_messages", "oneTBB flow graph for the whole run, messages from cycle to cycle", make<flow_messages>),
             row("flow_per_cycle", "oneTBB flow graph, started and waited for in every cycle", make<flow_per_cycle>),
             row("tbb_loop", "oneTBB parallel_for at every level", make<tbb_loop>),
             row("std_par", "std::for_each(std::execution::par) at every level", make_std_par,
                 "a standard library whose parallel algorithms run on oneTBB")}};
}

}  // namespace cvtflow::bench
