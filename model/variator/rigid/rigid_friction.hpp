#pragma once
/// Friction of a contact, of the velocity that it leaves behind: implicit where the contact responds, and as it is where it does not.

#include "model/law/friction.hpp"
#include "model/variator/rigid/rigid_vectors.hpp"

namespace cvtflow::model {
namespace {

/// Sliding speed v that solves v + r C s(v) = w, with the law's share s: the contact slides by w without friction, and friction C s slows
/// it by r C s. The left side is concave, so Newton's method climbs towards the solution from below.
[[nodiscard]] inline PinLanes sliding_speed(const FrictionCurve& curve, const PinLanes& braking, const PinLanes& speed) noexcept {
    PinLanes v = larger<rigid_lanes>(speed - braking, speed / (1.0 + curve.inverse_saturation_speed * braking));
    for (int iteration = 0; iteration < 3; ++iteration) {
        const PinLanes excess = v + braking * friction_share<rigid_lanes>(curve, v) - speed;
        v -= excess / (1.0 + braking * slip_tangent<rigid_lanes>(curve, v));
    }
    return positive_part<rigid_lanes>(v);
}

/// Friction per free sliding velocity, so that F = -factor u.
/// @param capacity C = μ N, most friction [N]   @param response r of the sliding velocity to friction [m/s/N]
/// @param speed |u| of the velocity without friction [m/s]
[[nodiscard]] inline PinLanes friction_factor(const FrictionCurve& curve, const PinLanes& capacity, const PinLanes& response,
                                              const PinLanes& speed) noexcept {
    const PinLanes braking = response * capacity;
    if (curve.law == FrictionLaw::piecewise) {  // the speed is known: D = max(|u| - r C, v0)
        return capacity / (larger<rigid_lanes>(speed - braking, PinLanes(curve.saturation_speed)) + braking);
    }
    const PinLanes secant = slip_factor<rigid_lanes>(curve, sliding_speed(curve, braking, speed));
    return capacity * secant / (1.0 + braking * secant);
}

}  // namespace
}  // namespace cvtflow::model
