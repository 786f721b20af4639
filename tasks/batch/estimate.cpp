#include <fmt/format.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <unordered_set>

#include "model/parameters/chain_layout.hpp"
#include "tasks/batch/batch.hpp"
#include "tasks/batch/case_engine.hpp"
#include "tasks/method/auto_step.hpp"
#include "tasks/method/method.hpp"
#include "tasks/run/saved_start.hpp"
#include "tasks/schedule/schedule.hpp"

namespace cvtflow::tasks {

namespace {

double cost_of_time(const Scene& scene, double time) {
    const std::optional<Method> method = Method::find(method_of(scene));
    const double longest = method ? longest_automatic_step(*method, scene.parameters) : usual_longest_step;
    return time / scene.run.step.value_or(longest) * step_cost(scene);
}

}  // namespace

double step_cost(const Scene& scene) {
    const std::optional<Method> method = Method::find(method_of(scene));
    return static_cast<double>(std::max(1, method ? method->evaluations_per_step() : 0)) * model::layout_of(scene.parameters).size();
}

double CaseCosts::of_run(const Scene& scene, bool continued) const {
    constexpr double usual = 3.0, usual_continued = 1.0;  // revolutions of the chain after which means are steady
    const double share = scene.run.until.automatic() ? std::min(1.0, (continued ? usual_continued : usual) / scene.run.steady_limit) : 1.0;
    return cost_of_time(scene, share * latest_end(scene));
}

double CaseCosts::of_settling(const Scene& scene) const { return cost_of_time(scene, scene.parameters.start.settling_time); }

bool CaseCosts::settles(const Scene& scene) {
    if (sweep_.start != StartMode::scene) return sweep_.start == StartMode::settle;
    if (scene.state_file.empty()) return true;
    if (scene.state_file != known_ || !state_) {
        state_ = saved_start(scene);
        settled_ = settled_layout(*state_, scene);
        known_ = scene.state_file;
    }
    return !has_coordinates(*state_, settled_, scene);
}

namespace {

/// Wall time [s] of a number of steps.
struct TrialPace {
    double wall = 0.0;
    long steps = 0;
};

/// Observes at every output of the run, as recorders and scalars do: at rigid pins that costs as much as the steps.
class ObservingObserver final : public RunObserver {
public:
    explicit ObservingObserver(const Simulation& simulation) : simulation_(simulation), observer_(simulation.workspace().variator) {}
    void output(double time, const Workspace& workspace, const Counters& /*counters*/) override {
        if (!simulation_.needs_settling()) static_cast<void>(workspace.observed_by(observer_, time));
    }
    void transition(const TransitionRecord& /*record*/) override {}

private:
    const Simulation& simulation_;
    model::Observer observer_;
};

/// Runs from a case's start in growing batches for `seconds`, but not beyond the case's end, where a run may break down although the case
/// does not. A fault ends the trial as well and is returned; the steps before it count.
Fault run_trial(Simulation& simulation, double seconds, long most, TrialPace& pace) {
    ObservingObserver observer(simulation);
    const engine::Cancellation never;
    using Clock = std::chrono::steady_clock;
    long before = std::min(100L, most / 2);  // many tips first touch here
    Fault fault = before > 0 ? simulation.advance({.steps = before, .new_part = true, .max_wall = 0.0}, observer, never)
                             : Fault{FaultKind::max_steps};
    for (long batch = 20; pace.wall < seconds && before < most && fault.kind == FaultKind::max_steps; batch *= 2) {
        const long requested = std::min(batch, most - before);
        // A run computes its automatic step once, which takes as long as a hundred steps.
        const bool anew = before == 0 || simulation.needs_settling();
        const long counted = anew ? 0 : simulation.counters().steps;
        const auto begin = Clock::now();
        fault = simulation.advance({.steps = requested, .new_part = anew, .max_wall = 0.0}, observer, never);
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
        const double stable = largest_step(simulation).step;
        result.stable_step = result.stable_step > 0.0 ? std::min(result.stable_step, stable) : stable;
        result.beyond = std::max(result.beyond, scene.run.step / stable);
    } catch (const std::exception&) {
        return;  // measuring reports that the case cannot begin
    }
}

}  // namespace

double step_wall(const Scene& scene, double seconds, std::string& untried, Fault* fault) {
    try {
        const double time = latest_end(scene) + (fitting_start(scene) == nullptr ? scene.parameters.start.settling_time : 0.0);
        const long most =
            std::max(2L, std::lround(time / scene.run.step.value_or(longest_automatic_step(method_of(scene), scene.parameters))));
        TrialPace pace;
        Fault met;
        const auto begin = std::chrono::steady_clock::now();
        const auto spent = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(); };
        for (long before = -1; pace.steps != before && (before < 0 || spent() < seconds);) {
            before = pace.steps;
            Simulation simulation(scene, Schedule{});
            met = run_trial(simulation, seconds, most, pace);
        }
        if (fault != nullptr) *fault = met;
        if (pace.steps > 0) return pace.wall / static_cast<double>(pace.steps);
        untried = met ? fmt::format("it fails in its first steps: {}", met.message()) : "it takes no step";
    } catch (const std::exception& error) {
        untried = error.what();
    }
    return 0.0;
}

namespace {

/// Cost of some cases; counts those of contradicting parameters, which cost nothing. Settling that several cases share counts once.
double cost_of(const Sweep& sweep, const std::vector<long>& cases, long& bad) {
    StartStates starts(sweep, {});
    CaseCosts costs(sweep);
    Scene scene = sweep.scene;
    if (sweep.start != StartMode::scene) scene.state_file.clear();
    std::unordered_set<long> settled;
    double total = 0.0;
    for (const long number : cases) {
        sweep.apply_case(number, scene);
        if (!violations(scene).empty()) {
            ++bad;
            continue;
        }
        const bool continued = number % sweep.strand() != 0;
        total += costs.of_run(scene, continued);
        if (continued) continue;
        const long first = starts.first_settling_alike(number);
        if (first >= 0 ? settled.insert(first).second : costs.settles(scene)) total += costs.of_settling(scene);
    }
    return total;
}

/// Cost of the cases that run once more at the end, from their own starts: as often as in a single process.
double cost_of_repeated(const Sweep& sweep, const std::vector<long>& cases) {
    const double confirmed = sweep.steady() ? 3.0 * sweep.confirmation.cases : 0.0, checked = sweep.strand() > 1 ? sweep.checked : 0.0;
    if (cases.empty()) return 0.0;
    const Scene scene = scene_of_case(sweep, cases[cases.size() / 2]);
    const CaseCosts costs(sweep);
    return (confirmed + checked) * costs.of_run(scene, false);
}

}  // namespace

BatchEstimate estimate(const Sweep& sweep, double seconds) {
    BatchEstimate result;
    std::vector<long> cases(static_cast<std::size_t>(sweep.cases()));
    std::iota(cases.begin(), cases.end(), 0L);
    result.cases = static_cast<long>(cases.size());
    const double cost = cost_of(sweep, cases, result.bad) + cost_of_repeated(sweep, cases);
    std::vector<double> rates;
    for (const std::size_t at : {cases.size() / 2, std::size_t{0}, cases.size() - 1}) {
        if (cases.empty()) break;
        const Scene scene = scene_of_case(sweep, cases[at]);
        if (result.untried = violations(scene); !result.untried.empty()) continue;
        if (const double wall = step_wall(scene, seconds / 3.0, result.untried); wall > 0.0) rates.push_back(wall / step_cost(scene));
        judge_step(scene, result);
    }
    result.measured = static_cast<int>(rates.size());
    if (!rates.empty()) result.seconds_per_cost = std::accumulate(rates.begin(), rates.end(), 0.0) / static_cast<double>(rates.size());
    result.total = cost * result.seconds_per_cost;
    return result;
}

}  // namespace cvtflow::tasks
