#pragma once
/// Quantities of an instant of rigid pins: speeds, slip, tensions and forces, as `Observation` has them of the other levels of detail.

#include <array>

#include "model/variator/rigid/rigid_stepper.hpp"

namespace cvtflow::model {

struct RigidObservation {
    double time = 0.0;                    ///< [s]
    std::array<double, 2> speed{};        ///< of the shafts [rad/s]
    std::array<double, 2> torque{};       ///< on the shafts from outside: drive, load (negative brakes) [N·m]
    std::array<double, 2> clamping{};     ///< S_1, S_2 [N]
    std::array<double, 2> radius{};       ///< mean running radius of the pins that touch [m]
    std::array<double, 2> pin_speed{};    ///< mean angular speed of the pins that touch [rad/s]
    std::array<double, 4> axial_force{};  ///< of all tips on sheaves 1-, 1+, 2-, 2+ [N]
    double ratio = 0.0;                   ///< ω_1/ω_2
    double slip = 0.0;                    ///< 1 - (Ω_1/ω_1)(ω_2/Ω_2), Ω: pin_speed
    double thrust_ratio = 0.0;            ///< axial force on the driving sheaves over that on the driven ones
    double tight = 0.0, slack = 0.0;      ///< mean tension of the strand at y > 0, at y < 0 [N]
    int touching = 0;                     ///< tips
    double largest_normal = 0.0;          ///< largest normal force of a pin's end [N]
};

/// Forces belong to the last evaluation, velocities to half a step later. Zero where there are no pulleys.
[[nodiscard]] RigidObservation observe(const RigidStepper& stepper) noexcept;

}  // namespace cvtflow::model
