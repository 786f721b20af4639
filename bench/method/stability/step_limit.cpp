#include "bench/method/stability/step_limit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/method/analysis/stability.hpp"
#include "bench/method/laboratory_methods.hpp"

namespace cvtflow::bench {

namespace {

constexpr double stable_growth = 1e-6;  ///< growth per step that still counts as stable, as in ProgramStability
constexpr double ray_damping = 0.01;

}  // namespace

std::string text_of(const StepLimit& limit) {
    const double kilohertz = limit.oscillation / (2e3 * std::numbers::pi);
    const std::string step = limit.step < 1e-6 ? fmt::format("{:.3g} ns", 1e9 * limit.step) : fmt::format("{:.3g} us", 1e6 * limit.step);
    const std::string where =
        limit.in_pulleys > 0.05 ? fmt::format(", {:.0f} % of it in shafts and sheaves", 100.0 * limit.in_pulleys) : "";
    switch (limit.by) {
        case StepLimiter::nothing: return "linear stability sets no limit";
        case StepLimiter::oscillation:
            return fmt::format("{} (oscillation of {:.3g} kHz under friction of {:.2g} 1/s{})", step, kilohertz, limit.friction, where);
        case StepLimiter::decay: return fmt::format("{} (decay of {:.2g} 1/s{})", step, limit.friction, where);
        case StepLimiter::friction_stages: return fmt::format("{} (no more stages for friction of {:.2g} 1/s)", step, limit.friction);
        case StepLimiter::polynomials: return fmt::format("{} (no polynomial for decays of {:.2g} 1/s)", step, limit.friction);
    }
    return "";
}

StepLimitBound::StepLimitBound(const model::Variator& variator, const Method& method)
    : bound_(variator, MovedPart::all, nullptr, held_links(method, variator.chain())) {
    if (const MethodProgram* program = method.program()) {
        const auto& stability = analysis_of(*program).stability;
        if (stability == nullptr) return;
        program_ = stability();
        takes_friction_apart_ = program_.equation == TestEquation::oscillator;
        return;
    }
    real_reach_ = bench::stability_reach(method.plan(), {-1.0, 0.0}, stable_growth);
    imaginary_reach_ = bench::stability_reach(method.plan(), {-ray_damping, std::sqrt(1.0 - ray_damping * ray_damping)}, stable_growth);
}

int StepLimitBound::update(double t, const double* state, const model::Phase* phases) {
    if (!takes_friction_apart_ && real_reach_ == 0.0) return 0;
    const int evaluations = bound_.estimate(t, state, phases);
    limit_ = judged();
    limit_.step *= calibration_;
    return evaluations;
}

void StepLimitBound::calibrate(double known) noexcept {
    if (!(known > 0.0) || !std::isfinite(known) || !std::isfinite(limit_.step)) return;
    calibration_ *= known / limit_.step;
    limit_.step = known;
}

StepLimit StepLimitBound::judged() const {
    if (takes_friction_apart_) return of_oscillator();
    const double by_decay = real_reach_ / bound_.real(), by_oscillation = imaginary_reach_ / bound_.imaginary();
    if (by_decay <= by_oscillation) return {by_decay, StepLimiter::decay, 0.0, bound_.real()};
    return {by_oscillation, StepLimiter::oscillation, bound_.imaginary(), 0.0};
}

StepLimit StepLimitBound::of_oscillator() const {
    const double fastest = bound_.imaginary(), stiffest = bound_.real();
    if (!(fastest > 0.0)) return {};
    if (!program_.beside) return {limit_with_any_friction(program_).oscillation / fastest, StepLimiter::oscillation, fastest, 0.0};
    // With the stages that the longest step would take: they are never fewer than those of a shorter one, and more allow longer steps.
    double step = program_.beside(2.0 * stiffest / fastest).oscillation / fastest;
    const FrictionLimit limit = program_.beside(step * stiffest);
    step = limit.oscillation / fastest;
    const double staged = program_.longest_decay / stiffest;
    if (staged < step) return {staged, StepLimiter::friction_stages, fastest, stiffest};
    return {step, StepLimiter::oscillation, fastest, limit.friction / step};
}

StepLimit estimated_step_limit(const model::Variator& variator, const Method& method, double t, const double* state,
                               const model::Phase* phases) {
    StepLimitBound bound(variator, method);
    bound.update(t, state, phases);
    return bound.limit();
}

void StepLimitBound::save(std::vector<double>& memory) const {
    memory.insert(memory.end(), {calibration_, limit_.step, static_cast<double>(limit_.by), limit_.oscillation, limit_.friction});
    bound_.save(memory);
}

std::span<const double> StepLimitBound::load(std::span<const double> memory) {
    calibration_ = memory[0];
    limit_ = {memory[1], static_cast<StepLimiter>(static_cast<int>(memory[2])), memory[3], memory[4]};
    return bound_.load(memory.subspan(5));
}

}  // namespace cvtflow::bench
