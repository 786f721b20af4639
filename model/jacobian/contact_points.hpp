#pragma once
/// Forces at single points - a plate, a point of a joint, a tip - in any number type, for their derivatives. The same formulas as the
/// kernels of model/force, lane by lane; a test holds their values against each other. (model/EQUATIONS.md sections 4 to 6)

#include "model/basis/dual_lanes.hpp"
#include "model/law/friction.hpp"
#include "model/machine/coefficients.hpp"

namespace cvtflow::model {
namespace {

/// 1/a.
template <class T>
[[nodiscard]] inline T inverse(const T& a) noexcept {
    return 1.0 / a;
}

template <class T>
struct Force3 {
    T x, y, z;
};

/// Force of one plate on the front half. d, v: difference of the halves and its rate. free_length [m]
template <class T>
[[nodiscard]] inline Force3<T> plate_force(const Coefficients& c, double free_length, std::size_t plate, const Force3<T>& d,
                                           const Force3<T>& v) noexcept {
    const T length = sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
    const T reciprocal = inverse(length);
    const T stretching = (d.x * v.x + d.y * v.y + d.z * v.z) * reciprocal;
    const T tension = c.plates.weight[plate] * (length - free_length) + c.plates.damping[plate] * stretching;
    const T slide = c.plate_friction.coefficient * (positive_part(tension) * slip_factor_of_square(c.plate_friction, v.z * v.z) * v.z);
    const T along = tension * reciprocal;
    return {-(along * d.x), -(along * d.y), -(along * d.z) - slide};
}

/// What a point of a joint depends on.
template <class T>
struct JointPoint {
    T gx, gy;      ///< front half of the link before minus rear half of the link after [m]
    T ax, ay, az;  ///< its rate [m/s]
    T before_x, before_y, before_turning, after_x, after_y, after_turning;  ///< directions of the links, and their turning
};

/// What it does: force on the front half of the link before, moments on both links.
template <class T>
struct JointEffect {
    T fx, fy, fz, before, after;
};

template <class T>
struct JointContact {
    T dx, dy, distance, nx, ny, depth, vx, vy, lever_before, lever_after, slip;

    JointContact(const JointCoefficients& j, const JointPoint<T>& p) noexcept {
        const T sx = p.before_x + p.after_x, sy = p.before_y + p.after_y, cx = p.before_x - p.after_x, cy = p.before_y - p.after_y;
        dx = p.gx + j.arm * sx;
        dy = p.gy + j.arm * sy;
        distance = sqrt(dx * dx + dy * dy);
        const T reciprocal = inverse(distance);
        nx = dx * reciprocal;
        ny = dy * reciprocal;
        depth =
            (j.square_excess - (p.gx * p.gx + p.gy * p.gy) - 2.0 * j.arm * (p.gx * sx + p.gy * sy) + j.arm * j.arm * (cx * cx + cy * cy)) *
            inverse(distance + j.diameter);
        vx = p.ax - j.arm * (p.before_turning * p.before_y + p.after_turning * p.after_y);
        vy = p.ay + j.arm * (p.before_turning * p.before_x + p.after_turning * p.after_x);
        lever_before = j.arm * (p.before_x * nx + p.before_y * ny) - 0.5 * distance;
        lever_after = j.arm * (p.after_x * nx + p.after_y * ny) - 0.5 * distance;
        slip = nx * p.ay - ny * p.ax + p.before_turning * lever_before + p.after_turning * lever_after;
    }
};

/// Rolling contact with friction. weight [1]
template <class T>
inline void add_press(const JointCoefficients& j, double weight, const JointPoint<T>& p, const JointContact<T>& m,
                      JointEffect<T>& out) noexcept {
    const T closing = -(m.nx * m.vx + m.ny * m.vy);
    const T pressed = positive_part(m.depth);
    const T elastic = j.palmgren ? j.stiffness * j.reference_depth * weight * ten_ninths(pressed * (1.0 / j.reference_depth))
                                 : j.stiffness * weight * pressed;
    const T normal = positive_part(elastic * (1.0 + j.damping * closing));
    const T grip = j.friction.coefficient * (normal * slip_factor_of_square(j.friction, m.slip * m.slip + p.az * p.az));
    const T tangential = -(grip * m.slip);
    out.fx += normal * m.nx - tangential * m.ny;
    out.fy += normal * m.ny + tangential * m.nx;
    out.fz -= grip * p.az;
    const T leaning = j.arm * normal;
    out.before += leaning * (p.before_x * m.ny - p.before_y * m.nx) + tangential * m.lever_before;
    out.after += leaning * (p.after_x * m.ny - p.after_y * m.nx) + tangential * m.lever_after;
}

/// Clearance of the plate opening. weight [1]
template <class T>
inline void add_confinement(const JointCoefficients& j, double weight, const JointPoint<T>& p, const JointContact<T>& m,
                            JointEffect<T>& out) noexcept {
    const T sx = p.before_x + p.after_x, sy = p.before_y + p.after_y;
    const T reciprocal = inverse(sqrt(sx * sx + sy * sy));
    const T bx = sx * reciprocal, by = sy * reciprocal;
    const T across = m.dy * bx - m.dx * by;
    if (std::abs(across.value) <= j.clearance) return;
    const T along = m.dx * bx + m.dy * by;
    const double sign = across.value > 0.0 ? 1.0 : -1.0;
    const T rate = m.vy * bx - m.vx * by - 0.5 * ((p.before_turning + p.after_turning) * along);
    const T force =
        j.clearance_stiffness * weight * ((across - sign * j.clearance) * positive_part(1.0 + j.clearance_damping * sign * rate));
    out.fx += force * by;
    out.fy -= force * bx;
    out.before -= force * (j.arm * (p.before_x * bx + p.before_y * by) - 0.5 * along);
    out.after -= force * (j.arm * (p.after_x * bx + p.after_y * by) - 0.5 * along);
}

/// weight [1]
template <class T>
[[nodiscard]] inline JointEffect<T> joint_effect(const JointCoefficients& j, double weight, const JointPoint<T>& point) noexcept {
    const JointContact<T> contact(j, point);
    JointEffect<T> effect{};
    add_press(j, weight, point, contact, effect);
    add_confinement(j, weight, point, contact, effect);
    return effect;
}

}  // namespace
}  // namespace cvtflow::model
