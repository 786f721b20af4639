#include "tasks/method/implicit/catalogue.hpp"

#include <string>

#include "tasks/method/implicit/linear_method.hpp"
#include "tasks/method/implicit/trapezoidal.hpp"
#include "tasks/method/stability/step_map.hpp"

namespace cvtflow::tasks {

namespace {

constexpr NewtonVariant variants[] = {
    {.name = "trapezoidal-analytic",
     .description = "Newton with exact derivatives in every iteration",
     .options = {.matrix = NewtonMatrix::every_iteration, .exact = true}},
    {.name = "trapezoidal-full",
     .description = "Newton, Jacobian by coloured differences in every iteration",
     .options = {.matrix = NewtonMatrix::every_iteration, .exact = false}},
    {.name = "trapezoidal-once",
     .description = "Newton, Jacobian by differences once per step",
     .options = {.matrix = NewtonMatrix::once_per_step, .exact = false}},
    {.name = "trapezoidal-frozen",
     .description = "Newton, Jacobian by differences, kept over steps while it converges",
     .options = {.matrix = NewtonMatrix::frozen, .exact = false}},
    {.name = "trapezoidal-broyden",
     .description = "Broyden's updates of a Jacobian kept over steps",
     .options = {.matrix = NewtonMatrix::broyden, .exact = false}},
    {.name = "trapezoidal-schubert",
     .description = "Broyden's updates within the sparsity (Schubert) of a Jacobian kept over steps",
     .options = {.matrix = NewtonMatrix::schubert, .exact = false}},
    {.name = "trapezoidal-plain",
     .description = "Newton from the explicit Euler step without backtracking: shows how it fails on friction",
     .options = {.matrix = NewtonMatrix::every_iteration, .exact = true, .start = NewtonStart::euler, .backtracking = false}},
};

[[nodiscard]] MethodProgram trapezoidal(const NewtonVariant& variant) {
    return {.name = variant.name,
            .description = std::string("trapezoidal rule, order 2, A-stable: ") + variant.description,
            .source = "C. G. Broyden, Math. Comp. 19 (1965); L. K. Schubert, Math. Comp. 24 (1970)",
            .order = 2,
            .state_slots = TrapezoidalMethod::state_slots,
            .slope_slots = TrapezoidalMethod::slope_slots,
            .make = [&variant](Workspace& w) { return std::make_unique<TrapezoidalMethod>(w, variant.options); },
            .solves = "1 an iteration, for the whole state",
            .stability = trapezoidal_stability,
            .linear = trapezoidal_step,
            .missing = missing_halves};
}

[[nodiscard]] MethodProgram linearly_implicit(const LinearPlan& plan) {
    const auto stages = static_cast<int>(plan.stages.size());
    return {.name = plan.name,
            .description = plan.description,
            .source = plan.source,
            .order = plan.order,
            .evaluations = stages,
            .state_slots = LinearMethod::state_slots(plan),
            .slope_slots = 2,
            .make = [&plan](Workspace& w) { return std::make_unique<LinearMethod>(w, plan); },
            .solves = std::to_string(stages) + " a step, for the whole state",
            .stability = [&plan] { return linear_stability(plan); },
            .linear = [&plan](const LinearChain& chain) { return implicit_step(chain, plan); },
            .missing = missing_halves};
}

}  // namespace

std::span<const NewtonVariant> newton_variants() noexcept { return variants; }

std::vector<MethodProgram> implicit_programs() {
    std::vector<MethodProgram> all;
    for (const NewtonVariant& variant : variants) all.push_back(trapezoidal(variant));
    for (const LinearPlan& plan : linear_plans()) all.push_back(linearly_implicit(plan));
    return all;
}

}  // namespace cvtflow::tasks
