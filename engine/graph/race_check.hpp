#pragma once
/// Race freedom as a theorem about the graph: tasks that may run side by side must not touch the same data, one of them writing.
/// It holds for what the tasks declare; tests of the tasks show that the declarations are true.

#include <string>
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

/// All conflicts, ascending by tasks, one per clashing pair of accesses; empty for a race-free graph. The graph is frozen.
[[nodiscard]] std::vector<Conflict> race_check(const TaskGraph& graph);

/// "force 3 and force 4 clash on field 7, elements 12…24"
[[nodiscard]] std::string describe(const TaskGraph& graph, const Conflict& conflict);

}  // namespace cvtflow::engine
