#include "tasks/method/spectral_method.hpp"

#include <algorithm>
#include <cmath>
#include "engine/method/dumka3.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

namespace {

constexpr double check_interval = 1e-4;  // s

}  // namespace

void SpectralChoice::check_spectrum() {
    if (std::abs(w_.step.time - checked_) < check_interval) return;
    w_.step.evaluations += bound_.estimate(w_.step.time, w_.states[0], w_.tips.phases.data());
    checked_ = w_.step.time;
}

/// Estimates the spectrum again after a rejected step.
const engine::CompiledPlan& SpectralChoice::choose(bool again) {
    if (again) checked_ = -1e300;
    check_spectrum();
    return stable_plan(w_.step.h);
}

void SpectralChoice::restart() noexcept {
    bound_.forget();
    checked_ = -1e300;
}

double SpectralChoice::longest_step(double requested) {
    check_spectrum();
    return longest(requested);
}

void SpectralChoice::visit(engine::Archive& archive) {
    archive("spectrum_checked", checked_);
    bound_.visit(archive);
}

std::size_t table_for(const Ladder& ladder, double real) noexcept {
    std::size_t first = 0;
    while (first + 1 < ladder.size() && ladder[first].real < real) ++first;
    return first;
}

const engine::CompiledPlan& LadderChoice::stable_plan(double h) { return tables_[table_for(tables_, real() * h)].plan; }

double LadderChoice::longest(double requested) {
    const double free = std::min(requested, tables_.back().real / real());
    const std::size_t first = table_for(tables_, real() * free);
    const auto within = [&](std::size_t k, double h) {
        return std::min({h, tables_[k].real / real(), tables_[k].imaginary / imaginary()});
    };
    if (first == 0) return within(0, free);
    const double stages = tables_[first].plan.stages() - 1, fewer = tables_[first - 1].plan.stages() - 1;
    const bool cheaper = tables_[first - 1].real * stages / fewer > real() * free;
    return cheaper ? within(first - 1, free) : within(first, free);
}

Ladder dumka3_ladder() {
    Ladder tables;
    for (int polynomial = 0; polynomial < engine::dumka3_polynomials; ++polynomial) {
        const engine::StagePlan plan = engine::dumka3(polynomial);
        tables.push_back({engine::CompiledPlan(plan), engine::dumka3_reach(polynomial), plan.reach->lightly_damped});
    }
    return tables;
}

std::unique_ptr<StepMethod> by_ladder(Workspace& workspace, int error_power, Ladder tables) {
    return std::make_unique<StageMethod>(workspace, error_power, std::make_unique<LadderChoice>(workspace, std::move(tables)));
}

std::unique_ptr<StepMethod> dumka3_by_spectrum(Workspace& workspace) { return by_ladder(workspace, 3, dumka3_ladder()); }

}  // namespace cvtflow::tasks
