#pragma once
/// One tip of rigid pins side by side: where it is on its sheave, its normal force, its sliding velocity and what it does to both.
/// (model/EQUATIONS.md section 11)

#include <algorithm>

#include "model/force/sheave_motion.hpp"
#include "model/variator/rigid/rigid_coefficients.hpp"
#include "model/variator/rigid/rigid_vectors.hpp"

namespace cvtflow::model {
namespace {

/// Number of a tip as a type: 0 and 1 are the front half's at -z and +z, 2 and 3 the rear half's.
template <std::size_t number>
struct Tip {
    static constexpr std::size_t half = number / 2, end = number % 2;
    static constexpr int side = end == 0 ? -1 : 1, column = static_cast<int>(number);
    constexpr operator std::size_t() const noexcept { return number; }
};

/// Calls act(Tip<number>()) for each tip.
template <class Act>
[[gnu::always_inline]] inline void for_tips(const Act& act) noexcept {
    act(Tip<0>());
    act(Tip<1>());
    act(Tip<2>());
    act(Tip<3>());
}

/// A pin half, and what it gives to the motion of its tips.
struct HalfMotion {
    Plane line, outward;       ///< t and o of its pitch line
    PinLanes turn;             ///< θ' [rad/s]
    PinLanes slope_along;      ///< σ·t [rad]
    Plane sphere, centre;      ///< R_p sin β o: alone, and from the origin
    Plane velocity;            ///< of the half's middle
    Plane sphere_velocity;     ///< with that of R_p sin β o
    PinLanes rise, rise_rate;  ///< R_p sin β σ·o, and without the change of σ·t [m], [m/s]
};

/// The sheaves of one side as pins side by side see them, and what that end of the pins gives to the motion of its tips.
struct SideMotion {
    Plane arm, sphere;        ///< of a sphere's centre without its half: from the sheave's origin, and against the pin's end
    PinLanes z;               ///< from where the undisplaced flank plane is [m]
    PinLanes tilt_x, tilt_y;  ///< [rad]
    Plane velocity;           ///< of the pin's end against the sheave, without what spins
    Plane sphere_velocity;    ///< the same of a sphere's centre
    PinLanes velocity_z;      ///< [m/s]
    PinLanes spin_x, spin_y, spin_z;
};

/// v on side +z, -v on side -z.
template <int side>
[[nodiscard, gnu::always_inline]] inline PinLanes outwards(const PinLanes& v) noexcept {
    if constexpr (side > 0) {
        return v;
    } else {
        return -v;
    }
}

/// Coordinates or velocities of pins.
struct PinMotion {
    Plane middle, end;
    PinLanes z;
};

struct TipPlace {
    Plane point;  ///< P - O
    PinLanes point_z;
    PinLanes inverse_radius;  ///< of the sphere's centre [1/m]
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

/// @tparam side ±1
template <int side>
[[gnu::always_inline]] inline void place_tip(const RigidCoefficients& c, const HalfMotion& half, const SideMotion& sheave,
                                             TipPlace& tip) noexcept {
    const Plane arm = half.centre + sheave.arm;  // r = S - O
    const PinLanes rise = sheave.z - half.rise, arm_z = rise - side * c.radius * c.cosine;
    const Plane l{arm.x - sheave.tilt_y * arm_z, arm.y + sheave.tilt_x * arm_z};
    const PinLanes square = dot(l, l);
    tip.inverse_radius = 1.0 / sqrt(square);
    tip.radial = tip.inverse_radius * l;
    const PinLanes a = square * tip.inverse_radius - c.touching_radius;
    const PinLanes h = outwards<-side>(rise - sheave.tilt_x * arm.y + sheave.tilt_y * arm.x);
    tip.out = c.sine + c.inverse_reach * a;
    tip.in = c.cosine + c.inverse_reach * h;
    tip.depth = PinLanes(-0.5) * (a * (c.sine + tip.out) + h * (c.cosine + tip.in));
    const Plane local = tip.out * tip.radial;
    const PinLanes local_z = outwards<-side>(tip.in);
    tip.normal = {local.x + sheave.tilt_y * local_z, local.y - sheave.tilt_x * local_z};
    tip.normal_z = local_z + sheave.tilt_x * local.y - sheave.tilt_y * local.x;
    tip.tilting_x = arm.y * local_z - arm_z * local.y;
    tip.tilting_y = arm_z * local.x - arm.x * local_z;
    const Plane inwards = PinLanes(c.radius) * tip.normal;
    tip.point = arm - inwards;
    tip.point_z = arm_z - c.radius * tip.normal_z;
    tip.reach = half.sphere + sheave.sphere - inwards;
}

/// δ_0' [m/s]. @param lead time by which velocities are ahead of coordinates: until then the normal turns with the pin [s]
[[nodiscard, gnu::always_inline]] inline PinLanes depth_rate(const HalfMotion& half, const SideMotion& sheave, const TipPlace& tip,
                                                             const PinLanes& lead) noexcept {
    const Plane moved = half.sphere_velocity + sheave.sphere_velocity;
    const PinLanes moved_z = sheave.velocity_z - half.rise_rate;
    const PinLanes around = cross(tip.radial, moved);
    const PinLanes turning = lead * tip.out * (around * around) * tip.inverse_radius;
    return sheave.spin_x * tip.tilting_x + sheave.spin_y * tip.tilting_y - dot(tip.normal, moved) - tip.normal_z * moved_z - turning;
}

/// Hertz's contact in series with the axial compliance of half a pin.
struct NormalForce {
    PinLanes elastic, force;  ///< N_e, N [N]
    PinLanes energy;          ///< [J]
    PinLanes shortening;      ///< η: of the half pin per depth
    PinLanes root_depth;      ///< √δ of Hertz' part of the depth [√m]
};

/// y = √δ_0 φ with φ² (1 + u φ) = 1, u = b √δ_0: a rational start p/q, to 1e-4 for u ≤ `well_started_softness`, and Newton's method. The
/// division of its first step is that of η as well, which is therefore known as well as the start.
/// @param depth δ_0 [m], ≤ 0: no contact   @param rate δ_0' [m/s]   @param further steps of Newton's method behind the first
[[nodiscard, gnu::always_inline]] inline NormalForce normal_force(const RigidCoefficients& c, const PinLanes& depth, const PinLanes& rate,
                                                                  int further) noexcept {
    const PinLanes root = sqrt(positive_part<rigid_lanes>(depth)), u = c.softness * root;
    const PinLanes p = 1.0 + u * (1.33761 + 0.1541 * u), q = 1.0 + u * (1.83676 + 0.46388 * u);
    const PinLanes up = u * p, pq = p * q, inverse = 1.0 / (pq * (2.0 * q + 3.0 * up));
    PinLanes phi = (p * p * (q + 2.0 * up) + q * q * q) * inverse, yielding = 3.0 * up * pq * inverse;
    for (int step = 0; step < further; ++step) {
        const PinLanes by = u * phi, slope = 2.0 + 3.0 * by;
        phi = (phi * phi * (1.0 + 2.0 * by) + 1.0) / (phi * slope);
        yielding = 3.0 * by / slope;
    }
    const PinLanes y = root * phi, square = y * y;
    NormalForce n;
    n.root_depth = y;
    n.elastic = c.hertz * square * y;
    n.force = n.elastic * positive_part<rigid_lanes>(1.0 + c.damping * rate);
    n.energy = n.elastic * square * (0.4 + 0.5 * (u * phi));
    n.shortening = (1.0 / c.cosine) * yielding;
    return n;
}

/// Sliding velocity along the circumference and along the flank.
struct Slip {
    PinLanes round, flank;
    friend Slip operator+(const Slip& a, const Slip& b) noexcept { return {a.round + b.round, a.flank + b.flank}; }
    friend Slip operator-(const Slip& a, const Slip& b) noexcept { return {a.round - b.round, a.flank - b.flank}; }
    friend Slip operator*(const PinLanes& f, const Slip& a) noexcept { return {f * a.round, f * a.flank}; }
};

/// Sliding velocity that a velocity of the pin against the sheave is.
template <int side>
[[nodiscard, gnu::always_inline]] inline Slip slip_of(const TipPlace& tip, const Plane& v, const PinLanes& v_z) noexcept {
    return {cross(tip.radial, v), tip.in * dot(tip.radial, v) + outwards<side>(tip.out * v_z)};
}

/// @param shortening_rate of the half pin [m/s]
template <int side>
[[nodiscard, gnu::always_inline]] inline Slip tip_slip(const HalfMotion& half, const SideMotion& sheave, const TipPlace& tip,
                                                       const PinLanes& shortening_rate) noexcept {
    const Plane spinning = turned(half.turn * tip.reach - sheave.spin_z * tip.point);
    const Plane v = half.velocity + sheave.velocity + spinning - Plane{sheave.spin_y * tip.point_z, -(sheave.spin_x * tip.point_z)};
    const PinLanes surface_z = sheave.spin_x * tip.point.y - sheave.spin_y * tip.point.x;
    return slip_of<side>(tip, v, sheave.velocity_z - outwards<side>(shortening_rate) - surface_z);
}

/// A tip's force on its pin: normal force, which the friction's share of the half pin's shortening adds to, and friction.
struct TipForce {
    PinLanes normal;
    Plane push, friction;
    PinLanes push_z, friction_z;
};

template <int side>
[[nodiscard, gnu::always_inline]] inline TipForce tip_force(const TipPlace& tip, const NormalForce& n, const Slip& friction) noexcept {
    TipForce f;
    f.friction = friction.round * turned(tip.radial) + (friction.flank * tip.in) * tip.radial;
    f.friction_z = outwards<side>(friction.flank * tip.out);
    f.normal = n.force + n.shortening * outwards<side>(f.friction_z);
    f.push = f.normal * tip.normal;
    f.push_z = f.normal * tip.normal_z;
    return f;
}

/// Generalised forces of tips on pins, and on the pitch lines of their halves.
struct TipForces {
    Plane half[2] = {{0.0, 0.0}, {0.0, 0.0}};
    Plane end{0.0, 0.0};
    PinLanes z{0.0}, moment[2] = {0.0, 0.0};

    /// Virtual work of a tip's force on the coordinates of its pin and on the direction of its half.
    template <int side>
    [[gnu::always_inline]] void add(const RigidCoefficients& c, const HalfMotion& on, std::size_t which, const TipPlace& tip,
                                    const TipForce& f) noexcept {
        half[which] = half[which] + (f.push + f.friction);
        z += f.push_z + f.friction_z;
        const Plane at_end = PinLanes(c.lever) * f.push + f.friction;
        end = (side > 0 ? end + at_end : end - at_end) - (c.outward / c.half_length * f.push_z) * on.outward;
        moment[which] += c.outward * (dot(f.push, on.line) - on.slope_along * f.push_z) + cross(tip.reach, f.friction);
    }
};

/// Adds the opposite of the generalised forces on the sheave: (F_x, F_y, M_τx, M_τy, F_z, M_φ).
[[gnu::always_inline]] inline void add_on_sheave(const TipPlace& tip, const TipForce& f, std::array<PinLanes, 6>& to) noexcept {
    to[0] += f.push.x + f.friction.x;
    to[1] += f.push.y + f.friction.y;
    to[2] += f.normal * tip.tilting_x + tip.point.y * f.friction_z - tip.point_z * f.friction.y;
    to[3] += f.normal * tip.tilting_y + tip.point_z * f.friction.x - tip.point.x * f.friction_z;
    to[4] += f.push_z + f.friction_z;
    to[5] += cross(tip.point, f.friction);
}

}  // namespace
}  // namespace cvtflow::model
