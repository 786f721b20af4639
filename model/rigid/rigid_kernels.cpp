#include "model/rigid/rigid_kernels.hpp"

#include "model/basis/native_lanes.hpp"
#include "model/kernels/kernels.hpp"
#include "model/rigid/rigid_links.hpp"
#include "model/rigid/rigid_plates.hpp"
#include "model/rigid/rigid_tips.hpp"

namespace cvtflow::model {

template <>
RigidKernels rigid_kernels<compiled_isa>() noexcept {
    return {pitch_lines,   roll_halves, link_forces,     lean_halves, gather_links, lengthen_pins, rub_plates,     press_tips,
            settle_joints, tip_moments, accelerate_pins, drift_pins,  kick_pins,    tip_depths,    contact_changes};
}

}  // namespace cvtflow::model
