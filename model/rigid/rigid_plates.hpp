#pragma once
/// Friction between the plates of neighbouring links along the pin that they share, of the whole chain at once; and from the sum of all
/// forces on a pin to its motion. (model/EQUATIONS.md section 11)

#include <algorithm>

#include "model/law/friction_laws.hpp"
#include "model/rigid/rigid_kernels.hpp"
#include "model/rigid/rigid_links.hpp"
#include "model/rigid/rigid_vectors.hpp"

namespace cvtflow::model {
namespace {

/// Distribution of the chain's links over lanes: lane L has links begin(L) … begin(L + 1) - 1, in the last of its rows; rows before them
/// are absent. A chain of fewer than 8 links is repeated, which does not change the solution.
struct RingShares {
    int pins, links, rows;

    explicit RingShares(int pins_of_chain) noexcept
        : pins(pins_of_chain),
          links(pins >= rigid_lanes ? pins : (rigid_lanes + pins - 1) / pins * pins),
          rows(std::max(2, (links + rigid_lanes - 1) / rigid_lanes)) {}

    [[nodiscard]] int begin(int lane) const noexcept { return links * lane / rigid_lanes; }
    [[nodiscard]] int absent(int lane) const noexcept { return rows - (begin(lane + 1) - begin(lane)); }
    /// Calls visit(place in the rows, link). In a chain that is repeated, links after the last one are copies in the columns.
    template <class Visit>
    void for_links(const Visit& visit) const noexcept {
        for (int lane = 0; lane < rigid_lanes; ++lane) {
            const int skipped = absent(lane), first = begin(lane) - skipped;
            for (int row = skipped; row < rows; ++row) visit(row * rigid_lanes + lane, first + row);
        }
    }
    [[nodiscard]] PinLanes absent_rows() const noexcept {
        PinLanes all;
        for (int lane = 0; lane < rigid_lanes; ++lane) all.set(static_cast<std::size_t>(lane), absent(lane));
        return all;
    }
};

/// Lane L + by of a vector, around the ring of lanes.
template <int by, int W = rigid_lanes>
[[nodiscard]] inline Lanes<W> neighbour(const Lanes<W>& lanes) noexcept {
    return lanes_across<(by + W) % W>(lanes, lanes);
}

/// x_L = free + behind x_{L-by} + ahead x_{L+by}: one unknown per lane.
struct LaneRing {
    PinLanes free, behind, ahead;

    /// The ring of lanes at twice the distance.
    template <int by>
    [[nodiscard]] LaneRing halved() const noexcept {
        const PinLanes to = neighbour<-by>(ahead), from = neighbour<by>(behind);
        const PinLanes inverse = 1.0 / (1.0 - behind * to - ahead * from);
        return {(free + behind * neighbour<-by>(free) + ahead * neighbour<by>(free)) * inverse, behind * neighbour<-by>(behind) * inverse,
                ahead * neighbour<by>(ahead) * inverse};
    }
    [[nodiscard]] PinLanes solution() const noexcept {
        static_assert(rigid_lanes == 8);
        const LaneRing opposite = halved<1>().halved<2>();  // both neighbours are the same lane
        const PinLanes both = opposite.behind + opposite.ahead;
        return (opposite.free + both * neighbour<4>(opposite.free)) / (1.0 - both * neighbour<4>(both));
    }
};

/// Friction P of all links, (1 + aF (4 - β_i - β_{i+1})) P_i - aF (β_i P_{i-1} + β_{i+1} P_{i+1}) = B_i around the ring: F friction per
/// sliding speed (ring_secant), B friction if no link's friction changed the sliding (ring_rhs), β_i the degree to which the halves of pin
/// i stick together (ring_coupling_…), a of a pin's speed per force over the step [m/s/N]. Each lane eliminates its links but the last:
/// P_r = friction + behind P_{last of the lane before} + ahead P_{r+1}; the remaining system has one unknown per lane.
inline void solve_ring(const RingShares& shares, double a, const RigidView& columns) noexcept {
    const PinLanes absent = shares.absent_rows();
    const int last = (shares.rows - 1) * rigid_lanes;
    PinLanes friction(0.0), behind(1.0), ahead(0.0);
    PinLanes first_friction(0.0), first_behind(0.0), first_ahead(1.0);  // P of a lane's first link by those of both last ones
    for (int at = 0, row = 0; at < last; at += rigid_lanes, ++row) {
        const PinLanes number(row), secant = read(columns, Column::ring_secant, at), coupling = PinLanes(a) * secant;
        const PinLanes back = coupling * read(columns, Column::ring_coupling_rear, at),
                       on = coupling * read(columns, Column::ring_coupling_front, at);
        const PinLanes inverse = 1.0 / ((1.0 + 4.0 * coupling - back - on) - back * ahead);  // each row waits for this
        friction = (read(columns, Column::ring_rhs, at) + back * friction) * inverse;
        behind = select_greater<rigid_lanes>(absent, number, behind, back * behind * inverse);
        ahead = on * inverse;
        first_friction += first_ahead * friction;
        first_behind += select_greater<rigid_lanes>(absent, number, PinLanes(0.0), first_ahead * behind);
        first_ahead = select_greater<rigid_lanes>(absent, number, first_ahead, first_ahead * ahead);
        write(columns, Column::ring_solution, at, friction);
        write(columns, Column::ring_lower, at, behind);
        write(columns, Column::ring_upper, at, ahead);
    }
    const PinLanes secant = read(columns, Column::ring_secant, last), coupling = PinLanes(a) * secant;
    const PinLanes back = coupling * read(columns, Column::ring_coupling_rear, last),
                   on = coupling * read(columns, Column::ring_coupling_front, last);
    const PinLanes inverse = 1.0 / (1.0 + 4.0 * coupling - back * (1.0 + ahead) - on * (1.0 + neighbour<1>(first_behind)));
    const PinLanes free = read(columns, Column::ring_rhs, last) + back * friction + on * neighbour<1>(first_friction);
    PinLanes next = LaneRing{free * inverse, back * behind * inverse, on * neighbour<1>(first_ahead) * inverse}.solution();
    const PinLanes before = neighbour<-1>(next);
    write(columns, Column::ring_solution, last, next);
    for (int at = last - rigid_lanes; at >= 0; at -= rigid_lanes) {
        next = read(columns, Column::ring_solution, at) + read(columns, Column::ring_lower, at) * before +
               read(columns, Column::ring_upper, at) * next;
        write(columns, Column::ring_solution, at, next);
    }
}

/// Solves for the friction at the end of the step, with the friction per speed of the last step.
inline void solve_friction(double step_per_mass, RigidColumns& columns) noexcept {
    const RingShares shares(columns.pins());
    columns.wrap(Column::plate_rhs, Column::plate_secant);
    double *rhs = columns[Column::ring_rhs], *secant = columns[Column::ring_secant], *friction = columns[Column::plate_friction];
    double *behind = columns[Column::ring_coupling_rear], *ahead = columns[Column::ring_coupling_front];
    const double *rhs_of = columns[Column::plate_rhs], *secant_of = columns[Column::plate_secant],
                 *solution = columns[Column::ring_solution];
    const double* coupling_of = columns[Column::joint_coupling];
    shares.for_links([&](int place, int link) {
        rhs[place] = rhs_of[link];
        secant[place] = secant_of[link];
        behind[place] = coupling_of[link];
        ahead[place] = coupling_of[link + 1];
    });
    solve_ring(shares, step_per_mass, RigidView(columns));
    shares.for_links([&](int place, int link) { friction[link] = solution[place]; });
    columns.wrap(Column::plate_friction, Column::plate_friction);
}

/// Sliding speed that the lengthening of both pins adds at the plates at +z, and subtracts at those at -z [m/s].
[[nodiscard]] inline PinLanes plate_parting(const RigidCoefficients& c, const RigidView& columns, int i) noexcept {
    return c.plate_reach * (read(columns, Column::lengthening, i + 1) - read(columns, Column::lengthening, i));
}

/// Share of the change of the tips' normal forces since the last step that friction along the pins takes into account. With the rest, pins
/// that plates hold oscillate with the factor h² tip_stiffness/m, at most 4 for any stable step of a leapfrog.
constexpr double expected_share = 0.75;

/// Sliding speed to be expected at the end of this step, extrapolated from those at the ends of the last two; the last one then becomes the
/// one before. With the sliding speed of the last step friction lags by a step, which is most of a step's error.
[[nodiscard, gnu::always_inline]] inline PinLanes expected_slip(const RigidView& columns, Column slip, Column before, int i) noexcept {
    const PinLanes last = read(columns, slip, i), expected = abs(2.0 * last - read(columns, before, i));
    write(columns, before, i, last);
    return expected;
}

/// Velocities of the pins and of their halves on each other along z, and the friction per speed of the halves, before plates rub. Forces of
/// the tips are those of the last step and their expected change: by the tips' stiffness, and by their damping as velocities changed in the
/// last step.
inline void free_slips(const RigidCoefficients& c, const RigidKick& kick, RigidColumns& all) noexcept {
    const RigidView columns(all);
    const PinLanes half_share(0.5 * expected_share * kick.step), half_step(0.5 * kick.step);
    const PinLanes per_slide(kick.step / c.slide_mass), per_mass(kick.step / c.mass);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const PinLanes along = read(columns, Column::vz, i), apart = read(columns, Column::vslide, i);
        const PinLanes faster = kick.implicit() ? read(columns, Column::acceleration_z, i) : PinLanes(0.0),
                       parting = kick.implicit() ? 0.5 * read(columns, Column::acceleration_slide, i) : PinLanes(0.0);
        const auto half_change = [&](int half, const PinLanes& speed, const PinLanes& acceleration) {
            const PinLanes stiffness = read(columns, Column::tip_stiffness_front + half, i);
            return half_share * (read(columns, Column::tip_loading_front + half, i) - stiffness * speed) -
                   half_step * (read(columns, Column::tip_damping_front + half, i) * acceleration);
        };
        const PinLanes front = half_change(0, along + 0.5 * apart, faster + parting),
                       rear = half_change(1, along - 0.5 * apart, faster - parting);
        const PinLanes on_slide = read(columns, Column::tip_force_slide, i) + (front - rear);
        const PinLanes on_pin = read(columns, Column::force_z, i) + read(columns, Column::tip_force_z, i) + 2.0 * (front + rear);
        const PinLanes drive = apart + per_slide * (read(columns, Column::force_slide, i) + on_slide);
        const PinLanes speed = kick.implicit() ? expected_slip(columns, Column::joint_slip, Column::joint_slip_before, i) : abs(drive);
        const PinLanes secant =
            c.joint_friction.coefficient * read(columns, Column::joint_normal, i) * slip_factor<rigid_lanes>(c.joint_friction, speed);
        const PinLanes held = secant / (1.0 + per_slide * secant);
        write(columns, Column::axial_free_speed, i, along + per_mass * on_pin);
        write(columns, Column::tip_force_slide_expected, i, on_slide);
        write(columns, Column::joint_free_slip, i, drive);
        write(columns, Column::joint_secant, i, held);
        write(columns, Column::joint_coupling, i, per_slide * held);
    }
    all.wrap(Column::joint_free_slip, Column::tip_force_slide_expected);
}

/// Friction of the halves of a pin on each other along it, after that of the plates on both and with the expected forces of the tips.
inline void joint_friction_expected(const RigidCoefficients& c, const RigidKick& kick, RigidColumns& all) noexcept {
    const RigidView columns(all);
    const PinLanes per_slide(kick.step / c.slide_mass);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const PinLanes plates = 0.5 * (read(columns, Column::plate_friction, i - 1) + read(columns, Column::plate_friction, i));
        const PinLanes drive = read(columns, Column::joint_free_slip, i) - per_slide * plates;
        write(columns, Column::joint_free_slip, i, drive);
        write(columns, Column::joint_friction, i, read(columns, Column::joint_secant, i) * drive);
    }
}

/// Updates the friction of the joints with the tips' forces of this step.
inline void joint_friction(const RigidCoefficients& c, const RigidKick& kick, RigidColumns& all, Account& account) noexcept {
    const RigidView columns(all);
    PinSum lost(columns);
    const PinLanes per_slide(kick.step / c.slide_mass);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const PinLanes change = read(columns, Column::tip_force_slide, i) - read(columns, Column::tip_force_slide_expected, i);
        const PinLanes drive = read(columns, Column::joint_free_slip, i) + per_slide * change;
        const PinLanes friction = read(columns, Column::joint_secant, i) * drive;
        const PinLanes acting = kick.implicit() ? 0.5 * (friction + read(columns, Column::joint_friction_before, i)) : friction;
        lost.add(i, acting * read(columns, Column::vslide, i));
        write(columns, Column::joint_friction, i, friction);
        write(columns, Column::joint_slip, i, drive - per_slide * friction);
    }
    account.lose(Loss::joint_friction, lost.value());
}

/// Force on ζ by the friction of plates and of the other half.
[[nodiscard, gnu::always_inline]] inline PinLanes friction_on_slide(const RigidView& columns, int i) noexcept {
    return -(0.5 * (read(columns, Column::plate_friction, i - 1) + read(columns, Column::plate_friction, i)) +
             read(columns, Column::joint_friction, i));
}

/// Change of the sliding speed of link i by the friction of the links, over the step per mass.
[[nodiscard, gnu::always_inline]] inline PinLanes slowing(const RigidView& columns, int i) noexcept {
    const PinLanes friction = read(columns, Column::plate_friction, i), behind = read(columns, Column::joint_coupling, i),
                   ahead = read(columns, Column::joint_coupling, i + 1);
    return behind * (read(columns, Column::plate_friction, i - 1) + friction) +
           ahead * (friction + read(columns, Column::plate_friction, i + 1)) - 4.0 * friction;
}

/// Sliding speeds of the plates before they rub, their friction per sliding speed, and the friction at those speeds.
inline void grip_plates(const RigidCoefficients& c, const RigidKick& kick, const RigidView& columns) noexcept {
    const auto parted = [&](int i) {
        return 0.5 * (1.0 - read(columns, Column::joint_coupling, i)) * read(columns, Column::joint_free_slip, i);
    };
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const PinLanes capacity = (0.5 * c.plate_friction.coefficient) * positive_part<rigid_lanes>(read(columns, Column::tension, i));
        const PinLanes parting = plate_parting(c, columns, i);
        const PinLanes drive =
            read(columns, Column::axial_free_speed, i + 1) - read(columns, Column::axial_free_speed, i) + parted(i + 1) + parted(i);
        const auto grip_at = [&](const PinLanes& now, Column slip, Column before) {
            return capacity *
                   slip_factor<rigid_lanes>(c.plate_friction, kick.implicit() ? expected_slip(columns, slip, before, i) : abs(now));
        };
        const PinLanes low = grip_at(drive - parting, Column::plate_slip_low, Column::plate_slip_low_before),
                       high = grip_at(drive + parting, Column::plate_slip_high, Column::plate_slip_high_before);
        const PinLanes rhs = low * (drive - parting) + high * (drive + parting);
        write(columns, Column::plate_secant, i, low + high);
        write(columns, Column::plate_secant_high, i, high);
        write(columns, Column::plate_free_slip, i, drive);
        write(columns, Column::plate_rhs, i, rhs);
        if (!kick.implicit()) write(columns, Column::plate_friction, i, rhs);
    }
}

/// Friction of the plates of neighbouring links along the pin that they share, and of its halves on each other. The sliding speeds at the
/// end of the step are kept for the next one. The loss by the pins' lengthening is counted with the tips that do its work.
inline void plate_friction(const RigidCoefficients& c, const RigidKick& kick, RigidColumns& all, Account& account) noexcept {
    const RigidView columns(all);
    PinSum lost(columns);
    const PinLanes per_mass(kick.step / c.mass);
    free_slips(c, kick, all);
    grip_plates(c, kick, columns);
    if (kick.implicit()) solve_friction(kick.step / c.mass, all);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const PinLanes friction = read(columns, Column::plate_friction, i), parting = plate_parting(c, columns, i);
        const PinLanes speed = axial_parting(columns, Column::vz, Column::vslide, i);
        lost.add(i, (kick.implicit() ? 0.5 * (friction + read(columns, Column::plate_friction_before, i)) : friction) * speed);
        const PinLanes slide = read(columns, Column::plate_free_slip, i) + per_mass * slowing(columns, i);
        const PinLanes high = read(columns, Column::plate_secant_high, i);
        write(columns, Column::plate_friction_moment, i, 2.0 * (high * (slide + parting)) - friction);
        write(columns, Column::plate_slip_low, i, slide - parting);
        write(columns, Column::plate_slip_high, i, slide + parting);
    }
    account.lose(Loss::plate_friction, lost.value());
    all.wrap(Column::plate_friction, Column::plate_friction_moment);
    joint_friction_expected(c, kick, all);
}

/// Change of the moment on pitch line i by this step's tips, as a force on pin i+1.
[[nodiscard, gnu::always_inline]] inline Plane moment_thrust(const RigidView& columns, int i) noexcept {
    const PinLanes change = read(columns, Column::tip_moment, i) - read(columns, Column::tip_moment_before, i);
    return (change * read(columns, Column::line_inverse, i)) * turned(read_plane(columns, Column::line_x, i));
}

inline void accelerate_pins(const RigidCoefficients& c, RigidColumns& all) noexcept {
    const RigidView columns(all);
    const PinLanes per_mass(1.0 / c.mass), per_tilt(1.0 / c.tilt_mass), per_slide(1.0 / c.slide_mass), per_bend(1.0 / c.bend_mass);
    Plane last{0.0, 0.0};  // of the eight links before
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const Plane ahead = moment_thrust(columns, i), behind = i == 0 ? moment_thrust(columns, -1) : shifted_by_one_pin(last, ahead);
        last = ahead;
        const Plane force = read_plane(columns, Column::force_x, i) + read_plane(columns, Column::tip_force_x, i) + behind - ahead;
        const PinLanes rubbing = read(columns, Column::plate_friction, i) - read(columns, Column::plate_friction, i - 1);
        write_plane(columns, Column::acceleration_x, i, per_mass * force);
        write(columns, Column::acceleration_z, i,
              per_mass * (read(columns, Column::force_z, i) + read(columns, Column::tip_force_z, i) + rubbing));
        write_plane(columns, Column::acceleration_p, i,
                    per_tilt * (read_plane(columns, Column::force_p, i) + read_plane(columns, Column::tip_force_p, i)));
        write_plane(columns, Column::acceleration_bend_x, i,
                    per_bend * (read_plane(columns, Column::force_bend_x, i) + read_plane(columns, Column::tip_force_bend_x, i)));
        write(columns, Column::acceleration_slide, i,
              per_slide *
                  (read(columns, Column::force_slide, i) + read(columns, Column::tip_force_slide, i) + friction_on_slide(columns, i)));
    }
}

inline void drift_pins(double step, RigidColumns& all) noexcept {
    const RigidView columns(all);
    for (int k = 0; k < rigid_coordinates; ++k) {
        for (int i = 0; i < columns.padded(); i += rigid_lanes)
            write(columns, Column::x + k, i, read(columns, Column::x + k, i) + step * read(columns, Column::vx + k, i));
    }
}

/// @return ½ v·M v' of the velocities before and after [J]
inline double kick_pins(const RigidCoefficients& c, double step, RigidColumns& all) noexcept {
    const RigidView columns(all);
    PinSum energy(columns);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        PinLanes of_pins(0.0);
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
