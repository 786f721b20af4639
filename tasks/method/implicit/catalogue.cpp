#include "tasks/method/implicit/catalogue.hpp"

#include <array>
#include <string>
#include <utility>

#include "tasks/method/implicit/implicit_stability.hpp"
#include "tasks/method/implicit/linear_method.hpp"
#include "tasks/method/implicit/trapezoidal.hpp"
#include "tasks/method/stability/step_map.hpp"

namespace cvtflow::tasks {

namespace {

constexpr std::array<NewtonVariant, 7> variants{{
    {"trapezoidal-analytic", "Newton with exact derivatives in every iteration", {.matrix = NewtonMatrix::every_iteration, .exact = true}},
    {"trapezoidal-full",
     "Newton, Jacobian by coloured differences in every iteration",
     {.matrix = NewtonMatrix::every_iteration, .exact = false}},
    {"trapezoidal-once", "Newton, Jacobian by differences once per step", {.matrix = NewtonMatrix::once_per_step, .exact = false}},
    {"trapezoidal-frozen",
     "Newton, Jacobian by differences kept over steps until it serves no longer",
     {.matrix = NewtonMatrix::frozen, .exact = false}},
    {"trapezoidal-broyden", "Broyden's updates of a Jacobian kept over steps", {.matrix = NewtonMatrix::broyden, .exact = false}},
    {"trapezoidal-schubert",
     "Broyden's updates within the sparsity (Schubert) of a Jacobian kept over steps",
     {.matrix = NewtonMatrix::schubert, .exact = false}},
    {"trapezoidal-plain",
     "Newton from the explicit Euler step without backtracking: how it fails on friction",
     {.matrix = NewtonMatrix::every_iteration, .exact = true, .start = NewtonStart::euler, .backtracking = false}},
}};

template <std::size_t Variant>
std::unique_ptr<StepMethod> make_trapezoidal(Workspace& workspace) {
    return std::make_unique<TrapezoidalMethod>(workspace, variants[Variant].options);
}

template <std::size_t Plan>
std::unique_ptr<StepMethod> make_linear(Workspace& workspace) {
    return std::make_unique<LinearMethod>(workspace, linear_plans()[Plan]);
}

template <std::size_t Plan>
ProgramStability stability_of_linear() {
    return linear_stability(linear_plans()[Plan]);
}

template <std::size_t Plan>
std::unique_ptr<StepMap> linear_step_of(const LinearChain& chain) {
    return implicit_step(chain, linear_plans()[Plan]);
}

template <std::size_t... Variant>
void add_trapezoidal(std::vector<MethodProgram>& all, std::index_sequence<Variant...>) {
    const auto program = [](const NewtonVariant& variant, auto make) {
        return MethodProgram{variant.name,
                             std::string("trapezoidal rule, order 2, A-stable: ") + variant.description,
                             "C. G. Broyden, Math. Comp. 19 (1965); L. K. Schubert, Math. Comp. 24 (1970)",
                             2,
                             0,
                             TrapezoidalMethod::state_slots,
                             TrapezoidalMethod::slope_slots,
                             make,
                             "1 an iteration, for the whole state",
                             trapezoidal_stability,
                             trapezoidal_step};
    };
    (all.push_back(program(variants[Variant], make_trapezoidal<Variant>)), ...);
}

template <std::size_t... Plan>
void add_linear(std::vector<MethodProgram>& all, std::index_sequence<Plan...>) {
    const auto program = [](const LinearPlan& plan, auto make, auto stability, auto linear) {
        const auto stages = static_cast<int>(plan.stages.size());
        return MethodProgram{plan.name,
                             plan.description,
                             plan.source,
                             plan.order,
                             stages,
                             LinearMethod::state_slots(plan),
                             2,
                             make,
                             std::to_string(stages) + " a step, for the whole state",
                             stability,
                             linear};
    };
    (all.push_back(program(linear_plans()[Plan], make_linear<Plan>, stability_of_linear<Plan>, linear_step_of<Plan>)), ...);
}

}  // namespace

std::span<const NewtonVariant> newton_variants() noexcept { return variants; }

std::vector<MethodProgram> implicit_programs() {
    std::vector<MethodProgram> all;
    add_trapezoidal(all, std::make_index_sequence<variants.size()>{});
    add_linear(all, std::make_index_sequence<linear_plan_count>{});
    for (MethodProgram& program : all) program.whole_pins = false;
    return all;
}

}  // namespace cvtflow::tasks
