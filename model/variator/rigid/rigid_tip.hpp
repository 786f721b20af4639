#pragma once
/// One tip of rigid pins side by side: where it is on its sheave, its normal force, its sliding velocity and what it does to both.
/// (model/EQUATIONS.md section 11)

#include <algorithm>

#include "model/force/sheave_motion.hpp"
#include "model/variator/rigid/rigid_coefficients.hpp"
#include "model/variator/rigid/rigid_vectors.hpp"

namespace cvtflow::model {
namespace {

/// The sheaves of one side as pins side by side see them. z [m] counts from where the undisplaced flank plane is.
struct SheaveSide {
    Plane centre;
    PinLanes z, tilt_x, tilt_y;
    Plane velocity;
    PinLanes velocity_z, spin_x, spin_y, spin_z;
};

/// A pin half: its middle against the pin's, outward normal and direction of its pitch line, and how they move.
struct HalfMotion {
    Plane offset, offset_rate, outward, line;
    PinLanes turn;                    ///< θ' [rad/s]
    PinLanes slope_out, slope_along;  ///< σ·o, σ·t [rad]
    PinLanes slope_out_rate;          ///< σ'·o [rad/s]
};

/// Coordinates or velocities of pins.
struct PinMotion {
    Plane middle, end;
    PinLanes z;
};

/// Generalised forces of tips on pins, and on the pitch line of one half.
struct TipForces {
    Plane half, end;
    PinLanes z, moment;
};

struct TipPlace {
    double side;  ///< s = ±1
    Plane arm;    ///< r = S - O
    PinLanes arm_z;
    PinLanes inverse_radius;  ///< [1/m]
    Plane radial;             ///< unit vector from the axis to the sphere's centre, in the sheave's frame
    PinLanes out, in;         ///< ν_r, ν_z: components of the normal, outward and towards the other sheave
    Plane normal;             ///< G
    PinLanes normal_z;
    Plane reach;                    ///< P - E
    PinLanes depth;                 ///< δ_0 [m]
    PinLanes tilting_x, tilting_y;  ///< (r×ν): depth per tilt of the sheave [m]
};

/// Extremes of all tips: depth, inverse radius of the spheres' centres, that of tips that touch.
struct TipBounds {
    PinLanes deepest{-1e300}, nearest{0.0}, farthest{1e300};

    void add(const TipPlace& tip) noexcept {
        deepest = larger<rigid_lanes>(tip.depth, deepest);
        nearest = larger<rigid_lanes>(tip.inverse_radius, nearest);
        const PinLanes touching = select_greater<rigid_lanes>(tip.depth, PinLanes(0.0), tip.inverse_radius, PinLanes(1e300));
        farthest = smaller<rigid_lanes>(touching, farthest);
    }
    void store(const RigidCoefficients& c, RigidReaction& to) const noexcept {
        double near = 0.0, far = 1e300;
        for (std::size_t lane = 0; lane < rigid_lanes; ++lane) {
            to.deepest = std::max(to.deepest, deepest[lane]);
            near = std::max(near, nearest[lane]);
            far = std::min(far, farthest[lane]);
        }
        to.innermost = 1.0 / near - c.outward;
        to.outermost = 1.0 / far - c.outward;
    }
};

[[gnu::always_inline]] inline void place_tip(const RigidCoefficients& c, const PinMotion& pin, const HalfMotion& half,
                                             const SheaveSide& sheave, double side, TipPlace& tip) noexcept {
    tip.side = side;
    const double sideways = side * c.radius * c.cosine;
    const Plane sphere = PinLanes(c.outward) * half.outward + PinLanes(side * (c.lever - 1.0)) * pin.end;  // S - E
    tip.arm = pin.middle + half.offset + PinLanes(side) * pin.end + sphere - sheave.centre;
    const PinLanes rise = (pin.z - sheave.z) - c.outward * half.slope_out;
    tip.arm_z = rise - sideways;
    const Plane l{tip.arm.x - sheave.tilt_y * tip.arm_z, tip.arm.y + sheave.tilt_x * tip.arm_z};
    const PinLanes square = dot(l, l), inverse = 1.0 / sqrt(square);
    tip.inverse_radius = inverse;
    tip.radial = inverse * l;
    const PinLanes a = square * inverse - c.touching_radius;
    const PinLanes h = -side * (rise - sheave.tilt_x * tip.arm.y + sheave.tilt_y * tip.arm.x);
    tip.depth = -(c.sine * a + c.cosine * h + 0.5 * c.inverse_reach * (a * a + h * h));
    tip.out = c.sine + c.inverse_reach * a;
    tip.in = c.cosine + c.inverse_reach * h;
    const Plane local = tip.out * tip.radial;
    const PinLanes local_z = -side * tip.in;
    tip.normal = {local.x + sheave.tilt_y * local_z, local.y - sheave.tilt_x * local_z};
    tip.normal_z = local_z + sheave.tilt_x * local.y - sheave.tilt_y * local.x;
    tip.tilting_x = tip.arm.y * local_z - tip.arm_z * local.y;
    tip.tilting_y = tip.arm_z * local.x - tip.arm.x * local_z;
    tip.reach = sphere - PinLanes(c.radius) * tip.normal;
}

/// δ_0' [m/s]. @param lead time by which velocities are ahead of coordinates: until then the normal turns with the pin [s]
[[nodiscard, gnu::always_inline]] inline PinLanes depth_rate(const RigidCoefficients& c, const PinMotion& rate, const HalfMotion& half,
                                                             const SheaveSide& sheave, const TipPlace& tip, double lead) noexcept {
    const Plane moved =
        rate.middle + half.offset_rate + PinLanes(tip.side * c.lever) * rate.end + (c.outward * half.turn) * half.line - sheave.velocity;
    const PinLanes moved_z = rate.z - c.outward * (half.slope_out_rate + half.turn * half.slope_along) - sheave.velocity_z;
    const PinLanes around = cross(tip.radial, moved);
    const PinLanes turning = lead * tip.out * around * around * tip.inverse_radius;
    return sheave.spin_x * tip.tilting_x + sheave.spin_y * tip.tilting_y - dot(tip.normal, moved) - tip.normal_z * moved_z - turning;
}

/// Hertz's contact in series with the axial compliance of half a pin.
struct NormalForce {
    PinLanes elastic, force;  ///< N_e, N [N]
    PinLanes energy;          ///< [J]
    PinLanes shortening;      ///< η: of the half pin per depth
};

/// @param depth δ_0 [m], ≤ 0: no contact   @param rate δ_0' [m/s]
/// @param iterations 1: to 1e-6, where depths are those of a tip under load; 2: to rounding
[[nodiscard, gnu::always_inline]] inline NormalForce normal_force(const RigidCoefficients& c, const PinLanes& depth, const PinLanes& rate,
                                                                  int iterations) noexcept {
    const PinLanes d = positive_part<rigid_lanes>(depth), root = sqrt(d), soft = c.softness * root;
    PinLanes y = root * (1.0 + 0.54 * soft) / (1.0 + 1.04 * soft);  // of y² (1 + b y) = δ_0
    for (int iteration = 0; iteration < iterations; ++iteration) {  // Halley's method
        const PinLanes by = c.softness * y, excess = y * y * (1.0 + by) - d, slope = y * (2.0 + 3.0 * by);
        y -= 2.0 * excess * slope / (2.0 * slope * slope - excess * (2.0 + 6.0 * by) + 1e-60);
    }
    const PinLanes by = c.softness * y, square = y * y;
    NormalForce n;
    n.elastic = c.hertz * square * y;
    n.force = n.elastic * positive_part<rigid_lanes>(1.0 + c.damping * rate);
    n.energy = n.elastic * square * (0.4 + 0.5 * by);
    n.shortening = (1.0 / c.cosine) * (3.0 * by / (2.0 + 3.0 * by));
    return n;
}

/// Sliding velocity along the circumference and along the flank.
struct Slip {
    PinLanes round, flank;
};

/// @param lead time by which velocities are ahead of coordinates [s]
[[nodiscard, gnu::always_inline]] inline Slip tip_slip(const RigidCoefficients& c, const PinMotion& rate, const HalfMotion& half,
                                                       const SheaveSide& sheave, const TipPlace& tip, const PinLanes& shortening_rate,
                                                       double lead) noexcept {
    const Plane end = rate.middle + half.offset_rate + PinLanes(tip.side) * rate.end + half.turn * turned(tip.reach);
    const Plane point = tip.arm - PinLanes(c.radius) * tip.normal;  // of contact, from the sheave's origin
    const PinLanes point_z = tip.arm_z - c.radius * tip.normal_z;
    const Plane surface = sheave.velocity + sheave.spin_z * turned(point + PinLanes(lead) * rate.middle) +
                          Plane{sheave.spin_y * point_z, -(sheave.spin_x * point_z)};
    const PinLanes surface_z = sheave.velocity_z + sheave.spin_x * point.y - sheave.spin_y * point.x;
    const Plane v = end - surface;
    const PinLanes v_z = rate.z - tip.side * shortening_rate - surface_z;
    return {cross(tip.radial, v), tip.in * dot(tip.radial, v) + tip.side * tip.out * v_z};
}

/// A tip's force on its pin: normal force N, which the friction's share of the half pin's shortening adds to, and friction.
struct TipForce {
    PinLanes normal;
    Plane friction;
    PinLanes friction_z;
};

[[nodiscard, gnu::always_inline]] inline TipForce tip_force(const TipPlace& tip, const NormalForce& n, const Slip& friction) noexcept {
    TipForce f;
    f.friction = friction.round * turned(tip.radial) + (friction.flank * tip.in) * tip.radial;
    f.friction_z = tip.side * friction.flank * tip.out;
    f.normal = n.force + tip.side * n.shortening * f.friction_z;
    return f;
}

/// Virtual work of a tip's force on the coordinates of its pin and on the direction of its half.
[[nodiscard, gnu::always_inline]] inline TipForces on_pin(const RigidCoefficients& c, const HalfMotion& half, const TipPlace& tip,
                                                          const TipForce& f) noexcept {
    const Plane push = f.normal * tip.normal;
    const PinLanes push_z = f.normal * tip.normal_z;
    TipForces on;
    on.half = push + f.friction;
    on.z = push_z + f.friction_z;
    on.end = PinLanes(tip.side * c.lever) * push - (c.outward / c.half_length * push_z) * half.outward + PinLanes(tip.side) * f.friction;
    on.moment = c.outward * (dot(push, half.line) - half.slope_along * push_z) + cross(tip.reach, f.friction);
    return on;
}

/// Generalised forces on the sheave: (F_x, F_y, M_τx, M_τy, F_z, M_φ).
[[nodiscard, gnu::always_inline]] inline std::array<PinLanes, 6> on_sheave(const RigidCoefficients& c, const TipPlace& tip,
                                                                           const TipForce& f) noexcept {
    const Plane point = tip.arm - PinLanes(c.radius) * tip.normal;
    const PinLanes point_z = tip.arm_z - c.radius * tip.normal_z;
    return {-(f.normal * tip.normal.x + f.friction.x),
            -(f.normal * tip.normal.y + f.friction.y),
            -(f.normal * tip.tilting_x + point.y * f.friction_z - point_z * f.friction.y),
            -(f.normal * tip.tilting_y + point_z * f.friction.x - point.x * f.friction_z),
            -(f.normal * tip.normal_z + f.friction_z),
            -cross(point, f.friction)};
}

}  // namespace
}  // namespace cvtflow::model
