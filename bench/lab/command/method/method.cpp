#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <complex>
#include <memory>

#include "bench/lab/command/command.hpp"
#include "bench/method/analysis/order.hpp"
#include "bench/method/analysis/stability.hpp"
#include "engine/base/text.hpp"
#include "engine/method/catalogue.hpp"
#include "engine/method/compiled_plan.hpp"
#include "tasks/method/method.hpp"
#include "tasks/scene/scene.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/text/text.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

constexpr std::size_t short_table = 24;

struct MethodArguments {
    std::string name;
    double length = 0.0;
    bool table = false;
};

std::string reach_text(double reach) { return std::isinf(reach) ? "without limit" : fmt::format("to {:.4g}", reach); }

std::string program_text(const tasks::MethodProgram& program) {
    return field("source", program.source) + field("order", fmt::format("{}", program.order)) +
           field("evaluations", program.evaluations > 0 ? fmt::format("{} per step", program.evaluations) : "depends on the step") +
           field("systems solved", program.solves) +
           field("oscillations", fmt::format("stable {} in h omega", reach_text(program.reach.oscillation))) +
           field("decays", fmt::format("stable {} in h|lambda|", reach_text(program.reach.decay)));
}

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

/// Lines with everything that is derived from the table: stages, order, stability, growth and gain, error estimate.
/// @param length growth and gain are measured on [-length, 0]; 0: on the real interval of stability
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

/// The table itself, a line per stage.
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

ExitStatus describe_method(const MethodArguments& arguments) {
    const std::optional<tasks::Method> found = tasks::Method::find(arguments.name);
    if (!found) throw UsageError(tasks::no_method(arguments.name));
    if (const tasks::MethodProgram* program = found->program()) {
        fmt::print("{}: {}\n{}", program->name, program->description, program_text(*program));
        return ExitStatus::finished;
    }
    const engine::StagePlan& plan = found->plan();
    fmt::print("{}: {}\n{}", plan.name, plan.description, method_figures(plan, arguments.length));
    if (arguments.table || plan.stages.size() <= short_table) {
        fmt::print("\n{}", method_table(plan));
    } else {
        fmt::print("\n  --table prints the {} stages\n", plan.stages.size());
    }
    return ExitStatus::finished;
}

}  // namespace

Action declare_method(CLI::App& app) {
    const auto arguments = std::make_shared<MethodArguments>();
    app.add_option("NAME", arguments->name, "Method (cvtflow list methods), e.g. dopri54, rkc-s37-e10, fitted-l200-w2")
        ->required()
        ->type_name("");
    app.add_option("--real", arguments->length, "Measure growth and gain on [-LENGTH, 0] (default: the whole real interval of stability)")
        ->type_name("LENGTH")
        ->check(CLI::PositiveNumber);
    app.add_flag("--table", arguments->table, "Print the table, whatever its length");
    app.footer(
        "All properties are derived from the table: order by rooted trees, stability by executing it on y' = lambda y.\n"
        "growth: largest |Y|/|y| of a stage. gain: largest amplification of an error of one stage until the end of the step; each passage\n"
        "through the corner of the friction law is such an error.");
    return [arguments] { return describe_method(*arguments); };
}

}  // namespace cvtflow::bench
