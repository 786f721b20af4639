#include "tasks/method/friction/friction_methods.hpp"

#include <algorithm>
#include <string>

#include "tasks/method/friction/additive/additive_method.hpp"
#include "tasks/method/friction/implicit_leapfrog.hpp"
#include "tasks/method/friction/staged/friction_leapfrog.hpp"
#include "tasks/method/friction/sweep/rigid_sweep.hpp"
#include "tasks/method/friction/sweep/sweep_leapfrog.hpp"
#include "tasks/method/stability/step_map.hpp"

namespace cvtflow::tasks {

namespace {

/// Ends the name of the method whose stages are in double precision.
constexpr const char* in_double = "-double";

constexpr const char* ours = "this project (tasks/method/friction)";

/// Contacts are kept in fields that rigid pins do not have.
[[nodiscard]] std::string_view missing_contact_fields(const model::Parameters& parameters) noexcept {
    return parameters.detail.pins != model::PinDetail::rigid ? "" : "detail.pins = \"halves\"";
}

/// Friction solved for as one convex problem: it must not fall with the sliding speed, and slips belong to pin halves.
[[nodiscard]] std::string_view missing_for_slips(const model::Parameters& parameters) noexcept {
    if (const std::string_view pins = missing_halves(parameters); !pins.empty()) return pins;
    return parameters.tip.friction_law == model::TipFriction::constant ? "" : "tip.friction_law = \"constant\"";
}

enum class Precision { with_single_stages, double_throughout };

/// Friction by explicit stages on velocities alone.
[[nodiscard]] MethodProgram explicit_friction(const std::string& name, const char* description, int order, Kick kick,
                                              Precision precision = Precision::with_single_stages) {
    return {.name = name,
            .description = description,
            .source = ours,
            .order = order,
            .evaluations = 1,
            .state_slots = LeapfrogFrame::state_slots,
            .slope_slots = LeapfrogFrame::slope_slots,
            .make = [kick, precision](Workspace& workspace) -> std::unique_ptr<StepMethod> {
                if (precision == Precision::double_throughout) return std::make_unique<FrictionLeapfrog<double>>(workspace, kick);
                return std::make_unique<FrictionLeapfrog<float>>(workspace, kick);
            },
            .stability = [kick] { return leapfrog_stability(kick); },
            .linear = [kick](const LinearChain& chain) { return leapfrog_step(chain, kick); },
            .missing = missing_contact_fields};
}

/// Over 20 ms on every ready scene slip is right to 0.2 % and the energy balance to 1e-3 of the losses (decision 96); stability allows
/// 1.85 to 2.0 us there [s].
constexpr double longest_swept_step = 2.0e-6;

/// Friction by sweeps over its contacts, which come close to backward Euler. @tparam Number of velocities inside the step
template <class Number>
[[nodiscard]] MethodProgram swept_friction(const std::string& name, const char* description) {
    return {.name = name,
            .description = description,
            .source = ours,
            .order = 1,
            .evaluations = 1,
            .state_slots = SweepLeapfrog<Number>::state_slots,
            .slope_slots = SweepLeapfrog<Number>::slope_slots,
            .make = [](Workspace& workspace) -> std::unique_ptr<StepMethod> {
                if (workspace.layout().rigid) return std::make_unique<RigidSweep>(workspace);
                return std::make_unique<SweepLeapfrog<Number>>(workspace);
            },
            .solves = "one per contact and sweep, for friction",
            .stability = [] { return leapfrog_stability(backward_euler()); },
            .linear = [](const LinearChain& chain) { return leapfrog_step(chain, backward_euler()); },
            .longest_step = longest_swept_step,
            .missing = missing_for_sweeps};
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
            .missing = missing_for_slips};
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
            .missing = missing_for_slips};
}

}  // namespace

std::vector<MethodProgram> friction_methods() {
    return {
        explicit_friction("leapfrog-rkc", "leapfrog, friction in damped RKC stages on velocities inside the step", 2, Kick::rkc),
        explicit_friction("leapfrog-chebyshev", "the same with fewer, first-order stages that damp stiff components fully", 1,
                          Kick::chebyshev),
        explicit_friction(std::string("leapfrog-rkc") + in_double, "leapfrog-rkc with stages in double precision, too", 2, Kick::rkc,
                          Precision::double_throughout),
        explicit_friction(std::string("leapfrog-chebyshev") + in_double, "leapfrog-chebyshev with stages in double precision, too", 1,
                          Kick::chebyshev, Precision::double_throughout),
        swept_friction<float>("leapfrog-sweep",
                              "leapfrog, friction solved contact by contact in sweeps that start from the forces of the last step"),
        swept_friction<double>(std::string("leapfrog-sweep") + in_double, "leapfrog-sweep with velocities in double precision, too"),
        implicit_friction("leapfrog-be", "leapfrog, friction implicit inside the step: backward Euler on velocities", ours, 1,
                          "1 a step, for friction", backward_euler),
        implicit_friction("leapfrog-sdirk2", "the same with two stages of order 2 (SDIRK2)",
                          "this project (tasks/method/friction); R. Alexander, SIAM J. Numer. Anal. 14 (1977) 1006-1021", 2,
                          "2 a step, for friction", sdirk2),
        additive("ARK4(3)6L[2]SA, additive Runge-Kutta: friction implicit, all else explicit", "5 a step, for friction", ark436),
        additive("ARS(3,4,3), additive Runge-Kutta: friction implicit, all else explicit", "3 a step, for friction", ars343),
    };
}

std::string in_double_precision(std::string_view method) {
    const std::string name(method), longer = name + in_double;
    const auto programs = friction_methods();
    return std::ranges::any_of(programs, [&](const MethodProgram& program) { return program.name == longer; }) ? longer : name;
}

}  // namespace cvtflow::tasks
