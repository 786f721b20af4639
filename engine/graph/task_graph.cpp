#include "engine/graph/task_graph.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <stdexcept>
#include <tuple>
#include <utility>

namespace cvtflow::engine {

namespace {

std::span<const int> slice(const std::vector<int>& flat, int begin, int end) noexcept {
    return std::span<const int>(flat).subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(end - begin));
}

int at(const std::vector<int>& values, int index) noexcept { return values[static_cast<std::size_t>(index)]; }

}  // namespace

void TaskGraph::require_open() const {
    if (frozen_) throw std::logic_error("task graph: frozen graphs cannot change");
}

int TaskGraph::add(Task task) {
    require_open();
    if (task.code.body == nullptr) throw std::invalid_argument("task graph: task " + task.name + " has no body");
    if (task.cycle < 0) throw std::invalid_argument("task graph: task " + task.name + " belongs to a negative cycle");
    for (const Access& access : task.accesses) {
        if (access.begin >= access.end) throw std::invalid_argument("task graph: task " + task.name + " has an empty access");
    }
    tasks_.push_back(std::move(task));
    return size() - 1;
}

void TaskGraph::order(int before, int after) {
    require_open();
    if (std::min(before, after) < 0 || std::max(before, after) >= size())
        throw std::invalid_argument("task graph: edge between unknown tasks");
    if (before == after) throw std::invalid_argument("task graph: task " + task(before).name + " would depend on itself");
    if (task(before).cycle != task(after).cycle) {
        throw std::invalid_argument("task graph: edge from " + task(before).name + " to " + task(after).name + " leaves its cycle");
    }
    edges_.emplace_back(before, after);
}

void TaskGraph::freeze() {
    require_open();
    index_edges();
    index_levels(level_of_tasks());
    calls_.clear();
    for (const Task& task : tasks_) calls_.push_back({task.code.body, task.code.owner, task.item});
    frozen_ = true;
}

void TaskGraph::index_edges() {
    std::sort(edges_.begin(), edges_.end());
    edges_.erase(std::unique(edges_.begin(), edges_.end()), edges_.end());
    predecessor_count_.assign(tasks_.size(), 0);
    successor_begin_.assign(tasks_.size() + 1, 0);
    successors_.clear();
    for (const auto& [before, after] : edges_) {
        ++predecessor_count_[static_cast<std::size_t>(after)];
        ++successor_begin_[static_cast<std::size_t>(before) + 1];
        successors_.push_back(after);
    }
    std::partial_sum(successor_begin_.begin(), successor_begin_.end(), successor_begin_.begin());
}

/// Kahn's algorithm: a task is reached when its last predecessor was; what is never reached waits in a ring.
std::vector<int> TaskGraph::level_of_tasks() const {
    std::vector<int> level_of(tasks_.size(), 0);
    std::vector<int> waiting = predecessor_count_;
    std::vector<int> ready;
    for (int task = 0; task < size(); ++task) {
        if (at(waiting, task) == 0) ready.push_back(task);
    }
    for (std::size_t next = 0; next < ready.size(); ++next) {
        const int task = ready[next];
        for (const int after : successors(task)) {
            int& level = level_of[static_cast<std::size_t>(after)];
            level = std::max(level, at(level_of, task) + 1);
            if (--waiting[static_cast<std::size_t>(after)] == 0) ready.push_back(after);
        }
    }
    if (ready.size() == tasks_.size()) return level_of;
    const auto stuck = std::find_if(waiting.begin(), waiting.end(), [](int count) { return count > 0; });
    throw std::invalid_argument("task graph: task " + tasks_[static_cast<std::size_t>(stuck - waiting.begin())].name +
                                " is in, or depends on, a cycle of dependent tasks");
}

void TaskGraph::index_levels(const std::vector<int>& level_of) {
    topological_.resize(tasks_.size());
    std::iota(topological_.begin(), topological_.end(), 0);
    const auto place = [&](int number) { return std::tuple(task(number).cycle, at(level_of, number), number); };
    std::sort(topological_.begin(), topological_.end(), [&](int a, int b) { return place(a) < place(b); });

    const int cycle_count = tasks_.empty() ? 0 : task(topological_.back()).cycle + 1;
    cycle_begin_.assign(1, 0);
    level_begin_.assign(1, 0);
    first_level_.assign(1, 0);
    std::size_t i = 0;
    for (int cycle = 0; cycle < cycle_count; ++cycle) {
        for (int level = 0; i < topological_.size() && task(topological_[i]).cycle == cycle; ++level) {
            while (i < topological_.size() && task(topological_[i]).cycle == cycle && at(level_of, topological_[i]) == level) ++i;
            level_begin_.push_back(static_cast<int>(i));
        }
        cycle_begin_.push_back(static_cast<int>(i));
        first_level_.push_back(static_cast<int>(level_begin_.size()) - 1);
    }
}

std::span<const int> TaskGraph::topological(int cycle) const noexcept {
    return slice(topological_, at(cycle_begin_, cycle), at(cycle_begin_, cycle + 1));
}

int TaskGraph::levels(int cycle) const noexcept { return at(first_level_, cycle + 1) - at(first_level_, cycle); }

std::span<const int> TaskGraph::level(int cycle, int level) const noexcept {
    const int number = at(first_level_, cycle) + level;
    return slice(topological_, at(level_begin_, number), at(level_begin_, number + 1));
}

std::span<const int> TaskGraph::successors(int task) const noexcept {
    return slice(successors_, at(successor_begin_, task), at(successor_begin_, task + 1));
}

}  // namespace cvtflow::engine
