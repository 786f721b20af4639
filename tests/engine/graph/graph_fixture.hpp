#pragma once
/// A small diamond of tasks that several tests share.
///
///            ┌─► left ──┐
///     source ┤          ├─► sink       source writes field 0 [0, 8); left and right read a half each and write field 1;
///            └─► right ─┘              sink reads field 1 and writes field 0

#include <utility>
#include <vector>

#include "engine/graph/task_graph.hpp"

namespace cvtflow::engine::test {

inline void record(void* context, int item) noexcept { static_cast<std::vector<int>*>(context)->push_back(item); }

inline const std::vector<std::pair<int, int>> diamond_edges{{0, 1}, {0, 2}, {1, 3}, {2, 3}};

/// The diamond, added in the order sink last, frozen. @param skip edge of diamond_edges to leave out, -1: none
inline TaskGraph diamond(int skip = -1) {
    TaskGraph graph;
    graph.add({"source", 0, record, 10, {{0, 0, 8, true}}});
    graph.add({"left", 0, record, 11, {{0, 0, 4, false}, {1, 0, 4, true}}});
    graph.add({"right", 0, record, 12, {{0, 4, 8, false}, {1, 4, 8, true}}});
    graph.add({"sink", 0, record, 13, {{1, 0, 8, false}, {0, 0, 8, true}}});
    for (int edge = 0; edge < static_cast<int>(diamond_edges.size()); ++edge) {
        const auto& [before, after] = diamond_edges[static_cast<std::size_t>(edge)];
        if (edge != skip) graph.order(before, after);
    }
    graph.freeze();
    return graph;
}

}  // namespace cvtflow::engine::test
