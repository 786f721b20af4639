#include "bench/lab/text/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "bench/method/analysis/order.hpp"
#include "bench/method/analysis/stability.hpp"
#include "engine/method/compiled_plan.hpp"
#include "tasks/scene/scene.hpp"
#include "tasks/scene/units.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

double read_time(const std::string& option, const std::string& text) {
    const auto parsed = tasks::parse_quantity(text);
    const auto* quantity = std::get_if<tasks::Quantity>(&parsed);
    const bool time = quantity != nullptr && (!quantity->has_unit || quantity->dimension == tasks::dimension_of("s"));
    if (!time || !(quantity->value > 0.0)) throw UsageError(fmt::format("{}: '{}' is not a time above 0, such as 40ns", option, text));
    return quantity->value;
}

namespace {

constexpr std::string_view automatic = "auto";

/// 0: automatic [s].
double read_step(const std::string& choice, const std::string& step) { return step == automatic ? 0.0 : read_time(choice, step); }

}  // namespace

std::vector<std::string> read_choice(const std::string& choice) {
    const auto at = choice.find('@'), tilde = choice.find('~');
    if (at == std::string::npos || at == 0 || (tilde != std::string::npos && tilde < at))
        throw UsageError(fmt::format("{}: write METHOD@STEP, METHOD@auto, or METHOD@LONGEST~TOLERANCE for steps by error", choice));
    require_method(choice.substr(0, at));
    const std::string step = choice.substr(at + 1, tilde == std::string::npos ? tilde : tilde - at - 1);
    const double seconds = read_step(choice, step);
    std::vector<std::string> settings{"run.method=" + choice.substr(0, at),
                                      seconds == 0.0 ? fmt::format("run.step={}", automatic) : fmt::format("run.step={:.17g}", seconds)};
    if (tilde != std::string::npos) {
        settings.emplace_back("run.step_control=error");
        settings.push_back("run.tolerance=" + choice.substr(tilde + 1));
    } else {
        settings.emplace_back("run.step_control=fixed");
    }
    return settings;
}

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

std::string residual_cell(const tasks::Fault& fault, const WatchResult& watch) {
    return fault ? "-" : fmt::format("{:.1e}", watch.residual);
}

std::string unreliable_remark(const tasks::Fault& fault, const WatchResult& watch) {
    if (fault || watch.reliable()) return {};
    return fmt::format("unreliable: the residual of the energy balance is {:.2g} times the tolerance", watch.balance_error_ratio);
}

std::string too_short(const WatchResult& watch) {
    if (watch.long_enough()) return {};
    return fmt::format("{} are {:.2g} pin periods: means of slip and efficiency require {:g} (about {} here)", time_text(watch.duration),
                       watch.pin_periods(), enough_pin_periods, time_text(enough_pin_periods * watch.pin_period));
}

nlohmann::ordered_json watch_json(const tasks::Fault& fault, const WatchResult& watch) {
    nlohmann::ordered_json json{{"status", watch.status(fault)}};
    if (fault) return json;
    const nlohmann::ordered_json figures{{"residual", watch.residual},         {"error_ratio", watch.balance_error_ratio},
                                         {"pin_periods", watch.pin_periods()}, {"long_enough", watch.long_enough()},
                                         {"mean_slip", watch.means.slip},      {"efficiency", watch.means.efficiency}};
    json.update(figures);
    return json;
}

namespace {

std::string quoted(const std::string& text) {
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') result += '\\';
        result += c;
    }
    return result + '"';
}

}  // namespace

std::string to_dot(const engine::TaskGraph& graph, int cycle) {
    std::string text = fmt::format("digraph cycle_{} {{\n    rankdir=LR;\n    node [shape=box];\n", cycle);
    for (int level = 0; level < graph.levels(cycle); ++level) {
        text += "    { rank=same;";
        for (const int task : graph.level(cycle, level)) text += fmt::format(" t{} [label={}];", task, quoted(graph.task(task).name));
        text += " }\n";
    }
    for (const int task : graph.topological(cycle)) {
        for (const int after : graph.successors(task)) text += fmt::format("    t{} -> t{};\n", task, after);
    }
    return text + "}\n";
}

}  // namespace cvtflow::bench
