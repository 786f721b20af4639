#include "tasks/friction/friction_methods.hpp"

#include "tasks/friction/friction_leapfrog.hpp"

namespace cvtflow::tasks {

std::vector<MethodProgram> friction_methods() {
    return {
        {"leapfrog-rkc", "leapfrog; friction by RKC stages inside the step, on velocities alone", "this project", 2, 1, FrictionLeapfrog::state_slots,
         FrictionLeapfrog::slope_slots, [](Workspace& workspace) -> std::unique_ptr<StepMethod> { return std::make_unique<FrictionLeapfrog>(workspace); }},
    };
}

}  // namespace cvtflow::tasks
