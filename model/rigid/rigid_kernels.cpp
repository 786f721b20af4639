#include "model/rigid/rigid_kernels.hpp"

#include "model/basis/native_lanes.hpp"
#include "model/kernels/kernels.hpp"
#include "model/rigid/rigid_links.hpp"
#include "model/rigid/rigid_observation.hpp"
#include "model/rigid/rigid_plates.hpp"
#include "model/rigid/rigid_tips.hpp"

namespace cvtflow::model {

template <>
RigidKernels<PinReal> rigid_kernels<compiled_isa, PinReal>() noexcept {
    return {step_links, press_tips, plate_friction, rub_tips, step_pins, kick_pins, tip_depths, contact_changes, observe_pins};
}

}  // namespace cvtflow::model
