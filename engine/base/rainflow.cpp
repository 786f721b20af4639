#include "engine/base/rainflow.hpp"

#include <algorithm>
#include <cmath>

namespace cvtflow::engine {

std::vector<std::size_t> reversals(std::span<const double> history) {
    std::vector<std::size_t> turns;
    for (std::size_t i = 0; i < history.size(); ++i) {
        if (!turns.empty() && history[i] == history[turns.back()]) continue;
        const bool extends =
            turns.size() > 1 && (history[turns.back()] > history[turns[turns.size() - 2]]) == (history[i] > history[turns.back()]);
        if (extends)
            turns.back() = i;
        else
            turns.push_back(i);
    }
    return turns;
}

std::vector<RainflowCycle> rainflow(std::span<const double> history) {
    std::vector<RainflowCycle> cycles;
    std::vector<std::size_t> open;  // reversals that belong to no cycle yet
    const auto range = [&](std::size_t a, std::size_t b) { return std::abs(history[b] - history[a]); };
    const auto count = [&](std::size_t a, std::size_t b, double number) {
        cycles.push_back({range(a, b), 0.5 * (history[a] + history[b]), number, a, b});
    };
    for (const std::size_t turn : reversals(history)) {
        open.push_back(turn);
        while (open.size() >= 3) {
            const std::size_t last = open.back(), middle = open[open.size() - 2], before = open[open.size() - 3];
            if (range(middle, last) < range(before, middle)) break;
            const bool has_start = open.size() == 3;  // half a cycle, whose first point is the start of the history
            count(before, middle, has_start ? 0.5 : 1.0);
            open.erase(open.end() - 3, has_start ? open.end() - 2 : open.end() - 1);
        }
    }
    for (std::size_t i = 1; i < open.size(); ++i) count(open[i - 1], open[i], 0.5);
    return cycles;
}

std::vector<RainflowClass> rainflow_classes(std::span<const RainflowCycle> cycles, int classes) {
    double largest = 0.0;
    for (const RainflowCycle& cycle : cycles) largest = std::max(largest, cycle.range);
    std::vector<RainflowClass> all(static_cast<std::size_t>(classes));
    for (std::size_t k = 0; k < all.size(); ++k) {
        all[k].from = largest * static_cast<double>(k) / classes;
        all[k].to = largest * static_cast<double>(k + 1) / classes;
    }
    for (const RainflowCycle& cycle : cycles) {
        auto of = std::find_if(all.begin(), all.end(), [&](const RainflowClass& each) { return cycle.range <= each.to; });
        if (of == all.end()) --of;  // rounding of the last border
        of->count += cycle.count;
        of->mean += cycle.count * cycle.mean;
        of->largest = std::max(of->largest, cycle.range);
    }
    for (RainflowClass& each : all) each.mean = each.count > 0.0 ? each.mean / each.count : 0.0;
    return all;
}

}  // namespace cvtflow::engine
