#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>

#include "bench/lab/command/command.hpp"
#include "bench/lab/text/text.hpp"
#include "engine/base/text.hpp"
#include "engine/method/catalogue.hpp"
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
