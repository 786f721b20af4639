#pragma once
/// Unknowns of the whole ring of links at once: friction between the plates of neighbouring links along the pin that they share, and waves
/// of the links in a step; and from the sum of all forces on a pin to its motion. (model/EQUATIONS.md section 11)

#include <algorithm>
#include <array>

#include "model/law/friction_laws.hpp"
#include "model/rigid/rigid_kernels.hpp"
#include "model/rigid/rigid_links.hpp"
#include "model/rigid/rigid_vectors.hpp"

namespace cvtflow::model {
namespace {

/// Inertia κ = β h² k that a step h adds against the rate of a deflection of stiffness k.
class StepInertia {
public:
    StepInertia(const RigidCoefficients& c, double step) noexcept
        : per_stiffness_(wave_share * step * step), stretch_(wave_share * step * step * c.pull.stiffness) {}
    [[nodiscard]] PinLanes stretch() const noexcept { return stretch_; }  ///< of a link [kg]
    [[nodiscard, gnu::always_inline]] PinLanes yaw(const RigidView& columns, int i) const noexcept {
        return per_stiffness_ * read(columns, Column::yaw_stiffness, i);
    }
    /// Of a half along its pin, on the contacts of its tips. @param half 0: front, 1: rear
    [[nodiscard, gnu::always_inline]] PinLanes contact(const RigidView& columns, int i, int half) const noexcept {
        return per_stiffness_ * read(columns, Column::tip_stiffness_front + half, i);
    }

private:
    PinLanes per_stiffness_, stretch_;
};

/// Velocities of a pin's halves along it by forces on them over the step.
struct AxialResponse {
    PinLanes front, rear;  ///< of a half that is alone [m/s/N]
    PinLanes secant;       ///< friction of the halves on each other per speed at which they would part [N·s/m]

    AxialResponse(const RigidKick& kick, const RigidView& columns, int i) noexcept
        : front(kick.step * read(columns, Column::axial_mobility_front, i)),
          rear(kick.step * read(columns, Column::axial_mobility_rear, i)),
          secant(read(columns, Column::joint_secant, i)) {}

    /// Of a half to a force on itself.
    [[nodiscard]] PinLanes own_front() const noexcept { return front - front * front * secant; }
    [[nodiscard]] PinLanes own_rear() const noexcept { return rear - rear * rear * secant; }
};

/// Velocities of the halves along their pins, and their grip on each other, before plates rub.
inline void free_slips(const RigidCoefficients& c, const RigidKick& kick, RigidColumns& all) noexcept {
    const RigidView columns(all);
    const StepInertia inertia(c, kick.step);
    const PinLanes step(kick.step), half_mass(0.5 * c.mass);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const PinLanes along = read(columns, Column::vz, i), apart = 0.5 * read(columns, Column::vslide, i);
        const PinLanes both = 0.5 * read(columns, Column::force_z, i), parting = read(columns, Column::force_slide, i);
        const PinLanes mobility[] = {1.0 / (half_mass + inertia.contact(columns, i, 0)),
                                     1.0 / (half_mass + inertia.contact(columns, i, 1))};
        const PinLanes front = along + apart + step * mobility[0] * (both + parting + read(columns, Column::tip_press_front, i));
        const PinLanes rear = along - apart + step * mobility[1] * (both - parting + read(columns, Column::tip_press_rear, i));
        const PinLanes drive = front - rear, response = step * (mobility[0] + mobility[1]);
        const PinLanes speed = kick.implicit() ? read(columns, Column::joint_slip, i) : abs(drive);
        const PinLanes grip =
            c.joint_friction.coefficient * read(columns, Column::joint_normal, i) * slip_factor<rigid_lanes>(c.joint_friction, speed);
        const PinLanes held = grip / (1.0 + response * grip);
        write(columns, Column::axial_mobility_front, i, mobility[0]);
        write(columns, Column::axial_mobility_rear, i, mobility[1]);
        write(columns, Column::axial_free_front, i, front);
        write(columns, Column::axial_free_rear, i, rear);
        write(columns, Column::joint_free_slip, i, drive);
        write(columns, Column::joint_secant, i, held);
        write(columns, Column::joint_coupling, i, (step * mobility[0]) * (step * mobility[1]) * held);
    }
    all.wrap(Column::joint_free_slip, Column::axial_free_rear);
}

/// Friction of the halves of a pin on each other along it, behind that of the plates on both, with the tips' friction of the last step.
inline void joint_friction_expected(const RigidKick& kick, RigidColumns& all) noexcept {
    const RigidView columns(all);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const AxialResponse response(kick, columns, i);
        const PinLanes drive = read(columns, Column::joint_free_slip, i) - response.front * read(columns, Column::plate_friction, i - 1) -
                               response.rear * read(columns, Column::plate_friction, i);
        write(columns, Column::joint_free_slip, i, drive);
        write(columns, Column::joint_friction, i, response.secant * drive);
    }
}

/// Force of a pin's tips on its front and rear half along z [N].
[[nodiscard, gnu::always_inline]] inline PinLanes tips_on_front(const RigidView& columns, int i) noexcept {
    return 0.5 * read(columns, Column::tip_force_z, i) + read(columns, Column::tip_force_slide, i);
}
[[nodiscard, gnu::always_inline]] inline PinLanes tips_on_rear(const RigidView& columns, int i) noexcept {
    return 0.5 * read(columns, Column::tip_force_z, i) - read(columns, Column::tip_force_slide, i);
}

/// Updates the friction of the joints with the tips' forces of this step.
inline void joint_friction(const RigidKick& kick, RigidColumns& all, Account& account) noexcept {
    const RigidView columns(all);
    PinSum lost(columns);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const AxialResponse response(kick, columns, i);
        const PinLanes drive = read(columns, Column::joint_free_slip, i) +
                               response.front * (tips_on_front(columns, i) - read(columns, Column::tip_press_front, i)) -
                               response.rear * (tips_on_rear(columns, i) - read(columns, Column::tip_press_rear, i));
        const PinLanes friction = response.secant * drive;
        const PinLanes acting = kick.implicit() ? 0.5 * (friction + read(columns, Column::joint_friction_before, i)) : friction;
        lost.add(i, acting * read(columns, Column::vslide, i));
        write(columns, Column::joint_friction, i, friction);
        write(columns, Column::joint_slip, i, abs(drive - (response.front + response.rear) * friction));
    }
    account.lose(Loss::joint_friction, lost.value());
}

/// Sliding speed of link i per friction of its plates over the step [m/s/N].
[[nodiscard, gnu::always_inline]] inline PinLanes link_response(const RigidKick& kick, const RigidView& columns, int i) noexcept {
    return AxialResponse(kick, columns, i + 1).own_front() + AxialResponse(kick, columns, i).own_rear();
}

/// Friction P_i of all links of the velocities that the step leaves behind, by the friction per speed that the last step has left:
/// (1 + F a_i) P_i - F (b_i P_{i-1} + b_{i+1} P_{i+1}) = B_i; F friction per sliding speed (plate_secant), B friction if no link's
/// friction changed the sliding (plate_rhs), a_i link_response(), b_i joint_coupling of pin i.
inline void solve_friction(const RigidKick& kick, RigidColumns& all) noexcept {
    const RigidView columns(all);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const PinLanes secant = read(columns, Column::plate_secant, i);
        write(columns, Column::plate_rear, i, secant * read(columns, Column::joint_coupling, i));
        write(columns, Column::plate_front, i, secant * read(columns, Column::joint_coupling, i + 1));
        write(columns, Column::plate_excess, i, secant * link_response(kick, columns, i));
    }
    all.wrap(Column::plate_rhs, Column::plate_rhs);
    all.wrap(Column::plate_excess, Column::plate_front);
    LinkRing(all).solve(Column::plate_excess, Column::plate_rear, Column::plate_front, Column::plate_rhs, Column::plate_friction);
    all.wrap(Column::plate_friction, Column::plate_friction);
}

/// Rate at which pin i lengthens by a force on it over the step: its tips move along the flanks [m/s/N].
[[nodiscard, gnu::always_inline]] inline PinLanes lengthening_response(const RigidCoefficients& c, const RigidKick& kick,
                                                                       const RigidView& columns, int i) noexcept {
    const PinLanes yielding =
        c.yield_of_stiffness * (read(columns, Column::tip_stiffness_front, i) + read(columns, Column::tip_stiffness_rear, i));  // mean η
    const double mobility = c.sine * c.sine * (1.0 / c.mass + c.bend_lever * c.bend_lever / c.bend_mass);
    return (kick.step * mobility) * (yielding * yielding);
}

/// Sliding speed that the lengthening of both pins adds at the plates at +z, and subtracts at those at -z [m/s]. Plates that hold firmly
/// change it within a step, so it follows the more slowly the more they do.
/// @param grip friction per sliding speed, of all plates [N·s/m]
[[nodiscard, gnu::always_inline]] inline PinLanes plate_parting(const RigidCoefficients& c, const RigidKick& kick, const RigidView& columns,
                                                                int i, const PinLanes& now, const PinLanes& grip) noexcept {
    const PinLanes response = lengthening_response(c, kick, columns, i) + lengthening_response(c, kick, columns, i + 1);
    const PinLanes held = (0.5 * c.plate_square) * response * grip;
    return (now + held * read(columns, Column::plate_parting, i)) / (1.0 + held);
}

/// Sliding speed of link i without friction of plates [m/s].
[[nodiscard, gnu::always_inline]] inline PinLanes free_sliding(const RigidKick& kick, const RigidView& columns, int i) noexcept {
    const AxialResponse ahead(kick, columns, i + 1), behind(kick, columns, i);
    return (read(columns, Column::axial_free_front, i + 1) - ahead.front * ahead.secant * read(columns, Column::joint_free_slip, i + 1)) -
           (read(columns, Column::axial_free_rear, i) + behind.rear * behind.secant * read(columns, Column::joint_free_slip, i));
}

/// Change of the sliding speed of link i by the friction of the links, over the step.
[[nodiscard]] inline PinLanes slowing(const RigidKick& kick, const RigidView& columns, int i) noexcept {
    return read(columns, Column::joint_coupling, i) * read(columns, Column::plate_friction, i - 1) +
           read(columns, Column::joint_coupling, i + 1) * read(columns, Column::plate_friction, i + 1) -
           link_response(kick, columns, i) * read(columns, Column::plate_friction, i);
}

/// Plates of neighbouring links rub along the pin that they share, and its halves on each other. The sliding speeds that a step leaves
/// behind are kept for the next one. The loss by the pins' lengthening is counted with the tips that do its work.
inline void plate_friction(const RigidCoefficients& c, const RigidKick& kick, RigidColumns& all, Account& account) noexcept {
    const RigidView columns(all);
    PinSum lost(columns);
    free_slips(c, kick, all);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const PinLanes capacity = (0.5 * c.plate_friction.coefficient) * positive_part<rigid_lanes>(read(columns, Column::tension, i));
        const PinLanes apart = c.plate_reach * (read(columns, Column::lengthening, i + 1) - read(columns, Column::lengthening, i));
        const PinLanes drive = free_sliding(kick, columns, i);
        const auto grip_at = [&](const PinLanes& now, Column kept) {
            return capacity * slip_factor<rigid_lanes>(c.plate_friction, kick.implicit() ? read(columns, kept, i) : abs(now));
        };
        const PinLanes low = grip_at(drive - apart, Column::plate_slip_low), high = grip_at(drive + apart, Column::plate_slip_high);
        const PinLanes parting = plate_parting(c, kick, columns, i, apart, low + high);
        const PinLanes push = low * (drive - parting) + high * (drive + parting);
        write(columns, Column::plate_secant, i, low + high);
        write(columns, Column::plate_secant_high, i, high);
        write(columns, Column::plate_free_slip, i, drive);
        write(columns, Column::plate_parting, i, parting);
        write(columns, Column::plate_rhs, i, push);
        if (!kick.implicit()) write(columns, Column::plate_friction, i, push);
    }
    if (kick.implicit()) solve_friction(kick, all);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const PinLanes friction = read(columns, Column::plate_friction, i), parting = read(columns, Column::plate_parting, i);
        const PinLanes speed = axial_parting(columns, Column::vz, Column::vslide, i);
        lost.add(i, (kick.implicit() ? 0.5 * (friction + read(columns, Column::plate_friction_before, i)) : friction) * speed);
        const PinLanes slide = read(columns, Column::plate_free_slip, i) + slowing(kick, columns, i);
        const PinLanes high = read(columns, Column::plate_secant_high, i);
        write(columns, Column::plate_friction_moment, i, 2.0 * (high * (slide + parting)) - friction);
        write(columns, Column::plate_slip_low, i, abs(slide - parting));
        write(columns, Column::plate_slip_high, i, abs(slide + parting));
    }
    account.lose(Loss::plate_friction, lost.value());
    all.wrap(Column::plate_friction, Column::plate_friction_moment);
    joint_friction_expected(kick, all);
}

/// Impulses λ_i = κ_i t_i·(v_{i+1} - v_i) of stretch and of yaw of the links, v the changes of velocities in a step:
/// (m/κ_i + 2) λ_i = t_{i-1}·t_i λ_{i-1} + t_i·t_{i+1} λ_{i+1} + what the link is driven by.
class Waves {
public:
    [[nodiscard]] static std::size_t bytes(int pins) noexcept { return FadingRing::bytes(pins, systems); }
    /// @param memory [bytes()], of zeros at first, on a cache line
    Waves(const RigidCoefficients& c, double step, RigidColumns& columns, std::byte* memory) noexcept
        : c_(c), step_(step), all_(columns), columns_(columns), ring_(columns.pins(), memory) {}

    /// All but the forces, for any number of hold().
    void begin() noexcept {
        const StepInertia inertia(c_, step_);
        const PinLanes duration(step_), stretch = inertia.stretch() / (c_.mass + 2.0 * inertia.stretch());
        for (int i = 0; i < columns_.padded(); i += rigid_lanes) {
            const Plane line = read_plane(columns_, Column::line_x, i), across = turned(line);
            write(columns_, Column::wave_cosine, i, dot(read_plane(columns_, Column::line_x, i - 1), line));
            const PinLanes turn = duration * read(columns_, Column::line_turn, i), yaw = inertia.yaw(columns_, i);
            const auto turning = [&](Column v) { return turn * dot(read_plane(columns_, v, i + 1) - read_plane(columns_, v, i), across); };
            write(columns_, Column::wave_turning, i, c_.mass * turning(Column::vx));
            write(columns_, Column::wave_turning + 1, i, c_.tilt_mass * turning(Column::vp));
            write(columns_, Column::wave_factor, i, stretch);
            write(columns_, Column::wave_factor + 1, i, yaw / (c_.tilt_mass + 2.0 * yaw));
        }
        all_.wrap(Column::wave_cosine, Column::wave_cosine);
        for (int system = 0; system < systems; ++system) {
            for (int i = 0; i < columns_.padded(); i += rigid_lanes) {
                const PinLanes factor = read(columns_, Column::wave_factor + system, i);
                store_rounded<rigid_lanes>(factor * read(columns_, Column::wave_cosine, i), ring_.behind(system) + i);
                store_rounded<rigid_lanes>(factor * read(columns_, Column::wave_cosine, i + 1), ring_.ahead(system) + i);
            }
            ring_.eliminate(system);
        }
    }

    /// Changes v of the velocities in a step by the forces F of the columns wave_force_x …: (M + β h² K) v = h F, K of stretch and yaw
    /// along the pitch lines.
    void hold() noexcept {
        const PinLanes duration(step_);
        for (int i = 0; i < columns_.padded(); i += rigid_lanes) {
            const Plane line = read_plane(columns_, Column::line_x, i);
            for (int system = 0; system < systems; ++system) {
                const Column force = force_of(system);
                const PinLanes parting = dot(read_plane(columns_, force, i + 1) - read_plane(columns_, force, i), line);
                store_rounded<rigid_lanes>(read(columns_, Column::wave_factor + system, i) *
                                               (duration * parting + read(columns_, Column::wave_turning + system, i)),
                                           ring_.free(system) + i);
            }
        }
        for (int system = 0; system < systems; ++system) {
            const float* impulse = ring_.solve(system);
            for (int i = 0; i < columns_.padded(); i += rigid_lanes)
                write(columns_, Column::wave_impulse + system, i, load_widened<rigid_lanes>(impulse + i));
        }
        all_.wrap(Column::wave_impulse, Column::wave_impulse + 1);
        const PinLanes per_inertia[] = {1.0 / c_.mass, 1.0 / c_.tilt_mass};
        for (int i = 0; i < columns_.padded(); i += rigid_lanes) {
            const Plane behind = read_plane(columns_, Column::line_x, i - 1), ahead = read_plane(columns_, Column::line_x, i);
            for (int system = 0; system < systems; ++system) {
                const Column impulse = Column::wave_impulse + system;
                const Plane held = duration * read_plane(columns_, force_of(system), i) + read(columns_, impulse, i) * ahead -
                                   read(columns_, impulse, i - 1) * behind;
                write_plane(columns_, Column::growth_x + 2 * system, i, per_inertia[system] * held);
            }
        }
        all_.wrap(Column::growth_x, Column::growth_q);
    }

private:
    static constexpr int systems = 2;  ///< stretch by x and y, yaw by p and q
    [[nodiscard]] static Column force_of(int system) noexcept { return Column::wave_force_x + 2 * system; }

    const RigidCoefficients& c_;
    const double step_;
    RigidColumns& all_;
    const RigidView columns_;
    FadingRing ring_;
};

/// Change of the moment on pitch line i by this step's tips, as a force on pin i+1.
[[nodiscard, gnu::always_inline]] inline Plane moment_thrust(const RigidView& columns, int i) noexcept {
    const PinLanes change = read(columns, Column::tip_moment, i) - read(columns, Column::tip_moment_before, i);
    return (change * read(columns, Column::line_inverse, i)) * turned(read_plane(columns, Column::line_x, i));
}

/// Accelerations of z and ζ, by those of both halves.
[[gnu::always_inline]] inline void accelerate_along(const RigidView& columns, int i) noexcept {
    const PinLanes both = 0.5 * read(columns, Column::force_z, i), parting = read(columns, Column::force_slide, i);
    const PinLanes friction = read(columns, Column::joint_friction, i);
    const PinLanes front = read(columns, Column::axial_mobility_front, i) *
                           (both + parting + tips_on_front(columns, i) - read(columns, Column::plate_friction, i - 1) - friction);
    const PinLanes rear = read(columns, Column::axial_mobility_rear, i) *
                          (both - parting + tips_on_rear(columns, i) + read(columns, Column::plate_friction, i) + friction);
    write(columns, Column::acceleration_z, i, 0.5 * (front + rear));
    write(columns, Column::acceleration_slide, i, front - rear);
}

inline void accelerate_pins(const RigidCoefficients& c, const RigidKick& kick, RigidColumns& all, std::byte* room) noexcept {
    const RigidView columns(all);
    const PinLanes per_mass(1.0 / c.mass), per_tilt(1.0 / c.tilt_mass), per_bend(1.0 / c.bend_mass);
    Plane last{0.0, 0.0};  // of the eight links before
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const Plane ahead = moment_thrust(columns, i), behind = i == 0 ? moment_thrust(columns, -1) : shifted_by_one_pin(last, ahead);
        last = ahead;
        const Plane middle = read_plane(columns, Column::force_x, i) + read_plane(columns, Column::tip_force_x, i) + behind - ahead;
        const Plane end = read_plane(columns, Column::force_p, i) + read_plane(columns, Column::tip_force_p, i);
        write_plane(columns, Column::wave_force_x, i, middle);
        write_plane(columns, Column::wave_force_p, i, end);
        write_plane(columns, Column::acceleration_x, i, per_mass * middle);
        write_plane(columns, Column::acceleration_p, i, per_tilt * end);
        accelerate_along(columns, i);
        write_plane(columns, Column::acceleration_bend_x, i,
                    per_bend * (read_plane(columns, Column::force_bend_x, i) + read_plane(columns, Column::tip_force_bend_x, i)));
    }
    if (!kick.implicit()) return;
    all.wrap(Column::wave_force_x, Column::wave_force_q);
    Waves(c, kick.step, all, room).hold();
    const PinLanes per_step(1.0 / kick.step);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        for (int k = 0; k < 2; ++k) {
            write(columns, Column::acceleration_x + k, i, per_step * read(columns, Column::growth_x + k, i));
            write(columns, Column::acceleration_p + k, i, per_step * read(columns, Column::growth_p + k, i));
        }
    }
}

/// Changes of the velocities in the plane over the step, with the tips' friction of the last one. @param room [Waves::bytes()]
inline void predict_waves(const RigidCoefficients& c, const RigidKick& kick, RigidColumns& all, std::byte* room) noexcept {
    const RigidView columns(all);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const auto sum = [&](Column links, Column tips) { return read_plane(columns, links, i) + read_plane(columns, tips, i); };
        write_plane(columns, Column::wave_force_x, i, sum(Column::force_x, Column::tip_push_x));
        write_plane(columns, Column::wave_force_p, i, sum(Column::force_p, Column::tip_push_p));
    }
    all.wrap(Column::wave_force_x, Column::wave_force_q);
    Waves waves(c, kick.step, all, room);
    waves.begin();
    waves.hold();
}

inline void drift_pins(double step, RigidColumns& all) noexcept {
    const RigidView columns(all);
    for (int k = 0; k < rigid_coordinates; ++k) {
        for (int i = 0; i < columns.padded(); i += rigid_lanes)
            write(columns, Column::x + k, i, read(columns, Column::x + k, i) + step * read(columns, Column::vx + k, i));
    }
}

/// ½ κ u' v' of the rates of stretch and yaw of link i, and of pin i on its contacts, before and after a kick: what they add to ½ v·M v'
/// [J].
[[nodiscard, gnu::always_inline]] inline PinLanes implicit_energy(const StepInertia& inertia, double step, const RigidView& columns,
                                                                  int i) noexcept {
    const Plane t = read_plane(columns, Column::line_x, i);
    const auto product = [&](Column velocity, Column acceleration) {
        const PinLanes before = dot(read_plane(columns, velocity, i + 1) - read_plane(columns, velocity, i), t);
        const PinLanes change = dot(read_plane(columns, acceleration, i + 1) - read_plane(columns, acceleration, i), t);
        return before * (before + step * change);
    };
    const auto of_half = [&](double share) {
        const PinLanes before = read(columns, Column::vz, i) + share * read(columns, Column::vslide, i);
        return before * (before + step * (read(columns, Column::acceleration_z, i) + share * read(columns, Column::acceleration_slide, i)));
    };
    return 0.5 * (inertia.stretch() * product(Column::vx, Column::acceleration_x) +
                  inertia.yaw(columns, i) * product(Column::vp, Column::acceleration_p) + inertia.contact(columns, i, 0) * of_half(0.5) +
                  inertia.contact(columns, i, 1) * of_half(-0.5));
}

/// @return ½ v·M v' of the velocities before and after, M with the inertia of the implicit forces [J]
inline double kick_pins(const RigidCoefficients& c, double step, RigidColumns& all) noexcept {
    const RigidView columns(all);
    PinSum energy(columns);
    all.wrap(Column::acceleration_x, Column::acceleration_q);
    const StepInertia inertia(c, step);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        PinLanes of_pins = implicit_energy(inertia, step, columns, i);
        for (int k = 0; k < rigid_coordinates; ++k) {
            const PinLanes before = read(columns, Column::vx + k, i), v = before + step * read(columns, Column::acceleration_x + k, i);
            of_pins += (0.5 * c.inertia(k)) * (before * v);
            write(columns, Column::vx + k, i, v);
        }
        energy.add(i, of_pins);
    }
    return energy.value();
}

}  // namespace
}  // namespace cvtflow::model
