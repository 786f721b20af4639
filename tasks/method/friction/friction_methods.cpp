#include "tasks/method/friction/friction_methods.hpp"

#include <algorithm>
#include <string>
#include <type_traits>

#include "tasks/method/friction/additive_method.hpp"
#include "tasks/method/friction/friction_leapfrog.hpp"
#include "tasks/method/friction/friction_stability.hpp"
#include "tasks/method/friction/implicit_leapfrog.hpp"
#include "tasks/method/stability/step_map.hpp"

namespace cvtflow::tasks {

namespace {

/// Ends the name of the method whose stages are in double precision.
constexpr const char* in_double = "-double";

template <Kick kick>
std::unique_ptr<StepMethod> make_double(Workspace& workspace) {
    return std::make_unique<FrictionLeapfrog<double>>(workspace, kick);
}

/// Stages in single precision, but for whole pins.
template <Kick kick>
std::unique_ptr<StepMethod> make(Workspace& workspace) {
    if (workspace.parameters.detail.pins == model::PinDetail::whole) return make_double<kick>(workspace);
    return std::make_unique<FrictionLeapfrog<float>>(workspace, kick);
}

template <DirkTable (*table)()>
std::unique_ptr<StepMethod> make_implicit(Workspace& workspace) {
    return std::make_unique<ImplicitLeapfrog>(workspace, table());
}

template <AdditiveTable (*table)()>
std::unique_ptr<StepMethod> make_additive(Workspace& workspace) {
    return std::make_unique<AdditiveMethod>(workspace, table());
}

template <Kick kick>
ProgramStability stability() {
    return leapfrog_stability(kick);
}

template <Kick kick>
std::unique_ptr<StepMap> linear_step(const LinearChain& chain) {
    return leapfrog_step(chain, kick);
}

template <auto table>
std::unique_ptr<StepMap> linear_step_with(const LinearChain& chain) {
    if constexpr (std::is_same_v<decltype(table()), DirkTable>)
        return leapfrog_step(chain, table());
    else
        return additive_step(chain, table());
}

template <auto table>
ProgramStability stability_of() {
    if constexpr (std::is_same_v<decltype(table()), DirkTable>)
        return leapfrog_stability(table());
    else
        return additive_stability(table());
}

template <AdditiveTable (*table)()>
MethodProgram additive(const char* description, const char* solves) {
    const AdditiveTable t = table();
    return {t.name,
            description,
            t.source,
            t.order,
            t.stages(),
            AdditiveMethod::state_slots,
            AdditiveMethod::slope_slots(t),
            make_additive<table>,
            solves,
            stability_of<table>,
            linear_step_with<table>,
            !t.embedded.empty(),
            false};
}

}  // namespace

std::vector<MethodProgram> friction_methods() {
    constexpr int states = LeapfrogFrame::state_slots, slopes = LeapfrogFrame::slope_slots;
    constexpr int own_states = ImplicitLeapfrog::state_slots, own_slopes = ImplicitLeapfrog::slope_slots;
    return {
        {"leapfrog-rkc", "leapfrog, friction inside the step by damped RKC stages on velocities alone",
         "this project (tasks/method/friction)", 2, 1, states, slopes, make<Kick::rkc>, "none", stability<Kick::rkc>,
         linear_step<Kick::rkc>},
        {"leapfrog-chebyshev", "the same with fewer, first-order stages that leave nothing stiff behind",
         "this project (tasks/method/friction)", 1, 1, states, slopes, make<Kick::chebyshev>, "none", stability<Kick::chebyshev>,
         linear_step<Kick::chebyshev>},
        {std::string("leapfrog-rkc") + in_double, "leapfrog-rkc with stages in double precision, too",
         "this project (tasks/method/friction)", 2, 1, states, slopes, make_double<Kick::rkc>, "none", stability<Kick::rkc>,
         linear_step<Kick::rkc>},
        {std::string("leapfrog-chebyshev") + in_double, "leapfrog-chebyshev with stages in double precision, too",
         "this project (tasks/method/friction)", 1, 1, states, slopes, make_double<Kick::chebyshev>, "none", stability<Kick::chebyshev>,
         linear_step<Kick::chebyshev>},
        {"leapfrog-be", "leapfrog, friction solved for inside the step: backward Euler on velocities alone",
         "this project (tasks/method/friction)", 1, 1, own_states, own_slopes, make_implicit<backward_euler>, "1 a step, for friction",
         stability_of<backward_euler>, linear_step_with<backward_euler>, false, false},
        {"leapfrog-sdirk2", "the same with two stages of order 2 (SDIRK2)",
         "this project (tasks/method/friction); R. Alexander, SIAM J. Numer. Anal. 14 (1977) 1006-1021", 2, 1, own_states, own_slopes,
         make_implicit<sdirk2>, "2 a step, for friction", stability_of<sdirk2>, linear_step_with<sdirk2>, false, false},
        additive<ark436>("ARK4(3)6L[2]SA, additive Runge-Kutta: friction implicit, all else explicit", "5 a step, for friction"),
        additive<ars343>("ARS(3,4,3), additive Runge-Kutta: friction implicit, all else explicit", "3 a step, for friction"),
    };
}

std::string in_double_precision(std::string_view method) {
    const std::string name(method), longer = name + in_double;
    const auto programs = friction_methods();
    return std::ranges::any_of(programs, [&](const MethodProgram& program) { return program.name == longer; }) ? longer : name;
}

}  // namespace cvtflow::tasks
