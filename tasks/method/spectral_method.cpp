#include "tasks/method/spectral_method.hpp"

#include <algorithm>
#include <cmath>
#include "engine/method/dumka3.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

namespace {

constexpr double look_interval = 1e-4;  // s

}  // namespace

void SpectralMethod::look() {
    Workspace& w = workspace();
    if (std::abs(w.step.time - looked_) < look_interval) return;
    w.step.evaluations += bound_.estimate(w.step.time, w.states[0], w.tips.phases.data());
    looked_ = w.step.time;
}

/// After a rejected step the spectrum may be another.
void SpectralMethod::prepare(bool again) {
    if (again) looked_ = -1e300;
    look();
    choose(workspace().step.h);
}

void SpectralMethod::restart() noexcept {
    StageMethod::restart();
    bound_.forget();
    looked_ = -1e300;
}

double SpectralMethod::longest_step(double wanted) {
    look();
    return longest(wanted);
}

void SpectralMethod::save(std::vector<double>& memory) const {
    std::vector<double> slope;
    StageMethod::save(slope);
    memory.assign(1, looked_);
    bound_.save(memory);
    memory.insert(memory.end(), slope.begin(), slope.end());
}

void SpectralMethod::load(std::span<const double> memory) {
    if (memory.empty()) return;
    looked_ = pop_front(memory, own_memory)[0];
    memory = bound_.load(memory);
    StageMethod::load(memory);
}

std::size_t rung_for(const Ladder& ladder, double real) noexcept {
    std::size_t rung = 0;
    while (rung + 1 < ladder.size() && ladder[rung].real < real) ++rung;
    return rung;
}

void LadderMethod::choose(double h) { use(rungs_[rung_for(rungs_, real() * h)].plan); }

double LadderMethod::longest(double wanted) {
    const double free = std::min(wanted, rungs_.back().real / real());
    const std::size_t rung = rung_for(rungs_, real() * free);
    const auto within = [&](std::size_t k, double h) { return std::min({h, rungs_[k].real / real(), rungs_[k].imaginary / imaginary()}); };
    if (rung == 0) return within(0, free);
    const double stages = rungs_[rung].plan.stages() - 1, fewer = rungs_[rung - 1].plan.stages() - 1;
    const bool cheaper = rungs_[rung - 1].real * stages / fewer > real() * free;
    return cheaper ? within(rung - 1, free) : within(rung, free);
}

Ladder dumka3_ladder() {
    Ladder rungs;
    for (int polynomial = 0; polynomial < engine::dumka3_polynomials; ++polynomial) {
        const engine::StagePlan plan = engine::dumka3(polynomial);
        rungs.push_back({engine::CompiledPlan(plan), engine::dumka3_coefficients(polynomial).real_length, plan.reach->lightly_damped});
    }
    return rungs;
}

std::unique_ptr<StepMethod> dumka3_by_spectrum(Workspace& workspace) {
    return std::make_unique<LadderMethod>(workspace, 3, dumka3_ladder());
}

}  // namespace cvtflow::tasks
