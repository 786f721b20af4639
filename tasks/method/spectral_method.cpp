#include "tasks/method/spectral_method.hpp"

#include <algorithm>
#include <cmath>
#include "engine/method/dumka3.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

namespace {

constexpr double check_interval = 1e-4;  // s

}  // namespace

void SpectralMethod::check_spectrum() {
    Workspace& w = workspace();
    if (std::abs(w.step.time - checked_) < check_interval) return;
    w.step.evaluations += bound_.estimate(w.step.time, w.states[0], w.tips.phases.data());
    checked_ = w.step.time;
}

/// Estimates the spectrum anew after a rejected step.
void SpectralMethod::prepare(bool again) {
    if (again) checked_ = -1e300;
    check_spectrum();
    choose(workspace().step.h);
}

void SpectralMethod::restart() noexcept {
    StageMethod::restart();
    bound_.forget();
    checked_ = -1e300;
}

double SpectralMethod::longest_step(double requested) {
    check_spectrum();
    return longest(requested);
}

void SpectralMethod::save(std::vector<double>& memory) const {
    std::vector<double> slope;
    StageMethod::save(slope);
    memory.assign(1, checked_);
    bound_.save(memory);
    memory.insert(memory.end(), slope.begin(), slope.end());
}

void SpectralMethod::load(std::span<const double> memory) {
    if (memory.empty()) return;
    checked_ = pop_front(memory, own_memory)[0];
    memory = bound_.load(memory);
    StageMethod::load(memory);
}

std::size_t table_for(const Ladder& ladder, double real) noexcept {
    std::size_t first = 0;
    while (first + 1 < ladder.size() && ladder[first].real < real) ++first;
    return first;
}

void LadderMethod::choose(double h) { use(tables_[table_for(tables_, real() * h)].plan); }

double LadderMethod::longest(double requested) {
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

std::unique_ptr<StepMethod> dumka3_by_spectrum(Workspace& workspace) {
    return std::make_unique<LadderMethod>(workspace, 3, dumka3_ladder());
}

}  // namespace cvtflow::tasks
