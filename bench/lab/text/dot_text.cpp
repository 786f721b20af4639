#include "bench/lab/text/dot_text.hpp"

#include <sstream>

namespace cvtflow::bench {

namespace {

std::string quoted(const std::string& text) {
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') result += '\\';
        result += c;
    }
    return result + '"';
}

}  // namespace

std::string to_dot(const engine::TaskGraph& graph, int cycle) {
    std::ostringstream text;
    text << "digraph cycle_" << cycle << " {\n    rankdir=LR;\n    node [shape=box];\n";
    for (int level = 0; level < graph.levels(cycle); ++level) {
        text << "    { rank=same;";
        for (const int task : graph.level(cycle, level)) text << " t" << task << " [label=" << quoted(graph.task(task).name) << "];";
        text << " }\n";
    }
    for (const int task : graph.topological(cycle)) {
        for (const int after : graph.successors(task)) text << "    t" << task << " -> t" << after << ";\n";
    }
    text << "}\n";
    return text.str();
}

}  // namespace cvtflow::bench
