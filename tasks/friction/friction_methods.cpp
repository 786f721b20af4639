#include "tasks/friction/friction_methods.hpp"

#include "tasks/friction/friction_leapfrog.hpp"

namespace cvtflow::tasks {

namespace {

template <Kick kick>
std::unique_ptr<StepMethod> make(Workspace& workspace) {
    return std::make_unique<FrictionLeapfrog>(workspace, kick);
}

}  // namespace

std::vector<MethodProgram> friction_methods() {
    constexpr int states = FrictionLeapfrog::state_slots, slopes = FrictionLeapfrog::slope_slots;
    return {
        {"leapfrog-rkc", "leapfrog, friction inside the step by damped RKC stages on velocities alone", "this project (tasks/friction)", 2, 1, states, slopes,
         make<Kick::rkc>},
        {"leapfrog-chebyshev", "the same with fewer, first-order stages that leave nothing stiff behind", "this project (tasks/friction)", 1, 1, states, slopes,
         make<Kick::chebyshev>},
    };
}

}  // namespace cvtflow::tasks
