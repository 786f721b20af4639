#pragma once
/// Graphs in tests. Race freedom as a theorem about the graph: tasks that may run side by side must not touch the same data, one of them
/// writing. It holds for what the tasks declare; tests of the tasks show that the declarations are true.
///
/// A small diamond of tasks that several tests share.
///
///            ┌─► left ──┐
///     source ┤          ├─► sink       source writes field 0 [0, 8); left and right read a half each and write field 1;
///            └─► right ─┘              sink reads field 1 and writes field 0

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/graph/task_graph.hpp"

namespace cvtflow::engine {

/// Two tasks of one cycle without a path in either direction whose accesses to [begin, end) of a field clash.
struct Conflict {
    int first;  ///< task number, < second
    int second;
    int field;
    int begin;
    int end;
    bool operator==(const Conflict&) const = default;
};

/// reachable[i][j]: a path leads from the i-th to the j-th task of the topological order.
inline std::vector<std::vector<bool>> reachability(const TaskGraph& graph, std::span<const int> order) {
    std::vector<std::size_t> place(static_cast<std::size_t>(graph.size()), 0);
    for (std::size_t i = 0; i < order.size(); ++i) place[static_cast<std::size_t>(order[i])] = i;
    std::vector<std::vector<bool>> reachable(order.size(), std::vector<bool>(order.size(), false));
    for (std::size_t i = order.size(); i-- > 0;) {
        for (const int after : graph.successors(order[i])) {
            const std::size_t next = place[static_cast<std::size_t>(after)];
            reachable[i][next] = true;
            for (std::size_t j = next + 1; j < order.size(); ++j) reachable[i][j] = reachable[i][j] || reachable[next][j];
        }
    }
    return reachable;
}

inline void compare(const TaskGraph& graph, int first, int second, std::vector<Conflict>& conflicts) {
    for (const Access& a : graph.task(first).accesses) {
        for (const Access& b : graph.task(second).accesses) {
            const int begin = std::max(a.begin, b.begin);
            const int end = std::min(a.end, b.end);
            if (a.field == b.field && (a.write || b.write) && begin < end) conflicts.push_back({first, second, a.field, begin, end});
        }
    }
}

/// All conflicts, ascending by tasks, one per clashing pair of accesses; empty for a race-free graph. The graph is frozen.
[[nodiscard]] inline std::vector<Conflict> race_check(const TaskGraph& graph) {
    std::vector<Conflict> conflicts;
    for (int cycle = 0; cycle < graph.cycles(); ++cycle) {
        const std::span<const int> order = graph.topological(cycle);
        const auto reachable = reachability(graph, order);
        for (std::size_t i = 0; i < order.size(); ++i) {
            for (std::size_t j = i + 1; j < order.size(); ++j) {
                if (!reachable[i][j]) compare(graph, std::min(order[i], order[j]), std::max(order[i], order[j]), conflicts);
            }
        }
    }
    const auto before = [](const Conflict& a, const Conflict& b) { return a.first != b.first ? a.first < b.first : a.second < b.second; };
    std::stable_sort(conflicts.begin(), conflicts.end(), before);
    return conflicts;
}

/// "force 3 and force 4 clash on field 7, elements 12…24"
[[nodiscard]] inline std::string describe(const TaskGraph& graph, const Conflict& conflict) {
    return graph.task(conflict.first).name + " and " + graph.task(conflict.second).name + " clash on field " +
           std::to_string(conflict.field) + ", elements " + std::to_string(conflict.begin) + "…" + std::to_string(conflict.end - 1);
}

}  // namespace cvtflow::engine

namespace cvtflow::engine::test {

inline void record(void* context, int item) noexcept { static_cast<std::vector<int>*>(context)->push_back(item); }

inline const std::vector<std::pair<int, int>> diamond_edges{{0, 1}, {0, 2}, {1, 3}, {2, 3}};

/// The diamond, added in the order sink last, every edge stated twice, frozen. @param skip edge of diamond_edges to leave out, -1: none
inline TaskGraph diamond(int skip = -1) {
    TaskGraph graph;
    graph.add({"source", 0, record, 10, {{0, 0, 8, true}}});
    graph.add({"left", 0, record, 11, {{0, 0, 4, false}, {1, 0, 4, true}}});
    graph.add({"right", 0, record, 12, {{0, 4, 8, false}, {1, 4, 8, true}}});
    graph.add({"sink", 0, record, 13, {{1, 0, 8, false}, {0, 0, 8, true}}});
    for (int edge = 0; edge < static_cast<int>(diamond_edges.size()); ++edge) {
        const auto& [before, after] = diamond_edges[static_cast<std::size_t>(edge)];
        for (int twice = 0; twice < 2 && edge != skip; ++twice) graph.order(before, after);
    }
    graph.freeze();
    return graph;
}

/// A graph without the order of a pair of its tasks.
inline TaskGraph without_edge(const TaskGraph& whole, int before, int after) {
    TaskGraph graph;
    for (int task = 0; task < whole.size(); ++task) graph.add(whole.task(task));
    for (int task = 0; task < whole.size(); ++task) {
        for (const int successor : whole.successors(task)) {
            if (task != before || successor != after) graph.order(task, successor);
        }
    }
    graph.freeze();
    return graph;
}

}  // namespace cvtflow::engine::test
