#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <numeric>
#include <queue>

#include "tasks/batch/batch.hpp"
#include "tasks/batch/case_engine.hpp"
#include "tasks/schedule.hpp"
#include "tasks/stability/largest_step.hpp"

namespace cvtflow::tasks {

namespace {

/// Cost of every strand.
std::vector<double> strand_costs(const Sweep& sweep) {
    Scene scene = sweep.scene;
    std::vector<double> costs(static_cast<std::size_t>(sweep.cases() / sweep.strand()), 0.0);
    for (long number = 0; number < sweep.cases(); ++number) {
        sweep.apply_case(number, scene);
        costs[static_cast<std::size_t>(number / sweep.strand())] += case_cost(sweep, scene);
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
    using Load = std::pair<double, int>;   // of equal loads the shard with the smaller number
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

namespace {

/// Wall time per unit of cost, from so many seconds of steps of one case. Zero if the case cannot begin.
double measure(const Scene& scene, double seconds) {
    try {
        Simulation simulation(scene, Schedule{});
        SilentObserver silent;
        const engine::Cancellation go_on;
        using Clock = std::chrono::steady_clock;
        double wall = 0.0;
        long steps = 0;
        if (const Fault fault = simulation.run_steps(100, silent, go_on); fault.kind != FaultKind::max_steps) return 0.0;   // many tips first touch here
        for (long batch = 20; wall < seconds; batch *= 2) {
            const auto begin = Clock::now();
            const Fault fault = simulation.run_steps(batch, silent, go_on);
            if (fault.kind != FaultKind::max_steps) return 0.0;
            wall += std::chrono::duration<double>(Clock::now() - begin).count();
            steps += batch;
        }
        return wall / static_cast<double>(steps) / step_cost(scene);
    } catch (const std::exception&) {
        return 0.0;
    }
}

/// Notes how far a case is stable, if it begins with a state that has settled.
void judge_step(const Scene& scene, BatchEstimate& result) {
    try {
        const Simulation simulation(scene, Schedule{});
        if (simulation.needs_settling()) return;
        const double stable = predicted_step_limit(simulation.variator(), scene.parameters, scene.run.method, frozen_start(simulation)).step;
        result.stable_step = result.stable_step > 0.0 ? std::min(result.stable_step, stable) : stable;
        result.beyond = std::max(result.beyond, scene.run.step / stable);
    } catch (const std::exception&) {
        return;   // measuring says that the case cannot begin
    }
}

}  // namespace

BatchEstimate estimate(const Sweep& sweep, const Shard& shard, double seconds) {
    BatchEstimate result;
    const std::vector<long> cases = shard_cases(sweep, shard);
    Scene scene = sweep.scene;
    double cost = 0.0;
    for (const long number : cases) {
        sweep.apply_case(number, scene);
        if (violations(scene).empty()) cost += case_cost(sweep, scene);
        else ++result.bad;
    }
    result.cases = static_cast<long>(cases.size());
    std::vector<double> rates;
    for (const std::size_t at : {cases.size() / 2, std::size_t{0}, cases.size() - 1}) {
        if (cases.empty()) break;
        sweep.apply_case(cases[at], scene);
        if (!violations(scene).empty()) continue;
        if (const double rate = measure(scene, seconds / 3.0); rate > 0.0) rates.push_back(rate);
        judge_step(scene, result);
    }
    result.measured = static_cast<int>(rates.size());
    if (!rates.empty()) result.seconds_per_cost = std::accumulate(rates.begin(), rates.end(), 0.0) / static_cast<double>(rates.size());
    result.total = cost * result.seconds_per_cost;
    return result;
}

}  // namespace cvtflow::tasks
