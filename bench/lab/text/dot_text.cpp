#include "bench/lab/text/dot_text.hpp"

#include <fmt/format.h>

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
    std::string text = fmt::format("digraph cycle_{} {{\n    rankdir=LR;\n    node [shape=box];\n", cycle);
    for (int level = 0; level < graph.levels(cycle); ++level) {
        text += "    { rank=same;";
        for (const int task : graph.level(cycle, level)) text += fmt::format(" t{} [label={}];", task, quoted(graph.task(task).name));
        text += " }\n";
    }
    for (const int task : graph.topological(cycle)) {
        for (const int after : graph.successors(task)) text += fmt::format("    t{} -> t{};\n", task, after);
    }
    return text + "}\n";
}

}  // namespace cvtflow::bench
