#include "tasks/method/method.hpp"

#include "tasks/method/friction/rigid_leapfrog.hpp"
#include "tasks/method/friction/sweep_leapfrog.hpp"

namespace cvtflow::tasks {

namespace {

constexpr const char* ours = "this project (tasks/method/friction)";

/// Reach of a leapfrog, which implicit friction leaves as it is: h ω < 2; damping acts at the velocity v + (v - v before)/2 in the middle,
/// as by Adams and Bashforth, and -1 is an eigenvalue at h δ = 1.
constexpr double leapfrog_reach = 2.0000000000002398, damping_reach = 1.0;

/// Longest step [s]: 20 in 100 us. Over 100 ms of every ready scene slip is right to 0.3 % and losses to 0.2 % (decision 115).
constexpr double longest_swept_step = 5.001e-6;

/// Friction by sweeps over its contacts, which come close to backward Euler.
[[nodiscard]] MethodProgram swept_friction() {
    return {.name = "leapfrog-sweep",
            .description = "leapfrog, friction solved contact by contact in sweeps that start from the forces of the last step",
            .source = ours,
            .order = 1,
            .evaluations = 1,
            .state_slots = SweepLeapfrog::state_slots,
            .slope_slots = SweepLeapfrog::slope_slots,
            .make = [](Workspace& workspace) { return std::make_unique<SweepLeapfrog>(workspace); },
            .solves = "one per contact and sweep, for friction",
            .reach = {.oscillation = leapfrog_reach, .damping = damping_reach},
            .longest_step = longest_swept_step,
            .holds_links = true,
            .revision = 7,
            .missing = missing_for_sweeps};
}

[[nodiscard]] std::string_view missing_rigid_pins(const model::Parameters& parameters) noexcept {
    return parameters.detail.pins == model::PinDetail::rigid ? "" : "detail.pins = \"rigid\"";
}

/// Longest step of rigid pins, where strands are off by 0.5 % and slip by 1.5 % at most (docs/accuracy.md). 11.5 us are stable at
/// `baseline`, but with 8.33 us the energy balance of four of forty machines exceeds its tolerance (decision 110). The step is shorter
/// where friction falls and where the chain is fast (auto_step.cpp) [s].
constexpr double longest_rigid_step = 7.5e-6;

/// Dampers of rigid pins take the velocity before the step: -1 is an eigenvalue at h δ = 2.
constexpr double rigid_damping_reach = 2.0;

/// Implicit friction of rigid pins, solved where it acts: stable up to h²ω² + 2 h d < 4, filtered waves to h ω < 1/√β.
[[nodiscard]] MethodProgram rigid_friction() {
    return {.name = "leapfrog-rigid",
            .description = "leapfrog of rigid pins, friction solved where it acts: of plates around the chain, of tips pin by pin",
            .source = ours,
            .order = 1,
            .evaluations = 1,
            .state_slots = RigidLeapfrog::state_slots,
            .slope_slots = RigidLeapfrog::slope_slots,
            .make = [](Workspace& workspace) { return std::make_unique<RigidLeapfrog>(workspace); },
            .solves = "one per contact, and one around the chain, for friction",
            .reach = {.oscillation = leapfrog_reach, .damping = rigid_damping_reach, .filter = model::wave_filter},
            .longest_step = longest_rigid_step,
            .revision = 5,
            .missing = missing_rigid_pins};
}

}  // namespace

std::vector<MethodProgram> friction_methods() { return {swept_friction(), rigid_friction()}; }

}  // namespace cvtflow::tasks
