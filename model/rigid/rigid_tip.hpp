#pragma once
/// One tip of rigid pins side by side: place on its sheave, normal force, sliding velocity, and effect on both bodies.
/// (model/EQUATIONS.md section 11)

#include <algorithm>
#include <array>

#include "model/rigid/tip_motion.hpp"

namespace cvtflow::model {
namespace {

template <int W>
struct TipPlace {
    PlaneOf<W> point;  ///< P - O
    Lanes<W> point_z;
    Lanes<W> inverse_radius;  ///< inverse distance of the sphere's centre from the axis [1/m]
    PlaneOf<W> radial;        ///< unit vector from the axis to the sphere's centre, in the sheave's frame
    Lanes<W> out, in;         ///< ν_r, ν_z: components of the normal, outward and towards the other sheave
    Lanes<W> out_z;           ///< out at +z, the opposite at -z: component along z of the flank's direction
    PlaneOf<W> normal;        ///< G
    Lanes<W> normal_z;
    PlaneOf<W> reach;               ///< P - E
    Lanes<W> depth;                 ///< δ_0 [m]
    Lanes<W> tilting_x, tilting_y;  ///< (r×ν): depth per tilt of the sheave [m]
};

/// Extremes of all tips: depth, inverse radius of the spheres' centres, that of tips that touch.
template <int W>
struct TipBounds {
    Lanes<W> deepest{-1e30}, nearest{0.0}, farthest{1e30};

    void add(const TipPlace<W>& tip) noexcept {
        deepest = larger<W>(tip.depth, deepest);
        nearest = larger<W>(tip.inverse_radius, nearest);
        const Lanes<W> touching = select_greater<W>(tip.depth, Lanes<W>(0.0), tip.inverse_radius, Lanes<W>(1e30));
        farthest = smaller<W>(touching, farthest);
    }
    void store(const RigidCoefficients& c, RigidReaction& to) const noexcept {
        std::array<NumberOf<W>, lane_count<W>> all;
        const auto most = [&](const Lanes<W>& lanes) -> double {
            return lanes.copy_to(all.data()), *std::max_element(all.begin(), all.end());
        };
        to.deepest = most(deepest);
        to.innermost = 1.0 / most(nearest) - c.outward;
        to.outermost = -1.0 / most(-farthest) - c.outward;
    }
};

/// Place, normal and depth. A depth is a difference of lengths a thousand times as large: the distances of half and end from the flank are
/// doubles, and the tip's part of them is small.
template <int W>
[[gnu::always_inline]] inline void place_tip(const TipNumbers<W>& n, const HalfMotion<W>& half, const SideMotion<W>& sheave,
                                             TipPlace<W>& tip) noexcept {
    const PlaneOf<W> arm = half.centre + sheave.arm;
    const Lanes<W> sunk = half.rise + sheave.side * half.bend_rise;
    const Lanes<W> arm_z = sheave.z - sunk;
    const PlaneOf<W> moved{sheave.arm.x - sheave.tilt_y * arm_z, sheave.arm.y + sheave.tilt_x * arm_z}, l = half.centre + moved;
    const Lanes<W> distance = sqrt(dot(l, l)), sum = distance + half.distance, inverse = 1.0 / (distance * sum);
    const Lanes<W> more_a = dot(moved, half.centre + l) * (distance * inverse);  // |l| - |centre|
    const Lanes<W> more_h = sheave.side * (sunk + sheave.tilt_x * arm.y - sheave.tilt_y * arm.x);
    const Lanes<W> a = half.excess + more_a, h = sheave.height + more_h;
    const Lanes<W> bent_a = n.inverse_reach * a, bent_h = n.inverse_reach * h;
    tip.depth =
        Lanes<W>(-0.5) * (bent_a * a + bent_h * h) - (n.sine * more_a + n.cosine * more_h) - convert<W>(half.clearance + sheave.clearance);
    tip.inverse_radius = sum * inverse;
    tip.radial = tip.inverse_radius * l;
    tip.out = n.sine + bent_a;
    tip.in = n.cosine + bent_h;
    tip.out_z = sheave.side * tip.out;
    const PlaneOf<W> local = tip.out * tip.radial;
    const Lanes<W> local_z = -sheave.side * tip.in;
    tip.normal = {local.x + sheave.tilt_y * local_z, local.y - sheave.tilt_x * local_z};
    tip.normal_z = local_z + sheave.tilt_x * local.y - sheave.tilt_y * local.x;
    tip.tilting_x = arm.y * local_z - arm_z * local.y;
    tip.tilting_y = arm_z * local.x - arm.x * local_z;
    const PlaneOf<W> inwards = n.radius * tip.normal;
    tip.point = arm - inwards;
    tip.point_z = arm_z - n.radius * tip.normal_z;
    tip.reach = half.sphere + sheave.sphere - inwards;
}

/// δ_0' [m/s]. @param lead time by which velocities are ahead of coordinates: until then the normal turns with the pin [s]
template <int W>
[[nodiscard, gnu::always_inline]] inline Lanes<W> depth_rate(const HalfMotion<W>& half, const SideMotion<W>& sheave, const TipPlace<W>& tip,
                                                             const Lanes<W>& lead) noexcept {
    const PlaneOf<W> moved = half.velocity + sheave.sphere_velocity;
    const Lanes<W> moved_z = sheave.velocity_z - half.rise_rate - sheave.side * half.bend_rise_rate;
    const Lanes<W> around = cross(tip.radial, moved);
    const Lanes<W> turning = lead * tip.out * (around * around) * tip.inverse_radius;
    return sheave.spin_x * tip.tilting_x + sheave.spin_y * tip.tilting_y - dot(tip.normal, moved) - tip.normal_z * moved_z - turning;
}

/// Hertz's contact in series with the axial compliance of half a pin.
template <int W>
struct RigidNormalForce {
    Lanes<W> elastic, force;  ///< N_e, N [N]
    Lanes<W> energy;          ///< [J]
    Lanes<W> shortening;      ///< η: shortening of the half pin per depth
    Lanes<W> root_depth;      ///< √δ of Hertz' part of the depth [√m]
};

/// y = √δ_0 φ with φ² (1 + u φ) = 1, u = b √δ_0: a rational start p/q, to 1e-4 for u ≤ `well_started_softness`, and Newton's method. The
/// division of its first step is that of η as well, which is therefore known as well as the start; a right-hand side takes two further
/// steps, which leave rounding of both.
/// @param depth δ_0 [m], ≤ 0: no contact   @param rate δ_0' [m/s]
template <int W>
[[gnu::always_inline]] inline void rigid_normal_force(const TipNumbers<W>& c, const Lanes<W>& depth, const Lanes<W>& rate,
                                                      RigidNormalForce<W>& n) noexcept {
    const Lanes<W> root = sqrt(positive_part<W>(depth)), u = c.softness * root;
    const Lanes<W> p = 1.0 + u * (1.33761 + 0.1541 * u), q = 1.0 + u * (1.83676 + 0.46388 * u);
    const Lanes<W> up = u * p, pq = p * q, inverse = 1.0 / (pq * (2.0 * q + 3.0 * up));
    Lanes<W> phi = (p * p * (q + 2.0 * up) + q * q * q) * inverse, yielding = 3.0 * up * pq * inverse;
    for (int step = 0; step < c.further_steps; ++step) {
        const Lanes<W> by = u * phi, slope = 2.0 + 3.0 * by;
        phi = (phi * phi * (1.0 + 2.0 * by) + 1.0) / (phi * slope);
        yielding = 3.0 * by / slope;
    }
    const Lanes<W> y = root * phi, square = y * y;
    n.root_depth = y;
    n.elastic = c.hertz * square * y;
    n.force = n.elastic * positive_part<W>(1.0 + c.damping * rate);
    n.energy = n.elastic * square * (0.4 + 0.5 * (u * phi));
    n.shortening = c.per_cosine * yielding;
}

/// Sliding velocity or friction along the circumference and along the flank (radially).
template <int W>
struct RigidSlip {
    Lanes<W> tangential, radial;
    friend RigidSlip operator+(const RigidSlip& a, const RigidSlip& b) noexcept {
        return {a.tangential + b.tangential, a.radial + b.radial};
    }
    friend RigidSlip operator-(const RigidSlip& a, const RigidSlip& b) noexcept {
        return {a.tangential - b.tangential, a.radial - b.radial};
    }
    friend RigidSlip operator*(const Lanes<W>& f, const RigidSlip& a) noexcept { return {f * a.tangential, f * a.radial}; }
};

/// Components along circumference and flank of a velocity of the pin against the sheave.
template <int W>
[[nodiscard, gnu::always_inline]] inline RigidSlip<W> slip_of(const TipPlace<W>& tip, const PlaneOf<W>& v, const Lanes<W>& v_z) noexcept {
    return {cross(tip.radial, v), tip.in * dot(tip.radial, v) + tip.out_z * v_z};
}

/// Sliding velocity. The sphere's centre moves almost like the sheave there: the difference is taken in doubles.
/// @param shortening_rate of the half pin [m/s]
template <int W>
[[nodiscard, gnu::always_inline]] inline RigidSlip<W> tip_slip(const TipNumbers<W>& c, const HalfMotion<W>& half,
                                                               const SideMotion<W>& sheave, const TipPlace<W>& tip,
                                                               const Lanes<W>& shortening_rate) noexcept {
    const PlaneOf<W> centre = half.drift + sheave.velocity - sheave.faster * turned(half.centre);
    const PlaneOf<W> spinning = turned(half.turn * sheave.sphere + (c.radius * (half.lag + sheave.faster)) * tip.normal);
    const PlaneOf<W> v = centre + spinning - PlaneOf<W>{sheave.spin_y * tip.point_z, -(sheave.spin_x * tip.point_z)};
    const Lanes<W> surface_z = sheave.spin_x * tip.point.y - sheave.spin_y * tip.point.x;
    return slip_of<W>(tip, v, sheave.velocity_z + half.ahead - sheave.side * shortening_rate - surface_z);
}

/// Force of a tip on its pin: friction, and the normal force N_G, which includes the effect of friction on the half pin's shortening.
template <int W>
struct RigidTipForce {
    Lanes<W> normal;
    PlaneOf<W> push, friction;
    Lanes<W> push_z, friction_z;
};

/// @param normal N [N]   @param shortening η   @param pull Λ/4: a tip's part of the plates' force that lengthens the pin [N]
template <int W>
[[nodiscard, gnu::always_inline]] inline RigidTipForce<W> rigid_tip_force(const TipPlace<W>& tip, const Lanes<W>& normal,
                                                                          const Lanes<W>& shortening, const Lanes<W>& pull,
                                                                          const RigidSlip<W>& friction) noexcept {
    RigidTipForce<W> f;
    f.friction = friction.tangential * turned(tip.radial) + (friction.radial * tip.in) * tip.radial;
    f.friction_z = friction.radial * tip.out_z;
    f.normal = normal + shortening * (friction.radial * tip.out + pull);
    f.push = f.normal * tip.normal;
    f.push_z = f.normal * tip.normal_z;
    return f;
}

/// A tip and its force.
template <int W>
struct PressedTip {
    const TipPlace<W>& place;
    const HalfMotion<W>& half;
    RigidTipForce<W> force;
};

/// Generalised forces of tips on pins, and on the pitch lines of their halves.
template <int W>
struct RigidTipForces {
    PlaneOf<W> half[2] = {{0.0, 0.0}, {0.0, 0.0}};
    PlaneOf<W> end{0.0, 0.0}, bend{0.0, 0.0};
    Lanes<W> z[2] = {0.0, 0.0}, moment[2] = {0.0, 0.0};

    /// Virtual work of the forces of both tips at an end on the coordinates of their pin. @param of those of the front, the rear half
    [[gnu::always_inline]] void add(const TipNumbers<W>& c, const Lanes<W>& side, const PressedTip<W> (&of)[2]) noexcept {
        const RigidTipForce<W>&front = of[0].force, &rear = of[1].force;
        half[0] = half[0] + (front.push + front.friction);
        half[1] = half[1] + (rear.push + rear.friction);
        z[0] += front.push_z + front.friction_z;
        z[1] += rear.push_z + rear.friction_z;
        const PlaneOf<W> push = front.push + rear.push, friction = front.friction + rear.friction,
                         tilting = front.push_z * of[0].half.outward + rear.push_z * of[1].half.outward;
        end = end + side * (c.lever * push + friction) - c.outward_per_half * tilting;
        bend = bend + (c.bend_lever * push + friction) - (side * c.bent_outward_per_half) * tilting;
    }
    /// The work on the directions of both halves.
    [[gnu::always_inline]] void add_moments(const TipNumbers<W>& c, const Lanes<W>& side, const PressedTip<W> (&of)[2]) noexcept {
        for (std::size_t k = 0; k < 2; ++k) {
            const HalfMotion<W>& on = of[k].half;
            const RigidTipForce<W>& f = of[k].force;
            const Lanes<W> slope = on.slope_along + side * on.bend_along;
            moment[k] += c.outward * (dot(f.push, on.line) - slope * f.push_z) + cross(of[k].place.reach, f.friction);
        }
    }
};

/// Adds the opposite of the generalised forces on the sheave: (F_x, F_y, M_τx, M_τy, F_z, M_φ).
template <int W>
[[gnu::always_inline]] inline void add_on_sheave(const TipPlace<W>& tip, const RigidTipForce<W>& f, std::array<Lanes<W>, 6>& to) noexcept {
    to[0] += f.push.x + f.friction.x;
    to[1] += f.push.y + f.friction.y;
    to[2] += f.normal * tip.tilting_x + tip.point.y * f.friction_z - tip.point_z * f.friction.y;
    to[3] += f.normal * tip.tilting_y + tip.point_z * f.friction.x - tip.point.x * f.friction_z;
    to[4] += f.push_z + f.friction_z;
    to[5] += cross(tip.point, f.friction);
}

}  // namespace
}  // namespace cvtflow::model
