#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <queue>

#include "tasks/batch/batch.hpp"
#include "tasks/batch/case_engine.hpp"

namespace cvtflow::tasks {

namespace {

/// Cost of every strand.
std::vector<double> strand_costs(const Sweep& sweep) {
    Scene scene = sweep.scene;
    CaseCosts cost(sweep);
    std::vector<double> costs(static_cast<std::size_t>(sweep.cases() / sweep.strand()), 0.0);
    for (long number = 0; number < sweep.cases(); ++number) {
        sweep.apply_case(number, scene);
        costs[static_cast<std::size_t>(number / sweep.strand())] +=
            cost.of_run(scene) + (cost.settles(scene) ? cost.of_settling(scene) : 0.0);
    }
    return costs;
}

}  // namespace

std::string shard_folder(const std::string& folder, const Shard& shard) {
    return shard.of == 1 ? folder : (std::filesystem::path(folder) / fmt::format("shard-{:04}-of-{:04}", shard.number, shard.of)).string();
}

std::vector<long> shard_cases(const Sweep& sweep, const Shard& shard) {
    std::vector<long> cases;
    if (shard.of == 1) {
        cases.resize(static_cast<std::size_t>(sweep.cases()));
        std::iota(cases.begin(), cases.end(), 0L);
        return cases;
    }
    const std::vector<double> costs = strand_costs(sweep);
    std::vector<std::size_t> order(costs.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return costs[a] > costs[b]; });
    using Load = std::pair<double, int>;  // of equal loads the shard with the smaller number
    std::priority_queue<Load, std::vector<Load>, std::greater<>> loads;
    for (int i = 1; i <= shard.of; ++i) loads.emplace(0.0, i);
    for (const std::size_t strand : order) {
        const auto [load, number] = loads.top();
        loads.pop();
        loads.emplace(load + costs[strand], number);
        if (number != shard.number) continue;
        for (long k = 0; k < sweep.strand(); ++k) cases.push_back(static_cast<long>(strand) * sweep.strand() + k);
    }
    std::sort(cases.begin(), cases.end());
    return cases;
}

}  // namespace cvtflow::tasks
