#include "tasks/method/friction/friction_methods.hpp"

#include <algorithm>
#include <string>

#include "tasks/method/friction/friction_leapfrog.hpp"
#include "tasks/method/friction/rigid_sweep.hpp"
#include "tasks/method/friction/sweep_leapfrog.hpp"
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
            .stability = backward_euler_leapfrog_stability,
            .linear = backward_euler_leapfrog_step,
            .longest_step = longest_swept_step,
            .missing = missing_for_sweeps};
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
    };
}

std::string in_double_precision(std::string_view method) {
    const std::string name(method), longer = name + in_double;
    const auto programs = friction_methods();
    return std::ranges::any_of(programs, [&](const MethodProgram& program) { return program.name == longer; }) ? longer : name;
}

}  // namespace cvtflow::tasks
