#include "bench/method/fitted_method.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "bench/method/analysis/order.hpp"
#include "bench/method/analysis/stability.hpp"
#include "bench/method/family/fitted.hpp"
#include "engine/method/catalogue.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::bench {

namespace {

constexpr double max_real = 600.0, max_imaginary = 6.0;  ///< largest h times spectrum that a free step requests of a fit
constexpr int review_steps = 50;
constexpr double far_below = 0.7;

}  // namespace

std::optional<engine::StagePlan> fitted_plan(double real, double imaginary) {
    auto fitted = fit({std::max(real, bench::min_fitted_real), imaginary, 3, 0.2, 0.01});
    if (!fitted || fitted->plan.stages.size() > FittedChoice::max_stages + 1) return {};
    validate(fitted->plan);
    return std::move(fitted->plan);
}

void FittedChoice::refit(double real, double imaginary) {
    const auto fitted = fitted_plan(real, imaginary);
    if (!fitted)
        throw std::runtime_error(
            fmt::format("run.step: no fitted polynomial of up to {} stages is stable for a step whose spectrum reaches -{:.3g} and {:.3g}i",
                        max_stages, std::max(real, bench::min_fitted_real), imaginary));
    plan_.assign(1, engine::CompiledPlan(*fitted));
    fitted_real_ = real;
    fitted_imaginary_ = imaginary;
    steps_since_review_ = 0;
    max_recent_extent_ = 0.0;
    ++fits_;
}

const engine::CompiledPlan& FittedChoice::stable_plan(double h) {
    const double extent = real() * h, wide = imaginary() * h;
    max_recent_extent_ = std::max(max_recent_extent_, extent);
    if (extent > fitted_real_ || wide > fitted_imaginary_) {
        refit(fit_headroom * extent, fit_headroom * wide);
    } else if (++steps_since_review_ >= review_steps) {
        if (max_recent_extent_ < far_below * fitted_real_)
            refit(fit_headroom * max_recent_extent_, fit_headroom * max_recent_extent_ * imaginary() / real());
        steps_since_review_ = 0;
        max_recent_extent_ = 0.0;
    }
    return plan_.front();
}

void FittedChoice::restart() noexcept {
    SpectralChoice::restart();
    fitted_real_ = fitted_imaginary_ = max_recent_extent_ = 0.0;  // the next step asks for more: a new fit
    steps_since_review_ = 0;
}

void FittedChoice::visit(engine::Archive& archive) {
    double real = fitted_real_, imaginary = fitted_imaginary_, recent = max_recent_extent_;
    int steps = steps_since_review_;
    archive("fitted_real", real), archive("fitted_imaginary", imaginary), archive("recent_extent", recent);
    archive("steps_since_review", steps, 0, std::numeric_limits<int>::max());
    if (archive.reads() && real > 0.0) refit(real, imaginary);  // the same polynomial again
    max_recent_extent_ = recent;
    steps_since_review_ = steps;
    SpectralChoice::visit(archive);
}

double FittedChoice::longest(double requested) {
    return std::min({requested, max_real / (fit_headroom * real()), max_imaginary / (fit_headroom * imaginary())});
}

namespace {

PolynomialRange polynomial_range(const std::string& name, double real) {
    const engine::StagePlan plan = *engine::make_method(name);
    return {engine::CompiledPlan(plan), real, bench::stability_reach(plan, {-0.01, std::sqrt(1.0 - 1e-4)}, 1e-6)};
}

}  // namespace

/// Stages in a geometric ladder; the real reach is 0.65 of their square.
Ladder rkc_ladder() {
    Ladder polynomials;
    for (const int stages : {5, 7, 9, 11, 13, 16, 19, 23, 28, 34, 41, 50, 60, 72, 86, 103})
        polynomials.push_back(polynomial_range("rkc-s" + std::to_string(stages), 0.65 * stages * stages));
    return polynomials;
}

std::unique_ptr<StepMethod> rkc_by_spectrum(Workspace& workspace) { return by_ladder(workspace, 3, rkc_ladder()); }

std::unique_ptr<StepMethod> fitted_by_spectrum(Workspace& workspace) {
    return std::make_unique<StageMethod>(workspace, 3, std::make_unique<FittedChoice>(workspace));
}

}  // namespace cvtflow::bench
