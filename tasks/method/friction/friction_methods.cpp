#include "tasks/method/friction/friction_methods.hpp"

#include "tasks/method/friction/additive_method.hpp"
#include "tasks/method/friction/friction_leapfrog.hpp"
#include "tasks/method/friction/friction_stability.hpp"
#include "tasks/method/friction/implicit_leapfrog.hpp"
#include "tasks/method/stability/step_map.hpp"

namespace cvtflow::tasks {

namespace {

constexpr const char* ours = "this project (tasks/method/friction)";

/// Friction by explicit stages on velocities alone.
[[nodiscard]] MethodProgram explicit_friction(const char* name, const char* description, int order, Kick kick) {
    return {.name = name,
            .description = description,
            .source = ours,
            .order = order,
            .evaluations = 1,
            .state_slots = FrictionLeapfrog::state_slots,
            .slope_slots = FrictionLeapfrog::slope_slots,
            .make = [kick](Workspace& workspace) { return std::make_unique<FrictionLeapfrog>(workspace, kick); },
            .stability = [kick] { return leapfrog_stability(kick); },
            .linear = [kick](const LinearChain& chain) { return leapfrog_step(chain, kick); }};
}

/// Friction solved for inside the step of a leapfrog.
[[nodiscard]] MethodProgram implicit_friction(const char* name, const char* description, const char* source, int order, const char* solves,
                                              DirkTable (*table)()) {
    return {.name = name,
            .description = description,
            .source = source,
            .order = order,
            .evaluations = 1,
            .state_slots = ImplicitLeapfrog::state_slots,
            .slope_slots = ImplicitLeapfrog::slope_slots,
            .make = [table](Workspace& workspace) { return std::make_unique<ImplicitLeapfrog>(workspace, table()); },
            .solves = solves,
            .stability = [table] { return leapfrog_stability(table()); },
            .linear = [table](const LinearChain& chain) { return leapfrog_step(chain, table()); },
            .whole_pins = false};
}

[[nodiscard]] MethodProgram additive(const char* description, const char* solves, AdditiveTable (*table)()) {
    const AdditiveTable t = table();
    return {.name = t.name,
            .description = description,
            .source = t.source,
            .order = t.order,
            .evaluations = t.stages(),
            .state_slots = AdditiveMethod::state_slots,
            .slope_slots = AdditiveMethod::slope_slots(t),
            .make = [table](Workspace& workspace) { return std::make_unique<AdditiveMethod>(workspace, table()); },
            .solves = solves,
            .stability = [table] { return additive_stability(table()); },
            .linear = [table](const LinearChain& chain) { return additive_step(chain, table()); },
            .estimates_error = !t.embedded.empty(),
            .whole_pins = false};
}

}  // namespace

std::vector<MethodProgram> friction_methods() {
    return {
        explicit_friction("leapfrog-rkc", "leapfrog, friction inside the step by damped RKC stages on velocities alone", 2, Kick::rkc),
        explicit_friction("leapfrog-chebyshev", "the same with fewer, first-order stages that leave nothing stiff behind", 1,
                          Kick::chebyshev),
        implicit_friction("leapfrog-be", "leapfrog, friction solved for inside the step: backward Euler on velocities alone", ours, 1,
                          "1 a step, for friction", backward_euler),
        implicit_friction("leapfrog-sdirk2", "the same with two stages of order 2 (SDIRK2)",
                          "this project (tasks/method/friction); R. Alexander, SIAM J. Numer. Anal. 14 (1977) 1006-1021", 2,
                          "2 a step, for friction", sdirk2),
        additive("ARK4(3)6L[2]SA, additive Runge-Kutta: friction implicit, all else explicit", "5 a step, for friction", ark436),
        additive("ARS(3,4,3), additive Runge-Kutta: friction implicit, all else explicit", "3 a step, for friction", ars343),
    };
}

}  // namespace cvtflow::tasks
