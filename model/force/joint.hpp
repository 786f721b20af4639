#pragma once
/// The rolling joint of a pin: the two halves pressed together along a line, friction in the contact, clearance of the plate opening.
/// Lanes run over the integration points of the line.
/// Parts of both chains, sections of model/EQUATIONS.md; rigid pins are in model/rigid/:
///
///                pin halves (section 5)  rigid pins (10, 11)                 energy          loss
///     normal     normal_force()          rigid_links.hpp: joint_forces()     Energy::joints  Loss::joint_damping
///     rolling    rolling_friction()      joint_forces()                                      Loss::joint_friction
///     sliding    rolling_friction()      rigid_plates.hpp: joint_friction()                  Loss::joint_friction
///     clearance  clearance_force()       none: no sliding in the plane       Energy::joints  Loss::joint_damping

#include <cmath>

#include "model/basis/portable_math.hpp"
#include "model/basis/zero.hpp"
#include "model/force/account.hpp"
#include "model/force/link_frame.hpp"
#include "model/law/friction_laws.hpp"

namespace cvtflow::model {
namespace {

/// Forces of the joint of pin i. The front half of link i-1 gets `on_front` (and the moment `before` on that link),
/// the rear half of link i gets the opposite (and the moment `after` on that link).
template <class Real = double>
struct JointForce {
    static constexpr std::size_t rows = 2 * axis_terms + 4;
    Difference<Real> on_front;  ///< generalized forces [N]
    Real before{0.0};           ///< moment about z on link i-1 [N·m]
    Real after{0.0};            ///< moment about z on link i [N·m]

    /// Adds totals in the order of the members.
    void add(const Real* total) noexcept {
        on_front.add(total);
        before += total[2 * axis_terms + 2];
        after += total[2 * axis_terms + 3];
    }
};

/// The two links that meet, and sum (along the bisector) and difference of their directions.
template <class Real>
struct JointFrames {
    LinkFrameOf<Real> before, after;
    Real sx, sy, cx, cy;

    JointFrames() = default;
    JointFrames(const LinkFrameOf<Real>& link_before, const LinkFrameOf<Real>& link_after) noexcept
        : before(link_before),
          after(link_after),
          sx(before.tx + after.tx),
          sy(before.ty + after.ty),
          cx(before.tx - after.tx),
          cy(before.ty - after.ty) {}
};

/// The joint of two links, in a frame that turns with the mean of both, so that what slides (mm/s) does not drown in what turns (m/s). Gaps
/// are those between the vertices of the arcs (µm), not those between the axes of the halves (mm). In floats both are differences of
/// doubles.
template <class Real>
struct JointPlace {
    JointFrames<Real> frames;
    Difference<Real> gap, rate;
};
/// @param gap, rate front half of the link before, less the rear half of the link after: coordinates and velocities
template <class Real>
[[nodiscard]] inline JointPlace<Real> joint_place(const JointCoefficients& j, const LinkFrameOf<Real>& before,
                                                  const LinkFrameOf<Real>& after, const Difference<Real>& gap,
                                                  const Difference<Real>& rate) noexcept {
    JointPlace<Real> place{{before, after}, gap, rate};
    auto& [frames, open, opening] = place;
    const Real turning = 0.5 * (before.turning + after.turning);
    frames.before.turning -= turning;
    frames.after.turning -= turning;
    for (int m = 0; m < axis_terms; ++m) {
        opening.x[m] += turning * open.y[m];
        opening.y[m] -= turning * open.x[m];
    }
    const double to_vertex = 0.5 * j.diameter - j.arm;
    open.x[0] -= to_vertex * frames.sx;
    open.y[0] -= to_vertex * frames.sy;
    return place;
}

/// Positions and velocities of the contact, lanes over the points of one joint or over joints at one point.
template <int W>
struct JointMotion {
    Lanes<W> gx, gy;                     ///< gap of the vertices [m]
    Lanes<W> dx, dy;                     ///< Δ, between the centres of the arcs [m]
    Lanes<W> vx, vy;                     ///< Δ' [m/s]
    Lanes<W> nx, ny;                     ///< ν
    Lanes<W> distance;                   ///< D [m]
    Lanes<W> depth;                      ///< δ [m]
    Lanes<W> slip, axial;                ///< slip along k×ν and along z [m/s]
    Lanes<W> lever_before, lever_after;  ///< lever of each link's turning along k×ν [m]
};

/// @param points an AxisPoint of joints side by side, or all points of one joint (bench/staged/one_link.hpp)
template <int W, class Real, class Points>
[[nodiscard]] inline JointMotion<W> joint_motion(const JointCoefficients& j, const JointPlace<Real>& place, const Points& points) noexcept {
    using V = Lanes<W>;
    const auto& [frames, gap, rate] = place;
    const LinkFrameOf<Real>& before = frames.before;
    const LinkFrameOf<Real>& after = frames.after;
    const double radius = 0.5 * j.diameter;
    JointMotion<W> m;
    m.gx = points.along(gap.x), m.gy = points.along(gap.y);
    const V ax = points.along(rate.x), ay = points.along(rate.y);
    const Real &sx = frames.sx, &sy = frames.sy, &cx = frames.cx, &cy = frames.cy;
    m.dx = m.gx + radius * sx;
    m.dy = m.gy + radius * sy;
    m.distance = sqrt(m.dx * m.dx + m.dy * m.dy);
    const Reciprocals<W> inverse(m.distance, j.diameter + m.distance);
    m.nx = m.dx * inverse.first;
    m.ny = m.dy * inverse.first;
    // δ = 2ρ - |Δ| = (4ρ² - |Δ|²)/(2ρ + |Δ|), the squares multiplied out so that the depth (µm) does not drown in the rounding of ρ (cm).
    const V excess = radius * radius * (cx * cx + cy * cy) - (m.gx * m.gx + m.gy * m.gy) - 2.0 * radius * (m.gx * sx + m.gy * sy);
    m.depth = excess * inverse.second;
    m.vx = ax - j.arm * (before.turning * before.ty + after.turning * after.ty);
    m.vy = ay + j.arm * (before.turning * before.tx + after.turning * after.tx);
    m.lever_before = j.arm * (before.tx * m.nx + before.ty * m.ny) - 0.5 * m.distance;
    m.lever_after = j.arm * (after.tx * m.nx + after.ty * m.ny) - 0.5 * m.distance;
    m.slip = m.nx * ay - m.ny * ax + before.turning * m.lever_before + after.turning * m.lever_after;
    m.axial = rate.z + points.xi * rate.e;
    return m;
}

/// Elastic normal force and its energy.
template <int W>
struct LineContact {
    Lanes<W> elastic;  ///< N_e [N]
    Lanes<W> energy;   ///< [J]
};

/// x^(10/9) of every lane, x ≥ 0.
template <int W>
[[nodiscard]] inline Lanes<W> ten_ninths(const Lanes<W>& x) noexcept {
    Lanes<W> result;
    for (std::size_t lane = 0; lane < lane_count<W>; ++lane) result.set(lane, static_cast<NumberOf<W>>(ten_ninths(x[lane])));
    return result;
}

template <int W>
[[nodiscard]] inline LineContact<W> line_contact(const JointCoefficients& j, const Lanes<W>& weight, const Lanes<W>& depth) noexcept {
    const Lanes<W> pressed = positive_part<W>(depth);
    if (!j.palmgren) {
        const Lanes<W> elastic = j.stiffness * weight * pressed;
        return {elastic, 0.5 * elastic * pressed};
    }
    const Lanes<W> elastic = j.stiffness * j.reference_depth * weight * ten_ninths<W>(pressed / j.reference_depth);
    return {elastic, (9.0 / 19.0) * elastic * pressed};
}

/// Contribution of each lane to a joint's force, in the order of its members.
template <int W>
using JointTerms = std::array<Lanes<W>, JointForce<>::rows>;

/// Pressing of the rolling contact.
template <int W>
struct NormalForce {
    LineContact<W> contact;
    Lanes<W> closing;  ///< δ' [m/s]
    Lanes<W> normal;   ///< N [N]
};

template <int W>
[[nodiscard, gnu::always_inline]] inline NormalForce<W> normal_force(const JointCoefficients& j, const Lanes<W>& weight,
                                                                     const JointMotion<W>& m) noexcept {
    const Lanes<W> closing = -(m.nx * m.vx + m.ny * m.vy);
    const auto contact = line_contact<W>(j, weight, m.depth);
    return {contact, closing, positive_part<W>(contact.elastic * (1.0 + j.damping * closing))};
}

/// Friction of the rolling contact per speed of sliding [N·s/m].
template <int W, class Books>
[[nodiscard, gnu::always_inline]] inline Lanes<W> rolling_friction(const JointCoefficients& j, const JointMotion<W>& m,
                                                                   const Lanes<W>& normal, Books& books) noexcept {
    const Lanes<W> square = m.slip * m.slip + m.axial * m.axial;
    const Lanes<W> friction_per_speed = j.friction.coefficient * normal * slip_factor_of_square<W>(j.friction, square);
    books.lose(Loss::joint_friction, friction_per_speed * square);
    return friction_per_speed;
}

/// Contributions of the normal force and friction of a rolling contact. @param friction_per_speed rolling_friction(), or Zero
template <int W, class Real, class Points, class Friction>
[[nodiscard, gnu::always_inline]] inline JointTerms<W> rolling_terms(const JointCoefficients& j, const JointFrames<Real>& frames,
                                                                     const Points& points, const JointMotion<W>& m, const Lanes<W>& normal,
                                                                     const Friction& friction_per_speed) noexcept {
    const auto tangential = -friction_per_speed * m.slip;
    JointTerms<W> terms;
    points.spread(normal * m.nx - tangential * m.ny, normal * m.ny + tangential * m.nx, number<Lanes<W>>(-friction_per_speed * m.axial),
                  terms.data());
    const Lanes<W> leaning = j.arm * normal;
    terms[2 * axis_terms + 2] = leaning * (frames.before.tx * m.ny - frames.before.ty * m.nx) + tangential * m.lever_before;
    terms[2 * axis_terms + 3] = leaning * (frames.after.tx * m.ny - frames.after.ty * m.nx) + tangential * m.lever_after;
    return terms;
}

/// Rolling contact: normal force and friction. @param friction friction_per_speed from the normal force [N]
template <int W, class Real, class Points, class Books, class Friction>
[[nodiscard, gnu::always_inline]] inline JointTerms<W> rolling_contact_force(const JointCoefficients& j, const JointFrames<Real>& frames,
                                                                             const Points& points, const Lanes<W>& weight,
                                                                             const JointMotion<W>& m, Books& books,
                                                                             const Friction& friction) noexcept {
    const auto [contact, closing, normal] = normal_force<W>(j, weight, m);
    books.store(Energy::joints, contact.energy);
    books.lose(Loss::joint_damping, (normal - contact.elastic) * closing);
    return rolling_terms<W>(j, frames, points, m, normal, friction(normal));
}

/// Excess of the square of the transverse offset of the arc centres over that of the clearance, times |t₋ + t₊|².
template <int W, class Real>
[[nodiscard]] inline Lanes<W> beyond_clearance(const JointCoefficients& j, const JointFrames<Real>& frames,
                                               const JointMotion<W>& m) noexcept {
    const Real square = frames.sx * frames.sx + frames.sy * frames.sy;
    const Lanes<W> slanted = m.gy * frames.sx - m.gx * frames.sy;  // along k×b, times |t₋ + t₊|
    return slanted * slanted - j.clearance * j.clearance * square;
}

/// Clearance of the plate opening: holds the transverse offset of the arc centres against the bisector.
template <int W, class Real, class Points, class Books>
[[nodiscard]] inline JointTerms<W> clearance_force(const JointCoefficients& j, const JointFrames<Real>& frames, const Points& points,
                                                   const Lanes<W>& weight, const JointMotion<W>& m, Books& books) noexcept {
    using V = Lanes<W>;
    using std::sqrt;
    const Real inverse = 1.0 / sqrt(frames.sx * frames.sx + frames.sy * frames.sy), bx = frames.sx * inverse, by = frames.sy * inverse;
    const V across = m.gy * bx - m.gx * by;
    const V along = m.dx * bx + m.dy * by;
    const V offset = positive_part<W>(across - j.clearance) - positive_part<W>(-across - j.clearance);
    const V offset_rate = m.vy * bx - m.vx * by - 0.5 * (frames.before.turning + frames.after.turning) * along;
    const V sign = select_greater<W>(V(0.0), across, V(-1.0), V(1.0));
    const V spring = j.clearance_stiffness * weight * offset;
    const V force = spring * positive_part<W>(1.0 + j.clearance_damping * sign * offset_rate);
    JointTerms<W> terms;
    points.spread(force * by, -force * bx, V(0.0), terms.data());
    terms[2 * axis_terms + 2] = -force * (j.arm * (frames.before.tx * bx + frames.before.ty * by) - 0.5 * along);
    terms[2 * axis_terms + 3] = -force * (j.arm * (frames.after.tx * bx + frames.after.ty * by) - 0.5 * along);
    books.store(Energy::joints, spring * offset, 0.5);
    books.lose(Loss::joint_damping, (force - spring) * offset_rate);
    return terms;
}

}  // namespace
}  // namespace cvtflow::model
