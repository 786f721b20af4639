#include "model/rigid/rigid_kernels.hpp"

#include "model/basis/native_lanes.hpp"
#include "model/kernels/kernels.hpp"
#include "model/rigid/rigid_guide.hpp"
#include "model/rigid/rigid_links.hpp"
#include "model/rigid/rigid_observation.hpp"
#include "model/rigid/rigid_plates.hpp"
#include "model/rigid/rigid_tips.hpp"

namespace cvtflow::model {

template <>
RigidKernels rigid_kernels<compiled_isa>() noexcept {
    constexpr auto rub = rub_tips<Evaluation::step>, rub_now = rub_tips<Evaluation::instant>;
    return {pitch_lines,    rolling_frames,  link_forces, joint_forces, sum_link_forces, filter_waves,    guide_pins, press_tips,
            press_tips_now, plate_friction,  rub,         rub_now,      joint_friction,  accelerate_pins, drift_pins, kick_pins,
            tip_depths,     contact_changes, observe_pins};
}

}  // namespace cvtflow::model
