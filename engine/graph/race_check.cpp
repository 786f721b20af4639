#include "engine/graph/race_check.hpp"

#include <algorithm>
#include <cstddef>
#include <span>

namespace cvtflow::engine {

namespace {

/// reachable[i][j]: a path leads from the i-th to the j-th task of the topological order.
std::vector<std::vector<bool>> reachability(const TaskGraph& graph, std::span<const int> order) {
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

void compare(const TaskGraph& graph, int first, int second, std::vector<Conflict>& conflicts) {
    for (const Access& a : graph.task(first).accesses) {
        for (const Access& b : graph.task(second).accesses) {
            const int begin = std::max(a.begin, b.begin);
            const int end = std::min(a.end, b.end);
            if (a.field == b.field && (a.write || b.write) && begin < end) conflicts.push_back({first, second, a.field, begin, end});
        }
    }
}

}  // namespace

std::vector<Conflict> race_check(const TaskGraph& graph) {
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

std::string describe(const TaskGraph& graph, const Conflict& conflict) {
    return graph.task(conflict.first).name + " and " + graph.task(conflict.second).name + " clash on field " +
           std::to_string(conflict.field) + ", elements " + std::to_string(conflict.begin) + "…" + std::to_string(conflict.end - 1);
}

}  // namespace cvtflow::engine
