#pragma once
/// The step as a graph, and the graph as data. Executors run it, race_check() proves it free of races, to_dot() draws it.
///
/// Tasks belong to cycles (sub-graphs); one cycle is run from end to end before a controller names the next. Edges never leave a cycle.

#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace cvtflow::engine {

/// An access of a task: elements [begin, end) of a field. The builder of the graph defines the field numbers.
struct Access {
    int field;
    int begin;
    int end;
    bool write;
};

using TaskBody = void (*)(void* context, int item) noexcept;

/// The body of a task: a function of the executor's context, or a member function of an object.
struct TaskCode {
    TaskCode() = default;
    /// A function, or a lambda without captures, of the run's context.
    template <class Function>
    requires std::is_convertible_v<Function, TaskBody> TaskCode(Function function) : body(function) {}
    TaskCode(TaskBody function, void* context) : body(function), owner(context) {}

    TaskBody body = nullptr;
    void* owner = nullptr;  ///< nullptr: the run's context
};

/// Calls owner.member(item), or owner.member(), instead of a function of the context. `owner` must outlive the graph.
template <auto member, class Owner>
[[nodiscard]] TaskCode code_of(Owner& owner) noexcept {
    return {[](void* context, [[maybe_unused]] int item) noexcept {
                Owner& self = *static_cast<Owner*>(context);
                if constexpr (std::is_invocable_v<decltype(member), Owner&, int>)
                    (self.*member)(item);
                else
                    (self.*member)();
            },
            &owner};
}

struct Task {
    std::string name;
    int cycle = 0;
    TaskCode code{};
    int item = 0;  ///< handed to the body, e.g. the segment number
    std::vector<Access> accesses;
    std::string stage{};  ///< heading in profiles; empty: the name without a number

    /// "force[3]" → "force".
    [[nodiscard]] std::string stem() const { return name.substr(0, name.find('[')); }
    [[nodiscard]] std::string stage_name() const { return stage.empty() ? stem() : stage; }
};

/// The part of a task that executors read in their inner loop.
struct TaskCall {
    TaskBody body;
    void* owner;  ///< nullptr: the run's context
    int item;

    void operator()(void* context) const noexcept { body(owner != nullptr ? owner : context, item); }
};

/// Built by add() and order(), then frozen; the accessors below freeze() are for frozen graphs only.
class TaskGraph {
public:
    /// Number of the new task: 0, 1, 2 … in order of addition.
    /// @throws std::invalid_argument for a task without body or with a negative cycle or an empty or reversed access
    int add(Task task);

    /// `before` finishes before `after` begins. Said twice counts once.
    /// @throws std::invalid_argument for unknown tasks, tasks of different cycles, and a task before itself
    void order(int before, int after);

    /// Derives levels, successors and counts; add() and order() throw std::logic_error afterwards.
    /// @throws std::invalid_argument if tasks wait for each other in a ring, naming one of them
    void freeze();

    [[nodiscard]] bool frozen() const noexcept { return frozen_; }
    [[nodiscard]] int size() const noexcept { return static_cast<int>(tasks_.size()); }
    [[nodiscard]] const Task& task(int task) const noexcept { return tasks_[static_cast<std::size_t>(task)]; }
    /// Number of cycles: the highest cycle number of any task + 1.
    [[nodiscard]] int cycles() const noexcept { return static_cast<int>(cycle_begin_.size()) - 1; }

    /// Tasks of a cycle in an order that respects all edges: level by level, within a level by task number.
    [[nodiscard]] std::span<const int> topological(int cycle) const noexcept;
    /// Number of levels of a cycle; level l holds tasks whose longest chain of predecessors has l tasks, so they can run side by side.
    [[nodiscard]] int levels(int cycle) const noexcept;
    /// Tasks of one level, ascending.
    [[nodiscard]] std::span<const int> level(int cycle, int level) const noexcept;
    /// Tasks that wait for this one, ascending.
    [[nodiscard]] std::span<const int> successors(int task) const noexcept;
    [[nodiscard]] int predecessor_count(int task) const noexcept { return predecessor_count_[static_cast<std::size_t>(task)]; }
    [[nodiscard]] TaskCall call(int task) const noexcept { return calls_[static_cast<std::size_t>(task)]; }

private:
    void require_open() const;
    void index_edges();
    [[nodiscard]] std::vector<int> level_of_tasks() const;
    void index_levels(const std::vector<int>& level_of);

    std::vector<Task> tasks_;
    std::vector<std::pair<int, int>> edges_;  ///< before, after
    bool frozen_ = false;

    std::vector<TaskCall> calls_;         ///< [task]
    std::vector<int> successors_;         ///< flat
    std::vector<int> successor_begin_;    ///< [task] → successors_, one more than tasks
    std::vector<int> predecessor_count_;  ///< [task]
    std::vector<int> topological_;        ///< tasks by cycle, level, number
    std::vector<int> cycle_begin_{0};     ///< [cycle] → topological_, one more than cycles
    std::vector<int> level_begin_{0};     ///< all levels of all cycles → topological_, one more than levels
    std::vector<int> first_level_{0};     ///< [cycle] → level_begin_, one more than cycles
};

}  // namespace cvtflow::engine
