#pragma once
/// Links between rigid pins: pitch lines, rolling of the halves, forces of the pack of plates. Tables of elements, beside those of pin
/// halves: model/force/plates.hpp, joint.hpp, inner.hpp. (model/EQUATIONS.md section 11)

#include "model/force/further_element.hpp"
#include "model/force/guide.hpp"
#include "model/rigid/rigid_kernels.hpp"
#include "model/rigid/rigid_vectors.hpp"

namespace cvtflow::model {
namespace {

/// Difference of the middles of pins i+1 and i, of their places or velocities: taken in doubles.
[[nodiscard, gnu::always_inline]] inline Plane chord(const CoordinateRowsOf<double>& of, int i) noexcept {
    return rounded(read(of.middle, i + 1) - read(of.middle, i));
}

/// Moves coordinates by velocities over a time [s], and rounds both.
inline void drift_pins(double step, PinColumns& columns) noexcept {
    const auto x = columns.state_position.all(), v = columns.state_velocity.all();
    const auto near_x = columns.position.all(), near_v = columns.velocity.all();
    for (std::size_t k = 0; k < rigid_coordinates; ++k) {
        for (int i = 0; i < columns.padded(); i += rigid_lanes) {
            const auto rate = read(v[k], i), place = read(x[k], i) + step * rate;
            write(x[k], i, place);
            write(near_x[k], i, rounded(place));
            write(near_v[k], i, rounded(rate));
        }
    }
    wrap(columns, columns.state());
    wrap(columns, RowRange{columns.position.middle.x, columns.velocity.bend.y});
}

inline void pitch_lines(PinColumns& columns) noexcept {
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const Plane d = chord(columns.state_position, i), rate = chord(columns.state_velocity, i);
        const PinLanes inverse = 1.0 / sqrt(dot(d, d));
        const Plane line = inverse * d;
        write(columns.line.direction, i, line);
        write(columns.line.inverse, i, inverse);
        const PinLanes turn = cross(line, rate) * inverse;
        write(columns.line.turn_ahead, i, 1.5 * turn - 0.5 * read(columns.line.turn, i));
        write(columns.line.turn, i, turn);
    }
    wrap(columns, columns.line.rows());
}

/// A f = along f - across b (b·f): change of the halves' offset by a change f of the sum of the directions.
struct Rolling {
    Plane bisector;
    PinLanes along, across;
    [[nodiscard]] Plane operator*(const Plane& f) const noexcept { return along * f - (across * dot(bisector, f)) * bisector; }
};

[[nodiscard]] inline Rolling read_rolling(const PinColumns& columns, int i) noexcept {
    return {read(columns.rolling.bisector, i), read(columns.rolling.along, i), read(columns.rolling.across, i)};
}

inline void rolling_frames(const RigidCoefficients& c, PinColumns& columns) noexcept {
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const Plane behind = read(columns.line.direction, i - 1), ahead = read(columns.line.direction, i);
        const Plane both = behind + ahead;
        const PinLanes inverse = 1.0 / sqrt(dot(both, both));
        const PinLanes across = c.diameter * inverse, along = across - c.arm;
        const Rolling rolling{inverse * both, along, across};
        const auto parting_by = [&](Row turn) { return rolling * (read(turn, i - 1) * turned(behind) + read(turn, i) * turned(ahead)); };
        write(columns.rolling.bisector, i, rolling.bisector);
        write(columns.rolling.along, i, along);
        write(columns.rolling.across, i, across);
        write(columns.rolling.offset, i, along * both);
        write(columns.rolling.offset_rate, i, parting_by(columns.line.turn));
        write(columns.rolling.offset_ahead, i, parting_by(columns.line.turn_ahead));
    }
    wrap(columns, columns.rolling.rows());
}

/// Place of a link's halves against each other, and its rates.
struct LinkMotion {
    Plane t, n;                      ///< direction of the link, and k×t
    PinLanes inverse, turn;          ///< 1/|d| [1/m], turning rate [rad/s]
    PinLanes length_rate;            ///< |d|' [m/s]
    PinLanes stretch, stretch_rate;  ///< ε [m]
    PinLanes yaw, yaw_rate;          ///< ψ: difference of the end displacements along the link [m]
    PinLanes roll, roll_rate;        ///< χ: difference of the end displacements across the link [m]
    PinLanes lean, lean_across;      ///< sum of the end displacements, along and across [m]
    PinLanes rise, rise_rate;        ///< Δz of the halves [m]
    PinLanes shear, shear_rate;      ///< [rad]
    PinLanes bow, bow_rate;          ///< difference of the displacements by bending along the link [m]
    PinLanes bow_across;             ///< difference of these displacements across the link [m]
};

/// Displacement of the halves of link i along z: the front half of pin i+1 against the rear half of pin i. @param of positions or
/// velocities
[[nodiscard, gnu::always_inline]] inline PinLanes axial_parting(const CoordinateRowsOf<PinReal>& of, int i) noexcept {
    return read(of.z, i + 1) - read(of.z, i) + 0.5 * (read(of.slide, i + 1) + read(of.slide, i));
}

[[nodiscard, gnu::always_inline]] inline LinkMotion link_motion(const RigidCoefficients& c, const PinColumns& columns, int i) noexcept {
    const auto difference = [&](const PlaneRow& of) { return read(of, i + 1) - read(of, i); };
    const auto total = [&](const PlaneRow& of) { return read(of, i + 1) + read(of, i); };
    const PinLanes per_length = read(columns.constants.inverse_length, i), per_half(1.0 / c.half_length), two_per = 2.0 * per_length;
    LinkMotion m;
    const Plane d = chord(columns.state_position, i) + PinLanes(0.5) * total(columns.rolling.offset);
    const Plane rate = chord(columns.state_velocity, i) + PinLanes(0.5) * total(columns.rolling.offset_rate);
    const PinLanes length = sqrt(dot(d, d));
    m.inverse = 1.0 / length;
    m.t = m.inverse * d;
    m.n = turned(m.t);
    m.turn = dot(rate, m.n) * m.inverse;
    const Plane ends = difference(columns.position.end), end_rate = difference(columns.velocity.end);
    m.yaw = dot(ends, m.t);
    m.roll = dot(ends, m.n);
    m.yaw_rate = dot(end_rate, m.t) + m.turn * m.roll;
    m.roll_rate = dot(end_rate, m.n) - m.turn * m.yaw;
    m.rise = axial_parting(columns.position, i);
    m.rise_rate = axial_parting(columns.velocity, i);
    const PinLanes square(c.plate_square);
    m.stretch = (length - read(columns.constants.free_length, i)) + 0.5 * per_length * (square * m.roll * m.roll + m.rise * m.rise);
    m.length_rate = dot(rate, m.t);
    m.stretch_rate = m.length_rate + per_length * (square * m.roll * m.roll_rate + m.rise * m.rise_rate);
    const Plane sums = total(columns.position.end);
    m.lean = dot(sums, m.t);
    m.lean_across = dot(sums, m.n);
    m.shear = -(per_half * m.lean) - two_per * m.rise;
    m.shear_rate = -(per_half * (dot(total(columns.velocity.end), m.t) + m.turn * m.lean_across)) - two_per * m.rise_rate;
    const Plane bend = difference(columns.position.bend);
    m.bow = dot(bend, m.t);
    m.bow_across = dot(bend, m.n);
    m.bow_rate = dot(difference(columns.velocity.bend), m.t) + m.turn * m.bow_across;
    return m;
}

/// Energies and losses of links.
struct LinkSums {
    explicit LinkSums(const PinColumns& columns) noexcept : plates(columns), pack(columns), damping(columns), inner(columns) {}
    PinSum plates, pack, damping, inner;
};

[[gnu::always_inline]] inline void link_force(const RigidCoefficients& c, const RigidKick& kick, const PinColumns& columns, int i,
                                              LinkSums& sums) noexcept {
    const LinkMotion m = link_motion(c, columns, i);
    const PinLanes yaw_stiffness = read(columns.constants.yaw_stiffness, i), yaw_damping = read(columns.constants.yaw_damping, i);
    const PinLanes shear_stiffness = read(columns.constants.shear_stiffness, i), shear_damping = read(columns.constants.shear_damping, i);
    const PinLanes torsion = read(columns.constants.torsion_stiffness, i), torsion_damping = read(columns.constants.torsion_damping, i);
    const PinLanes stretch_drag = c.pull.damping * m.stretch_rate, yaw_drag = yaw_damping * m.yaw_rate;
    const PinLanes torsion_drag = torsion_damping * m.roll_rate, shear_drag = shear_damping * m.shear_rate;
    const PinLanes bow_drag = c.bow.damping * m.bow_rate, bow = c.bow.stiffness * m.bow + bow_drag;
    const PinLanes tension = c.pull.stiffness * m.stretch + stretch_drag;
    const PinLanes yaw = yaw_stiffness * m.yaw + yaw_drag;
    const PinLanes share = tension * read(columns.constants.inverse_length, i);  // T/ℓ_0
    const PinLanes roll = c.plate_square * share * m.roll + torsion * m.roll + torsion_drag;
    const PinLanes shear = shear_stiffness * m.shear + shear_drag;
    const PinLanes bend = shear * (1.0 / c.half_length);
    const PinLanes turning = roll * m.yaw - yaw * m.roll + bend * m.lean_across - bow * m.bow_across;
    Plane pull = (turning * m.inverse) * m.n - tension * m.t;
    FurtherElement::of_rigid_pins(m, i, pull, sums);
    write(columns.link.pull, i, pull);
    write(columns.link.pull_z, i, 2.0 * read(columns.constants.inverse_length, i) * shear - share * m.rise);
    write(columns.link.twist, i, PinLanes(-1.0) * (yaw * m.t + roll * m.n));
    write(columns.link.shear, i, bend * m.t);
    write(columns.link.bow, i, bow * m.t);
    write(columns.plate.tension, i, tension);
    sums.plates.add(i, 0.5 * c.pull.stiffness * m.stretch * m.stretch);
    sums.pack.add(i, 0.5 * (yaw_stiffness * m.yaw * m.yaw + torsion * m.roll * m.roll + shear_stiffness * m.shear * m.shear +
                            c.bow.stiffness * m.bow * m.bow));
    sums.damping.add(i, drag_power(kick, columns.damping.stretch, i, stretch_drag, m.stretch_rate));
    sums.inner.add(i, drag_power(kick, columns.damping.yaw, i, yaw_drag, m.yaw_rate) +
                          drag_power(kick, columns.damping.torsion, i, torsion_drag, m.roll_rate) +
                          drag_power(kick, columns.damping.shear, i, shear_drag, m.shear_rate) +
                          drag_power(kick, columns.damping.bow, i, bow_drag, m.bow_rate));
}

inline void link_forces(const RigidCoefficients& c, const RigidKick& kick, PinColumns& columns, Account& account) noexcept {
    LinkSums sums(columns);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) link_force(c, kick, columns, i, sums);
    wrap(columns, columns.link.rows());
    account.store(Energy::plates, sums.plates.value());
    account.store(Energy::pack, sums.pack.value());
    account.lose(Loss::plate_damping, sums.damping.value());
    account.lose(Loss::inner, sums.inner.value());
}

/// Both halves of a pin bend in one shape, stiffer across the direction of travel than along it. That direction turns with both pitch
/// lines.
[[gnu::always_inline]] inline void bend_pin(const RigidCoefficients& c, const RigidKick& kick, const PinColumns& columns, int i,
                                            PinSum& stored, PinSum& lost) noexcept {
    const Plane along = read(columns.rolling.bisector, i), across = turned(along);
    const Plane bend = read(columns.position.bend, i), rate = read(columns.velocity.bend, i);
    const PinLanes turn = 0.5 * (read(columns.line.turn, i - 1) + read(columns.line.turn, i));
    const PinLanes u = dot(bend, along), v = dot(bend, across);
    const PinLanes u_rate = dot(rate, along) + turn * v, v_rate = dot(rate, across) - turn * u;
    const PinLanes u_drag = c.travel.damping * u_rate, v_drag = c.height.damping * v_rate;
    const PinLanes travel = c.travel.stiffness * u + u_drag, height = c.height.stiffness * v + v_drag;
    write(columns.force.bend, i, PinLanes(-1.0) * (travel * along + height * across));
    write(columns.joint.bend_moment, i, 0.5 * (height * u - travel * v));
    stored.add(i, 0.5 * (c.travel.stiffness * u * u + c.height.stiffness * v * v));
    lost.add(i, drag_power(kick, columns.damping.bend_along, i, u_drag, u_rate) +
                    drag_power(kick, columns.damping.bend_across, i, v_drag, v_rate));
}

/// Halves that are pressed together by N resist rolling, as if a share of the strip of contact slid.
inline void joint_forces(const RigidCoefficients& c, const RigidKick& kick, PinColumns& columns, Account& account) noexcept {
    PinSum lost(columns), bent(columns), inner(columns);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        bend_pin(c, kick, columns, i, bent, inner);
        const Plane half = PinLanes(0.5) * (read(columns.link.pull, i - 1) + read(columns.link.pull, i));
        const Rolling rolling = read_rolling(columns, i);
        const PinLanes pressing = positive_part<pin_width>(-dot(half, rolling.bisector));
        const PinLanes bending = read(columns.line.turn, i) - read(columns.line.turn, i - 1);
        const PinLanes strip = c.rolling_arm * sqrt(pressing), slip = strip * bending;
        const PinLanes friction =
            c.joint_friction.coefficient * pressing * slip_factor_of_square<pin_width>(c.joint_friction, slip * slip) * slip;
        write(columns.joint.offset_moment, i, rolling * half);
        write(columns.joint.normal, i, pressing);
        lost.add(i, drag_power(kick, columns.joint.rolling_moment, i, strip * friction, bending));
    }
    wrap(columns, RowRange{columns.joint.offset_moment.x, columns.joint.bend_moment});
    account.lose(Loss::joint_friction, lost.value());
    account.lose(Loss::inner, inner.value());
    account.store(Energy::inner, bent.value());
}

/// Action of link i on the pins at its ends in the plane: forces of its halves and the moment on its pitch line.
[[nodiscard, gnu::always_inline]] inline Plane link_thrust(const PinColumns& columns, int i) noexcept {
    const Plane normal = turned(read(columns.line.direction, i));
    const Plane lean = read(columns.joint.offset_moment, i) + read(columns.joint.offset_moment, i + 1);
    const PinLanes moment = dot(normal, lean) + read(columns.joint.rolling_moment, i + 1) - read(columns.joint.rolling_moment, i) +
                            read(columns.joint.bend_moment, i + 1) + read(columns.joint.bend_moment, i) + read(columns.tip.moment, i);
    return read(columns.link.pull, i) + (moment * read(columns.line.inverse, i)) * normal;
}

inline void sum_link_forces(PinColumns& columns) noexcept {
    Plane last{0.0, 0.0};  // of the eight links before
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const Plane ahead = link_thrust(columns, i), behind = i == 0 ? link_thrust(columns, -1) : shifted_by_one_pin(last, ahead);
        last = ahead;
        write(columns.force.middle, i, behind - ahead);
        const PinLanes front = read(columns.link.pull_z, i - 1), rear = -read(columns.link.pull_z, i);
        write(columns.force.z, i, front + rear);
        write(columns.force.slide, i, 0.5 * (front - rear));
        const Plane twist = read(columns.link.twist, i - 1) - read(columns.link.twist, i);
        const Plane shear = read(columns.link.shear, i - 1) + read(columns.link.shear, i);
        write(columns.force.end, i, twist + shear);
        write(columns.wave.force, i, behind - ahead + read(columns.wave.tips, i));
        write(columns.wave.end_force, i, twist + shear + read(columns.wave.end_tips, i));
        const Plane bow = read(columns.link.bow, i) - read(columns.link.bow, i - 1);
        write(columns.force.bend, i, read(columns.force.bend, i) + bow);
    }
}

/// Forces of the filter on a link, and on the pin at its front: on its middle, and on p and q.
struct WaveThrust {
    PinLanes stretch, yaw;
    Plane pull, twist;
};

/// Filter of the fastest waves along the chain, which would set the length of the step. The forces of stretch and yaw are those of
/// u + β h² u'', so that a leapfrog is stable up to h ω = 1/√β instead of 2. u'' is that by the forces of links alone and of tips as they
/// last: friction of the last step's tips would pull back with a delay. At rest u'' is zero, and statics stay. What the forces take from
/// the motion is a loss of the plates.
inline void filter_waves(const RigidCoefficients& c, const RigidKick& kick, PinColumns& columns, Account& account) noexcept {
    wrap(columns, columns.wave.forces());
    PinSum lost(columns);
    const double share = wave_filter * kick.step * kick.step;
    const PinLanes pull(share * c.pull.stiffness), per_mass(1.0 / c.mass), yaw(share / c.tilt_mass);
    const auto along = [&](const PlaneRow& of, int i) { return dot(read(columns.line.direction, i), read(of, i + 1) - read(of, i)); };
    const auto thrust = [&](int i) -> WaveThrust {
        const Plane t = read(columns.line.direction, i);
        const PinLanes turn = read(columns.line.turn, i);
        const PinLanes stretch = pull * (per_mass * along(columns.wave.force, i) + turn * turn / read(columns.line.inverse, i)),
                       yawing = yaw * read(columns.constants.yaw_stiffness, i) * along(columns.wave.end_force, i);
        return {stretch, yawing, stretch * t, yawing * t};
    };
    WaveThrust last = thrust(-1);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const WaveThrust ahead = thrust(i);
        const Plane pull_behind = i == 0 ? last.pull : shifted_by_one_pin(last.pull, ahead.pull);
        const Plane twist_behind = i == 0 ? last.twist : shifted_by_one_pin(last.twist, ahead.twist);
        last = ahead;
        lost.add(i, drag_power(kick, columns.damping.wave, i, ahead.stretch,
                               dot(read(columns.line.direction, i), chord(columns.state_velocity, i))) +
                        drag_power(kick, columns.damping.wave_yaw, i, ahead.yaw, along(columns.velocity.end, i)));
        write(columns.force.middle, i, read(columns.force.middle, i) + (ahead.pull - pull_behind));
        write(columns.force.end, i, read(columns.force.end, i) + (ahead.twist - twist_behind));
    }
    account.lose(Loss::plate_damping, lost.value());
}

/// Adds the forces of the strands' guides to those on the middles of the pins. (EQUATIONS section 8; pin halves: model/force/guide.hpp)
inline void guide_pins(const RigidCoefficients& c, const RigidKick& kick, PinColumns& columns, Account& account) noexcept {
    PinSum stored(columns), lost(columns);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const Plane at = read(columns.position.middle, i), rate = read(columns.velocity.middle, i);
        const GuideContact<pin_width> contact(c.guide, 1.0, at.x, at.y, rate.x, rate.y);
        write(columns.force.middle, i, read(columns.force.middle, i) + Plane{contact.fx, contact.fy});
        stored.add(i, contact.energy);
        lost.add(i, drag_power(kick, columns.damping.guide, i, contact.damping, contact.approach) +
                        drag_power(kick, columns.damping.guide_friction, i, contact.friction, contact.speed));
    }
    account.store(Energy::supports, stored.value());
    account.lose(Loss::guide, lost.value());
}

/// RigidKernels::links.
inline void step_links(const RigidCoefficients& c, const RigidKick& kick, PinColumns& columns, Account& account) noexcept {
    account = {};
    drift_pins(kick.step, columns);
    pitch_lines(columns);
    rolling_frames(c, columns);
    link_forces(c, kick, columns, account);
    joint_forces(c, kick, columns, account);
    sum_link_forces(columns);
    if (kick.implicit()) filter_waves(c, kick, columns, account);
    if (c.guide.present) guide_pins(c, kick, columns, account);
}

}  // namespace
}  // namespace cvtflow::model
