#include "bench/method/implicit/catalogue.hpp"

#include <string>

#include "bench/method/implicit/linear_method.hpp"
#include "bench/method/implicit/trapezoidal.hpp"

namespace cvtflow::bench {

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

/// The requirement that a machine misses, empty if none. Accelerations of rigid pins depend on three neighbours on each side; exact
/// Jacobians and friction solved for in slips are made for halves, which depend on one. They also ignore that an eccentric flank moves as
/// its shaft turns, and that unbalance couples coordinates of a sheave.
[[nodiscard]] std::string_view missing_halves(const model::Parameters& parameters) noexcept {
    if (parameters.detail.pins != model::PinDetail::halves) return "detail.pins = \"halves\"";
    if (parameters.imperfection.unbalance != 0.0) return "imperfection.unbalance = 0";
    return parameters.imperfection.runout == 0.0 ? "" : "imperfection.runout = 0";
}

[[nodiscard]] MethodProgram trapezoidal(const NewtonVariant& variant) {
    return {.name = variant.name,
            .description = std::string("trapezoidal rule, order 2, A-stable: ") + variant.description,
            .source = "C. G. Broyden, Math. Comp. 19 (1965); L. K. Schubert, Math. Comp. 24 (1970)",
            .order = 2,
            .state_slots = TrapezoidalMethod::state_slots,
            .slope_slots = TrapezoidalMethod::slope_slots,
            .make = [&variant](Workspace& w) { return std::make_unique<TrapezoidalMethod>(w, variant.options); },
            .solves = "1 an iteration, for the whole state",
            .revision = 2,
            .missing = missing_halves};
}

/// Reach of plans that are not stable along the whole imaginary axis; all others have no limit.
[[nodiscard]] MethodReach reach_of(const LinearPlan& plan) {
    if (plan.name == std::string_view("w-x3")) return {.oscillation = 0.32108161697505255};
    if (plan.name == std::string_view("w-x4")) return {.oscillation = 0.62531112751049522};
    return {};
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
            .reach = reach_of(plan),
            .revision = 2,
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

}  // namespace cvtflow::bench
