#include "bench/lab/text/method_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "bench/method/analysis/order.hpp"
#include "bench/method/analysis/stability.hpp"
#include "engine/method/compiled_plan.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

std::complex<double> ray(double damping_ratio) { return {-damping_ratio, std::sqrt(1.0 - damping_ratio * damping_ratio)}; }

std::string stability_lines(const engine::StagePlan& plan, double real) {
    std::string text = field("real axis", fmt::format("stable to h|lambda| = {:.4g}, {:.3g} per evaluation", real,
                                                      real / static_cast<double>(plan.stages.size())));
    const double imaginary = bench::imaginary_stability(plan);
    text += field("imaginary axis", imaginary > 0.02 ? fmt::format("stable to {:.4g}", imaginary) : "weakly unstable");
    return text + field("damped by 1, 5, 20 %",
                        fmt::format("stable to {:.4g}, {:.4g}, {:.4g}", bench::stability_reach(plan, ray(0.01), 1e-6),
                                    bench::stability_reach(plan, ray(0.05), 1e-6), bench::stability_reach(plan, ray(0.2), 1e-6)));
}

std::string combination(const std::vector<engine::Term>& states, const std::vector<engine::Term>& slopes) {
    std::string text;
    const auto add = [&](double factor, const std::string& what) {
        text += text.empty() ? (factor < 0.0 ? "-" : "") : (factor < 0.0 ? " - " : " + ");
        text += std::abs(factor) == 1.0 ? what : fmt::format("{:.12g} {}", std::abs(factor), what);
    };
    for (const engine::Term& term : states) add(term.factor, fmt::format("Y{}", term.slot));
    for (const engine::Term& term : slopes) add(term.factor, fmt::format("h K{}", term.slot));
    return text.empty() ? "0" : text;
}

}  // namespace

std::string method_figures(const engine::StagePlan& plan, double length) {
    const engine::CompiledPlan compiled(plan);
    const double real = bench::real_stability(plan);
    const double on = length > 0.0 ? length : 0.99 * real;
    const auto stages = static_cast<long>(plan.stages.size());
    std::string text = field("source", plan.source);
    text += field("stages", compiled.last_is_result() ? fmt::format("{}, the last one is reused by the next step: {} per step",
                                                                    plural(stages, "evaluation"), stages - 1)
                                                      : fmt::format("{} a step", plural(stages, "evaluation")));
    text += field("memory", fmt::format("{} and {}", plural(plan.state_slots, "state"), plural(plan.slope_slots, "slope")));
    text += field("order", bench::order_text(plan));
    text += stability_lines(plan, real);
    text += field("stages grow", fmt::format("to {:.4g} of y on [-{:.4g}, 0]", bench::stage_growth(plan, on), on));
    text += field("errors of a stage", fmt::format("amplified by {:.4g} at the end of the step", bench::perturbation_gain(plan, on)));
    return text + field("error estimate", plan.error ? "yes" : "none");
}

std::string method_table(const engine::StagePlan& plan) {
    const engine::CompiledPlan compiled(plan);
    std::string text;
    for (int i = 0; i < compiled.stages(); ++i) {
        const engine::Stage& stage = plan.stages[static_cast<std::size_t>(i)];
        const std::string kept = stage.keep >= 0 ? fmt::format("Y{} = ", stage.keep) : "";
        text += fmt::format("  {:>3}  K{} = f(t + {:.12g} h, {}{})\n", i, stage.slope, compiled.stage(i).time, kept,
                            combination(stage.states, stage.slopes));
    }
    text += fmt::format("  y(t + h) = {}\n", combination(plan.result.states, plan.result.slopes));
    if (plan.error) text += fmt::format("  error    = {}\n", combination(plan.error->states, plan.error->slopes));
    return text;
}

}  // namespace cvtflow::bench
