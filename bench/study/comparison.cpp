#include "bench/study/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>

#include "bench/study/method_run.hpp"
#include "model/observe/observation.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/tuning/relative_error.hpp"

namespace cvtflow::bench {

using namespace tasks;

namespace {

/// Keeps what a Course holds.
class CourseKeeper final : public RunObserver {
public:
    CourseKeeper(const model::Variator& variator, double begin) : observer_(variator), begin_(begin) {}

    void output(double time, const Workspace& workspace, const Counters&) override {
        const model::Observation& seen = observer_.observe(time, workspace.states[0], workspace.tips.phases.data());
        watch.add(seen, workspace);
        if (course.time.empty()) {
            const model::ChainLayout& at = workspace.layout();
            for (int link = 0; link < at.links; ++link)
                course.side.push_back(workspace.states[0][at.link_begin(link) + at.x(model::End::rear, 0)]);
        }
        course.time.push_back(time - begin_);
        course.tip_axial.push_back(seen.tip_axial);
        course.tension.push_back(seen.tension);
    }
    void transition(const TransitionRecord& record) override { course.transitions.push_back(record); }

    Course course;
    RunWatch watch;

private:
    model::Observer observer_;
    double begin_;
};

double distance(const std::vector<std::vector<double>>& is, const std::vector<std::vector<double>>& should) {
    RelativeError error;
    for (std::size_t row = 0; row < should.size(); ++row) error.add(is[row], should[row]);
    return error.value();
}

/// The first tip that comes to touch a sheave of the driving shaft, which stands at x = 0, and is not left again.
const TransitionRecord* first_entry(const Course& course, double centre_distance) {
    for (const TransitionRecord& record : course.transitions) {
        const bool enters = record.from == model::Phase::free && record.to != model::Phase::free;
        const bool driving = course.side[static_cast<std::size_t>(record.pin) % course.side.size()] < 0.5 * centre_distance;
        if (enters && driving) return &record;
    }
    return nullptr;
}

void judge(Compared& compared, const Comparison& comparison) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    compared.error_axial = compared.error_tension = compared.error_pin = none;
    if (compared.fault || compared.course.time.size() != comparison.reference.time.size()) return;
    compared.error_axial = distance(compared.course.tip_axial, comparison.reference.tip_axial);
    compared.error_tension = distance(compared.course.tension, comparison.reference.tension);
    if (!comparison.pin) return;
    std::vector<std::vector<double>> is, should;
    for (const int side : {0, 1}) {
        is.push_back(compared.course.pin_axial(*comparison.pin, side));
        should.push_back(comparison.reference.pin_axial(*comparison.pin, side));
    }
    compared.error_pin = distance(is, should);
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values.empty() ? 0.0 : values[values.size() / 2];
}

/// All candidates in turns, so that a busy neighbour slows all of them.
void time_candidates(const model::Parameters& parameters, const FrozenStart& start, const ComparisonOptions& options,
                     const engine::Cancellation& cancel, std::vector<Compared>& candidates) {
    std::vector<std::vector<double>> seconds(candidates.size());
    for (int round = 0; round < options.rounds; ++round) {
        if (options.progress) options.progress(fmt::format("round {} of {}", round + 1, options.rounds));
        for (std::size_t k = 0; k < candidates.size(); ++k) {
            if (candidates[k].fault) continue;
            MethodRun run(parameters, candidates[k].candidate.method);
            SilentObserver nobody;
            const auto began = std::chrono::steady_clock::now();
            if (run.run(start, options.duration, candidates[k].candidate.step, options.output_interval, nobody, cancel)) return;
            seconds[k].push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count());
        }
    }
    for (std::size_t k = 0; k < candidates.size(); ++k) candidates[k].seconds = median(seconds[k]);
}

Compared run_candidate(const model::Parameters& parameters, const FrozenStart& start, const Candidate& candidate,
                       const ComparisonOptions& options, const engine::Cancellation& cancel) {
    if (options.progress)
        options.progress(candidate.step == 0.0 ? candidate.method + " at automatic steps"
                                               : fmt::format("{} at {:g} s", candidate.method, candidate.step));
    MethodRun run(parameters, candidate.method);
    CourseKeeper keeper(run.workspace().variator, start.time);
    Compared compared;
    compared.candidate = candidate;
    compared.fault = run.run(start, options.duration, candidate.step, options.output_interval, keeper, cancel);
    compared.step = run.step();
    compared.counters = run.counters();
    compared.course = std::move(keeper.course);
    compared.watch = keeper.watch.verdict(run.workspace().energy, start.suspicion);
    return compared;
}

}  // namespace

std::vector<double> Course::pin_axial(int pin, int sheave_side) const {
    const std::size_t links = side.size();
    const std::size_t own = static_cast<std::size_t>(pin), before = (own + links - 1) % links;
    const auto number = static_cast<std::size_t>(sheave_side);
    std::vector<double> forces;
    for (const std::vector<double>& tips : tip_axial)
        forces.push_back(tips[model::tips_per_link * own + number] + tips[model::tips_per_link * before + 2 + number]);
    return forces;
}

Comparison compare(const model::Parameters& parameters, const FrozenStart& start, std::span<const Candidate> candidates,
                   const ComparisonOptions& options, const engine::Cancellation& cancel) {
    Comparison comparison;
    Compared reference = run_candidate(parameters, start, options.reference, options, cancel);
    if (reference.fault) throw SimulationError("the reference: " + reference.fault.message());
    comparison.reference = std::move(reference.course);
    comparison.reference_counters = reference.counters;
    comparison.reference_watch = reference.watch;
    comparison.pin = options.pin;
    const TransitionRecord* entry = first_entry(comparison.reference, parameters.pulley.centre_distance);
    if (entry != nullptr && !options.pin) {
        comparison.pin = entry->pin % parameters.chain.pins;
        comparison.entry = entry->time - start.time;
    }
    for (const Candidate& candidate : candidates) {
        comparison.candidates.push_back(run_candidate(parameters, start, candidate, options, cancel));
        judge(comparison.candidates.back(), comparison);
    }
    time_candidates(parameters, start, options, cancel, comparison.candidates);
    return comparison;
}

}  // namespace cvtflow::bench
