#pragma once
/// The rolling joint of a pin: the two halves pressed together along a line, friction in the contact, clearance of the plate opening.
/// Lanes run over the integration points of the line. (model/EQUATIONS.md section 5)

#include <cmath>

#include "model/account.hpp"
#include "model/coefficients.hpp"
#include "model/force/plates.hpp"

namespace cvtflow::model {

/// Forces of the joint of pin i. The front half of link i-1 gets `on_front` (and moment `before` on that link),
/// the rear half of link i gets the opposite (and moment `after` on that link).
template <int P>
struct JointForce {
    double x[P + 1], y[P + 1], z, e;  ///< generalized forces [N]
    double before, after;             ///< moments about z on links i-1 and i [N·m]
};

/// What the two halves of a pin have between them: coordinates of L minus coordinates of R, with the arms of both frames in m = 0.
template <int P>
struct Opening {
    double x[P + 1], y[P + 1], z, e;

    Opening(const double* front_of_previous, const double* rear_of_next) noexcept
        : z(front_of_previous[at<P>.z(End::front)] - rear_of_next[at<P>.z(End::rear)]),
          e(front_of_previous[at<P>.e(End::front)] - rear_of_next[at<P>.e(End::rear)]) {
        for (int m = 0; m <= P; ++m) {
            x[m] = front_of_previous[at<P>.x(End::front, m)] - rear_of_next[at<P>.x(End::rear, m)];
            y[m] = front_of_previous[at<P>.y(End::front, m)] - rear_of_next[at<P>.y(End::rear, m)];
        }
    }
};

/// Elastic normal force and its energy over lanes.
template <int W>
struct Contact {
    Lanes<W> elastic;  ///< N_e [N]
    Lanes<W> energy;   ///< [J]
};

template <int W>
[[nodiscard]] inline Contact<W> line_contact(const JointCoefficients& j, const Lanes<W>& weight, const Lanes<W>& depth) noexcept {
    const Lanes<W> pressed = positive_part<W>(depth);
    if (!j.palmgren) {
        const Lanes<W> elastic = j.stiffness * weight * pressed;
        return {elastic, 0.5 * elastic * pressed};
    }
    const Lanes<W> elastic = j.stiffness * j.reference_depth * weight * Lanes<W>([&](auto lane) { return std::pow(pressed[lane] / j.reference_depth, 10.0 / 9.0); });
    return {elastic, (9.0 / 19.0) * elastic * pressed};
}

/// Bisector of two link directions.
struct Bisector {
    double x, y;
    Bisector(const LinkFrame& before, const LinkFrame& after) noexcept : x(before.tx + after.tx), y(before.ty + after.ty) {
        const double inverse = 1.0 / std::sqrt(x * x + y * y);
        x *= inverse;
        y *= inverse;
    }
};

/// One chunk of W integration points of the joint between link `before` and link `after`; adds to `out`.
template <int P, int W, bool Observe>
inline void joint_chunk(const Coefficients& c, const LinkFrame& before, const LinkFrame& after, const Bisector& b, const Opening<P>& gap,
                        const Opening<P>& rate, JointForce<P>& out, Account* account) noexcept {
    using V = Lanes<W>;
    const auto& j = c.joint;
    V basis[P + 1];
    for (int m = 1; m <= P; ++m) basis[m] = load<W>(c.joint_points.basis[static_cast<std::size_t>(m)].data());
    const V xi = load<W>(c.joint_points.position.data());
    const V weight = load<W>(c.joint_points.weight.data());

    // Centres of the two arcs: Δ = C_L - C_R, and the relative velocity of the axes.
    const V gx = along_axis<P, W>(gap.x, basis), gy = along_axis<P, W>(gap.y, basis);
    const double sx = before.tx + after.tx, sy = before.ty + after.ty, cx = before.tx - after.tx, cy = before.ty - after.ty;
    const V dx = gx + j.arm * sx, dy = gy + j.arm * sy;
    const V ax = along_axis<P, W>(rate.x, basis), ay = along_axis<P, W>(rate.y, basis);
    const V distance = sqrt(dx * dx + dy * dy);
    const V inverse = V(1.0) / distance;
    const V nx = dx * inverse, ny = dy * inverse;
    const V vx = ax - j.arm * (before.turning * before.ty + after.turning * after.ty), vy = ay + j.arm * (before.turning * before.tx + after.turning * after.tx);

    const V closing = -(nx * vx + ny * vy);
    // δ = 2ρ - |Δ| = (4ρ² - |Δ|²)/(2ρ + |Δ|), the squares multiplied out so that the depth (µm) does not drown in the rounding of ρ (cm).
    const V depth = (j.square_excess - (gx * gx + gy * gy) - 2.0 * j.arm * (gx * sx + gy * sy) + j.arm * j.arm * (cx * cx + cy * cy)) / (j.diameter + distance);
    const auto contact = line_contact<W>(j, weight, depth);
    const V normal = positive_part<W>(contact.elastic * (1.0 + j.damping * closing));

    // Slip at the contact point; lever of each link's turning along the tangent k×ν.
    const V lever_before = j.arm * (before.tx * nx + before.ty * ny) - 0.5 * distance, lever_after = j.arm * (after.tx * nx + after.ty * ny) - 0.5 * distance;
    const V slip = nx * ay - ny * ax + before.turning * lever_before + after.turning * lever_after;
    const V axial = rate.z + xi * rate.e;
    const V speed = sqrt(slip * slip + axial * axial);
    const V grip = j.friction.coefficient * normal * slip_factor<W>(j.friction, speed);
    const V tangential = -grip * slip, axial_force = -grip * axial;

    // Clearance of the opening: transverse offset of the arc centres against the bisector.
    const V across = dy * b.x - dx * b.y, along = dx * b.x + dy * b.y;
    const V offset = positive_part<W>(across - j.clearance) - positive_part<W>(-across - j.clearance);
    const V offset_rate = vy * b.x - vx * b.y - 0.5 * (before.turning + after.turning) * along;
    const V sign = select<W>(across < 0.0, V(-1.0), V(1.0));
    const V spring = j.clearance_stiffness * weight * offset;
    const V opening = spring * positive_part<W>(1.0 + j.clearance_damping * sign * offset_rate);

    const V fx = normal * nx - tangential * ny + opening * b.y, fy = normal * ny + tangential * nx - opening * b.x;
    out.x[0] += sum<W>(fx);
    out.y[0] += sum<W>(fy);
    for (int m = 1; m <= P; ++m) {
        out.x[m] += sum<W>(fx * basis[m]);
        out.y[m] += sum<W>(fy * basis[m]);
    }
    out.z += sum<W>(axial_force);
    out.e += sum<W>(axial_force * xi);
    out.before += sum<W>(j.arm * normal * (before.tx * ny - before.ty * nx) + tangential * lever_before -
                         opening * (j.arm * (before.tx * b.x + before.ty * b.y) - 0.5 * along));
    out.after += sum<W>(j.arm * normal * (after.tx * ny - after.ty * nx) + tangential * lever_after -
                        opening * (j.arm * (after.tx * b.x + after.ty * b.y) - 0.5 * along));
    if constexpr (Observe) {
        account->store(Energy::joints, sum<W>(contact.energy) + 0.5 * sum<W>(spring * offset));
        account->lose(Loss::joint_damping, sum<W>((normal - contact.elastic) * closing + (opening - spring) * offset_rate));
        account->lose(Loss::joint_friction, sum<W>(grip * speed * speed));
    }
}

/// The joint between the front half of the link with coordinates q_before and the rear half of the one with q_after.
template <int P, int W, bool Observe>
inline void joint(const Coefficients& c, const LinkFrame& before, const LinkFrame& after, const double* q_before, const double* v_before,
                  const double* q_after, const double* v_after, JointForce<P>& out, Account* account) noexcept {
    out = {};
    joint_chunk<P, W, Observe>(c, before, after, Bisector(before, after), Opening<P>(q_before, q_after), Opening<P>(v_before, v_after), out, account);
}

}  // namespace cvtflow::model
