#pragma once
/// Friction between the plates of neighbouring links along the pin that they share, of the whole chain at once; and from the sum of all
/// forces on a pin to its motion. (model/EQUATIONS.md section 11)

#include "model/basis/ring_solver.hpp"
#include "model/law/friction_laws.hpp"
#include "model/rigid/rigid_kernels.hpp"
#include "model/rigid/rigid_links.hpp"
#include "model/rigid/rigid_vectors.hpp"

namespace cvtflow::model {
namespace {

/// Solves for the friction P of all links at the end of the step, (1 + aF (4 - β_i - β_{i+1})) P_i - aF (β_i P_{i-1} + β_{i+1} P_{i+1})
/// = B_i around the ring: F friction per sliding speed, B friction if no link's friction changed the sliding, β_i the degree to which the
/// halves of pin i stick together, a of a pin's speed per force over the step [m/s/N].
inline void solve_friction(PinColumns& columns) noexcept {
    const RingShares shares(columns.pins());
    wrap(columns, RowRange{columns.plate.rhs, columns.plate.on});
    const auto& ring = columns.ring;
    const auto& plate = columns.plate;
    shares.to_rows(plate.rhs, ring.rhs);
    shares.to_rows(plate.own, ring.own);
    shares.to_rows(plate.back, ring.back);
    shares.to_rows(plate.on, ring.on);
    solve_ring(shares, ring);
    shares.from_rows(ring.solution, plate.friction);
    wrap(columns, plate.friction);
}

/// Sliding speed that the lengthening of both pins adds at the plates at +z, and subtracts at those at -z [m/s].
[[nodiscard]] inline PinLanes plate_parting(const RigidCoefficients& c, const PinColumns& columns, int i) noexcept {
    return c.plate_reach * (read(columns.tip.lengthening, i + 1) - read(columns.tip.lengthening, i));
}

/// Sliding speed to be expected when friction acts, extrapolated from those of the last two steps; the last one then becomes the one
/// before. With the sliding speed of the last step friction lags by a step, which is most of a step's error.
[[nodiscard, gnu::always_inline]] inline PinLanes expected_slip(Row slip, Row before, int i) noexcept {
    const PinLanes last = read(slip, i), expected = abs(2.0 * last - read(before, i));
    write(before, i, last);
    return expected;
}

/// Friction of the halves of a pin per free sliding speed, and the degree to which they stick together. @param slip [m/s]
[[gnu::always_inline]] inline void write_joint_secant(const RigidCoefficients& c, const PinColumns& columns, int i,
                                                      const PinLanes& per_slide, const PinLanes& slip) noexcept {
    const PinLanes secant = c.joint_friction.coefficient * read(columns.joint.normal, i) * slip_factor<pin_width>(c.joint_friction, slip);
    const PinLanes held = secant / (1.0 + per_slide * secant);
    write(columns.joint.secant, i, held);
    write(columns.joint.coupling, i, per_slide * held);
}

/// Velocities of the pins and of their halves on each other along z, and the friction per speed of the halves, before plates rub. Tips have
/// the friction of the last step.
inline void free_slips(const RigidCoefficients& c, const RigidKick& kick, PinColumns& columns) noexcept {
    const PinLanes per_slide(kick.until_friction() / c.slide_mass), per_mass(kick.until_friction() / c.mass);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const PinLanes on_pin = read(columns.force.z, i) + read(columns.tip.force.z, i),
                       on_slide = read(columns.force.slide, i) + read(columns.tip.force.slide, i);
        const PinLanes drive = read(columns.velocity.slide, i) + per_slide * on_slide;
        const PinLanes speed = kick.implicit() ? expected_slip(columns.joint.slip, columns.joint.slip_before, i) : abs(drive);
        write(columns.joint.axial_free_speed, i, read(columns.velocity.z, i) + per_mass * on_pin);
        write(columns.joint.free_slip, i, drive);
        write_joint_secant(c, columns, i, per_slide, speed);
    }
    wrap(columns, RowRange{columns.joint.free_slip, columns.joint.axial_free_speed});
}

/// Friction of the halves of a pin on each other along it, after that of the plates on both and with the tips' friction of the last step,
/// whose part is then taken from the free speed.
inline void joint_friction_expected(const RigidCoefficients& c, const RigidKick& kick, PinColumns& columns) noexcept {
    const PinLanes per_slide(kick.until_friction() / c.slide_mass);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const PinLanes plates = 0.5 * (read(columns.plate.friction, i - 1) + read(columns.plate.friction, i));
        const PinLanes drive = read(columns.joint.free_slip, i) - per_slide * plates;
        write(columns.joint.free_slip, i, drive - per_slide * read(columns.tip.force.slide, i));
        write(columns.joint.friction, i, read(columns.joint.secant, i) * drive);
    }
    wrap(columns, columns.joint.friction);
}

/// Updates the friction of the joints with the tips' forces of this step.
inline void joint_friction(const RigidCoefficients& c, const RigidKick& kick, PinColumns& columns, Account& account) noexcept {
    PinSum lost(columns);
    const PinLanes per_slide(kick.until_friction() / c.slide_mass);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const PinLanes drive = read(columns.joint.free_slip, i) + per_slide * read(columns.tip.force.slide, i);
        const PinLanes friction = read(columns.joint.secant, i) * drive;
        const PinLanes acting = kick.implicit() ? 0.5 * (friction + read(columns.joint.friction_before, i)) : friction;
        lost.add(i, acting * read(columns.velocity.slide, i));
        write(columns.joint.friction, i, friction);
        write(columns.joint.slip, i, drive - per_slide * friction);
    }
    account.lose(Loss::joint_friction, lost.value());
}

/// Change of the sliding speed of link i by the friction of the links, over the step per mass.
[[nodiscard, gnu::always_inline]] inline PinLanes slowing(const PinColumns& columns, int i) noexcept {
    const PinLanes friction = read(columns.plate.friction, i), behind = read(columns.joint.coupling, i),
                   ahead = read(columns.joint.coupling, i + 1);
    return behind * (read(columns.plate.friction, i - 1) + friction) + ahead * (friction + read(columns.plate.friction, i + 1)) -
           4.0 * friction;
}

/// Sliding speed of the plates of link i before they rub [m/s].
[[nodiscard, gnu::always_inline]] inline PinLanes free_slip_of_plates(const PinColumns& columns, int i) noexcept {
    const auto parted = [&](int pin) { return 0.5 * (1.0 - read(columns.joint.coupling, pin)) * read(columns.joint.free_slip, pin); };
    return read(columns.joint.axial_free_speed, i + 1) - read(columns.joint.axial_free_speed, i) + parted(i + 1) + parted(i);
}

/// Most friction of half of a link's plates [N].
[[nodiscard, gnu::always_inline]] inline PinLanes plate_capacity(const RigidCoefficients& c, const PinColumns& columns, int i) noexcept {
    return (0.5 * c.plate_friction.coefficient) * positive_part<pin_width>(read(columns.plate.tension, i));
}

/// Sliding speeds of the plates before they rub, their friction per sliding speed, and the friction at those speeds.
inline void grip_plates(const RigidCoefficients& c, const RigidKick& kick, const PinColumns& columns) noexcept {
    const PinLanes per_mass(kick.until_friction() / c.mass);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const PinLanes capacity = plate_capacity(c, columns, i), parting = plate_parting(c, columns, i);
        const PinLanes drive = free_slip_of_plates(columns, i);
        const auto grip_at = [&](const PinLanes& now, Row slip, Row before) {
            return capacity * slip_factor<pin_width>(c.plate_friction, kick.implicit() ? expected_slip(slip, before, i) : abs(now));
        };
        const PinLanes low = grip_at(drive - parting, columns.plate.slip_low, columns.plate.slip_low_before),
                       high = grip_at(drive + parting, columns.plate.slip_high, columns.plate.slip_high_before);
        const PinLanes rhs = low * (drive - parting) + high * (drive + parting);
        const PinLanes coupling = per_mass * (low + high);
        write(columns.plate.own, i, 1.0 + 4.0 * coupling);
        write(columns.plate.back, i, coupling * read(columns.joint.coupling, i));
        write(columns.plate.on, i, coupling * read(columns.joint.coupling, i + 1));
        write(columns.plate.secant_high, i, high);
        write(columns.plate.free_slip, i, drive);
        write(columns.plate.rhs, i, rhs);
        if (!kick.implicit()) write(columns.plate.friction, i, rhs);
    }
}

/// Renews the friction per speed of plates and joints at the sliding speeds that the solution leaves, and the friction of each link beside
/// that of its neighbours. Friction at expected speeds lags behind where a contact begins or ceases to slide.
inline void renew_friction(const RigidCoefficients& c, const RigidKick& kick, const PinColumns& columns) noexcept {
    const PinLanes per_mass(kick.until_friction() / c.mass), per_slide(kick.until_friction() / c.slide_mass);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        write(columns.plate.slip_low, i, read(columns.plate.free_slip, i) + per_mass * slowing(columns, i));
        const PinLanes plates = 0.5 * (read(columns.plate.friction, i - 1) + read(columns.plate.friction, i));
        const PinLanes slip = abs(read(columns.joint.free_slip, i) - per_slide * plates) * (1.0 - read(columns.joint.coupling, i));
        write_joint_secant(c, columns, i, per_slide, slip);
    }
    wrap(columns, columns.joint.coupling);
    PinLanes before(0.0);  // of the eight links before
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const PinLanes slide = read(columns.plate.slip_low, i), parting = plate_parting(c, columns, i);
        const PinLanes capacity = plate_capacity(c, columns, i);
        const PinLanes low = capacity * slip_factor<pin_width>(c.plate_friction, abs(slide - parting)),
                       high = capacity * slip_factor<pin_width>(c.plate_friction, abs(slide + parting));
        const PinLanes drive = free_slip_of_plates(columns, i), coupling = per_mass * (low + high);
        const PinLanes back = coupling * read(columns.joint.coupling, i), on = coupling * read(columns.joint.coupling, i + 1);
        const PinLanes friction = read(columns.plate.friction, i),
                       behind = i == 0 ? read(columns.plate.friction, -1) : lanes_across<rigid_lanes - 1, pin_width>(before, friction);
        before = friction;
        const PinLanes rhs = low * (drive - parting) + high * (drive + parting);
        write(columns.plate.secant_high, i, high);
        write(columns.plate.free_slip, i, drive);
        write(columns.plate.friction, i,
              (rhs + back * behind + on * read(columns.plate.friction, i + 1)) / (1.0 + 4.0 * coupling - back - on));
    }
    wrap(columns, columns.plate.friction);
}

/// Friction of the plates of neighbouring links along the pin that they share, and of its halves on each other. The sliding speeds with
/// it are kept for the next step. The loss by the pins' lengthening is counted with the tips that do its work.
inline void plate_friction(const RigidCoefficients& c, const RigidKick& kick, PinColumns& columns, Account& account) noexcept {
    PinSum lost(columns);
    const PinLanes per_mass(kick.until_friction() / c.mass);
    wrap(columns, columns.tip.lengthening);
    free_slips(c, kick, columns);
    grip_plates(c, kick, columns);
    if (kick.implicit()) {
        solve_friction(columns);
        renew_friction(c, kick, columns);
    }
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const PinLanes friction = read(columns.plate.friction, i), parting = plate_parting(c, columns, i);
        const PinLanes speed = axial_parting(columns.velocity, i);
        lost.add(i, (kick.implicit() ? 0.5 * (friction + read(columns.plate.friction_before, i)) : friction) * speed);
        const PinLanes slide = read(columns.plate.free_slip, i) + per_mass * slowing(columns, i);
        const PinLanes high = read(columns.plate.secant_high, i);
        write(columns.plate.moment, i, 2.0 * (high * (slide + parting)) - friction);
        write(columns.plate.slip_low, i, slide - parting);
        write(columns.plate.slip_high, i, slide + parting);
    }
    account.lose(Loss::plate_friction, lost.value());
    wrap(columns, RowRange{columns.plate.friction, columns.plate.moment});
    joint_friction_expected(c, kick, columns);
}

/// Moment of this step's tips on pitch line i, n_i·(A_i g_i + A_{i+1} g_{i+1}) and those on the halves that turn with it; and its change,
/// as a force on pin i+1.
struct TipMoment {
    PinLanes moment;
    Plane thrust;

    TipMoment(const PinColumns& columns, int i) noexcept {
        const Plane normal = turned(read(columns.line.direction, i));
        const Plane lean = read(columns.tip.offset_moment, i) + read(columns.tip.offset_moment, i + 1);
        moment = dot(normal, lean) + read(columns.tip.moment_of_half[1], i) + read(columns.tip.moment_of_half[0], i + 1);
        thrust = ((moment - read(columns.tip.moment, i)) * read(columns.line.inverse, i)) * normal;
    }
};

/// Writes a velocity's rate of change, and changes the velocity by that over a step [s]. @return v v', velocities before and after
[[nodiscard, gnu::always_inline]] inline PinLanes kicked(Row acceleration, double* velocity, int i, const PinLanes& rate,
                                                         double step) noexcept {
    const auto before = read(velocity, i), v = before + step * widened<pin_width>(rate);
    write(acceleration, i, rate);
    write(velocity, i, v);
    return rounded(before * v);
}

/// Share of a step in the low pass by which forces of tips last: their friction is that of the step before and would pull the waves back
/// with a delay. With 0.3 waves of a slow chain grow where `chain.damping_ratio` is 0.003.
constexpr double lasting_share = 0.1;

/// Accelerations and, over the step, kick_pins(). @return as kick_pins()
inline double accelerate_pins(const RigidCoefficients& c, const RigidKick& kick, PinColumns& columns) noexcept {
    wrap(columns, columns.tip.moments());
    PinSum energy(columns);
    const double step = kick.step;
    const PinLanes per_mass(1.0 / c.mass), per_tilt(1.0 / c.tilt_mass), per_slide(1.0 / c.slide_mass), per_bend(1.0 / c.bend_mass);
    const auto follow = [&, share = PinLanes(lasting_share)](const PlaneRow& tips, const Plane& now, int i) {
        write(tips, i, kick.implicit() ? read(tips, i) + share * (now - read(tips, i)) : now);
    };
    Plane last{0.0, 0.0};  // of the eight links before
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const TipMoment tips(columns, i);
        const Plane behind = i == 0 ? TipMoment(columns, -1).thrust : shifted_by_one_pin(last, tips.thrust);
        last = tips.thrust;
        const Plane force = read(columns.force.middle, i) + read(columns.tip.force.middle, i) + behind - tips.thrust;
        const PinLanes front = read(columns.plate.friction, i - 1), rear = read(columns.plate.friction, i), rubbing = rear - front;
        const PinLanes parting = -(0.5 * (front + rear) + read(columns.joint.friction, i));
        follow(columns.wave.tips, read(columns.tip.force.middle, i), i);
        follow(columns.wave.end_tips, read(columns.tip.force.end, i), i);
        const Plane end = read(columns.force.end, i) + read(columns.tip.force.end, i),
                    bend = read(columns.force.bend, i) + read(columns.tip.force.bend, i);
        const PinLanes z = read(columns.force.z, i) + read(columns.tip.force.z, i) + rubbing,
                       slide = read(columns.force.slide, i) + read(columns.tip.force.slide, i) + parting;
        const auto kicked_both = [&](const PlaneRow& acceleration, const PlaneRowOf<double>& velocity, const Plane& rate) {
            return kicked(acceleration.x, velocity.x, i, rate.x, step) + kicked(acceleration.y, velocity.y, i, rate.y, step);
        };
        const auto& a = columns.acceleration;
        const auto& v = columns.state_velocity;
        energy.add(i, 0.5 * c.mass * (kicked_both(a.middle, v.middle, per_mass * force) + kicked(a.z, v.z, i, per_mass * z, step)) +
                          0.5 * c.tilt_mass * kicked_both(a.end, v.end, per_tilt * end) +
                          0.5 * c.slide_mass * kicked(a.slide, v.slide, i, per_slide * slide, step) +
                          0.5 * c.bend_mass * kicked_both(a.bend, v.bend, per_bend * bend));
        write(columns.tip.moment, i, tips.moment);
        write(columns.plate.friction_before, i, rear);
        write(columns.plate.moment_before, i, read(columns.plate.moment, i));
        write(columns.joint.friction_before, i, read(columns.joint.friction, i));
    }
    wrap(columns, columns.tip.moment);
    wrap(columns, columns.plate.moment_before);
    return energy.value();
}

/// @return ½ v·M v' of the velocities before and after [J]
inline double kick_pins(const RigidCoefficients& c, double step, PinColumns& columns) noexcept {
    PinSum energy(columns);
    const auto velocity = columns.state_velocity.all();
    const auto acceleration = columns.acceleration.all();
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        PinLanes of_pins(0.0);
        for (std::size_t k = 0; k < rigid_coordinates; ++k)
            of_pins += (0.5 * c.inertia(static_cast<int>(k))) * kicked(acceleration[k], velocity[k], i, read(acceleration[k], i), step);
        energy.add(i, of_pins);
    }
    return energy.value();
}

/// RigidKernels::kick.
inline double step_pins(const RigidCoefficients& c, const RigidKick& kick, PinColumns& columns, Account& account) noexcept {
    joint_friction(c, kick, columns, account);
    return accelerate_pins(c, kick, columns);
}

}  // namespace
}  // namespace cvtflow::model
