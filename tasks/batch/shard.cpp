#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <queue>

#include "tasks/batch/batch.hpp"
#include "tasks/batch/case_engine.hpp"
#include "tasks/method/stability/predicted_step.hpp"
#include "tasks/run/saved_start.hpp"
#include "tasks/schedule/schedule.hpp"

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

namespace {

/// How long so many steps took.
struct TrialPace {
    double wall = 0.0;
    long steps = 0;
};

/// Goes on from a case's start in growing batches for so many seconds, but not beyond the case's end: what lies there may break down where
/// the case does not. A fault ends it as well and is returned; steps up to there have cost what steps cost.
Fault go(Simulation& simulation, double seconds, long most, TrialPace& pace) {
    SilentObserver silent;
    const engine::Cancellation go_on;
    using Clock = std::chrono::steady_clock;
    long before = std::min(100L, most / 2);  // many tips first touch here
    Fault fault =
        before > 0 ? simulation.advance({.steps = before, .anew = true, .max_wall = 0.0}, silent, go_on) : Fault{FaultKind::max_steps};
    for (long batch = 20; pace.wall < seconds && before < most && fault.kind == FaultKind::max_steps; batch *= 2) {
        const long requested = std::min(batch, most - before);
        // A run computes its automatic step once, which takes as long as a hundred steps.
        const bool anew = before == 0 || simulation.needs_settling();
        const long counted = anew ? 0 : simulation.counters().steps;
        const auto begin = Clock::now();
        fault = simulation.advance({.steps = requested, .anew = anew, .max_wall = 0.0}, silent, go_on);
        pace.wall += std::chrono::duration<double>(Clock::now() - begin).count();
        pace.steps += fault.kind == FaultKind::max_steps ? requested : simulation.counters().steps - counted;
        before += requested;
    }
    return fault.kind == FaultKind::max_steps ? Fault{} : fault;
}

/// Notes how far a case is stable, if it begins with a state that has settled.
void judge_step(const Scene& scene, BatchEstimate& result) {
    try {
        const Simulation simulation(scene, Schedule{});
        if (simulation.needs_settling()) return;
        const double stable =
            predicted_step_limit(simulation.variator(), scene.parameters, simulation.method(), frozen_start(simulation)).step;
        result.stable_step = result.stable_step > 0.0 ? std::min(result.stable_step, stable) : stable;
        result.beyond = std::max(result.beyond, scene.run.step / stable);
    } catch (const std::exception&) {
        return;  // measuring reports that the case cannot begin
    }
}

}  // namespace

double step_wall(const Scene& scene, double seconds, std::string& untried, Fault* fault) {
    try {
        const double time = scene.run.until + (fitting_start(scene) == nullptr ? scene.parameters.start.settling_time : 0.0);
        const long most =
            std::max(2L, std::lround(time / scene.run.step.value_or(longest_automatic_step(method_of(scene), scene.parameters))));
        TrialPace pace;
        Fault met;
        const auto begin = std::chrono::steady_clock::now();
        const auto spent = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(); };
        for (long before = -1; pace.steps != before && (before < 0 || spent() < seconds);) {
            before = pace.steps;
            Simulation simulation(scene, Schedule{});
            met = go(simulation, seconds, most, pace);
        }
        if (fault != nullptr) *fault = met;
        if (pace.steps > 0) return pace.wall / static_cast<double>(pace.steps);
        untried = met ? fmt::format("it fails in its first steps: {}", met.message()) : "it takes no step";
    } catch (const std::exception& error) {
        untried = error.what();
    }
    return 0.0;
}

BatchEstimate estimate(const Sweep& sweep, const Shard& shard, double seconds) {
    BatchEstimate result;
    const std::vector<long> cases = shard_cases(sweep, shard);
    Scene scene = sweep.scene;
    double cost = 0.0;
    for (const long number : cases) {
        sweep.apply_case(number, scene);
        if (violations(scene).empty())
            cost += case_cost(sweep, scene);
        else
            ++result.bad;
    }
    result.cases = static_cast<long>(cases.size());
    std::vector<double> rates;
    for (const std::size_t at : {cases.size() / 2, std::size_t{0}, cases.size() - 1}) {
        if (cases.empty()) break;
        sweep.apply_case(cases[at], scene);
        if (!violations(scene).empty()) continue;
        if (const double wall = step_wall(scene, seconds / 3.0, result.untried); wall > 0.0) rates.push_back(wall / step_cost(scene));
        judge_step(scene, result);
    }
    result.measured = static_cast<int>(rates.size());
    if (!rates.empty()) result.seconds_per_cost = std::accumulate(rates.begin(), rates.end(), 0.0) / static_cast<double>(rates.size());
    result.total = cost * result.seconds_per_cost;
    return result;
}

}  // namespace cvtflow::tasks
