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

/// How the links of the chain are shared out over lanes: lane L has links begin(L) … begin(L + 1) - 1, in the last of its rows; rows in
/// front of them are absent. A chain of fewer than 8 links is repeated, which does not change the solution.
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

/// x of all links, (1 + excess_i) x_i - rear_i x_{i-1} - front_i x_{i+1} = rhs_i around the ring, of systems with the same rear and front
/// side by side. Each lane eliminates its links but the last, x_r = free + behind x_{last of the lane before} + ahead x_{r+1}; the
/// remaining system has one unknown per lane.
/// @tparam systems 1 or 2
template <std::size_t systems>
class LinkRing {
public:
    using OfSystems = std::array<Column, systems>;

    explicit LinkRing(RigidColumns& columns) noexcept
        : shares_(columns.pins()), columns_(columns), last_((shares_.rows - 1) * rigid_lanes) {}

    /// All but the right-hand sides, for any number of solve(). @param front entries link + shift of it
    void eliminate(const OfSystems& excess, Column rear, Column front, int shift) noexcept {
        double *behind = columns_[Column::ring_rear], *ahead = columns_[Column::ring_front];
        const double *from_rear = columns_[rear], *from_front = columns_[front] + shift;
        shares_.for_links([&](int place, int link) {
            behind[place] = from_rear[link];
            ahead[place] = from_front[link];
        });
        for (std::size_t s = 0; s < systems; ++s) gather(excess[s], of_system(Column::ring_excess, s));
        const PinLanes absent = shares_.absent_rows();
        Factors factors[systems];
        for (int at = 0, row = 0; at < last_; at += rigid_lanes, ++row) {
            for (std::size_t s = 0; s < systems; ++s) eliminate(factors[s], s, at, absent, PinLanes(row));
        }
        for (std::size_t s = 0; s < systems; ++s) eliminate_last(factors[s], s);
    }

    void solve(const OfSystems& rhs, const OfSystems& solution) noexcept {
        PinLanes free[systems], first[systems], before[systems];
        for (std::size_t s = 0; s < systems; ++s) {
            gather(rhs[s], of_system(Column::ring_rhs, s));
            free[s] = first[s] = PinLanes(0.0);
        }
        for (int at = 0; at < last_; at += rigid_lanes) {
            for (std::size_t s = 0; s < systems; ++s) {
                free[s] =
                    (get(Column::ring_rhs, s, at) + read(columns_, Column::ring_rear, at) * free[s]) * get(Column::ring_inverse, s, at);
                first[s] += get(Column::ring_first, s, at) * free[s];
                put(Column::ring_solution, s, at, free[s]);
            }
        }
        for (std::size_t s = 0; s < systems; ++s) {
            const PinLanes rest = get(Column::ring_rhs, s, last_) + read(columns_, Column::ring_rear, last_) * free[s] +
                                  read(columns_, Column::ring_front, last_) * neighbour<1>(first[s]);
            free[s] =
                LaneRing{rest * get(Column::ring_inverse, s, last_), get(Column::ring_lower, s, last_), get(Column::ring_upper, s, last_)}
                    .solution();
            before[s] = neighbour<-1>(free[s]);
            put(Column::ring_solution, s, last_, free[s]);
        }
        for (int at = last_ - rigid_lanes; at >= 0; at -= rigid_lanes) {
            for (std::size_t s = 0; s < systems; ++s) {
                free[s] = get(Column::ring_solution, s, at) + get(Column::ring_lower, s, at) * before[s] +
                          get(Column::ring_upper, s, at) * free[s];
                put(Column::ring_solution, s, at, free[s]);
            }
        }
        for (std::size_t s = 0; s < systems; ++s) {
            double* to = columns_[solution[s]];
            const double* from = columns_[of_system(Column::ring_solution, s)];
            shares_.for_links([&](int place, int link) { to[link] = from[place]; });
        }
    }

private:
    /// Of the row before; first_…: x of a lane's first link by x of both last ones.
    struct Factors {
        PinLanes behind{1.0}, ahead{0.0}, first_behind{0.0}, first_ahead{1.0};
    };

    [[nodiscard]] static Column of_system(Column first, std::size_t s) noexcept { return first + static_cast<int>(s); }
    [[nodiscard]] PinLanes get(Column first, std::size_t s, int at) const noexcept { return read(columns_, of_system(first, s), at); }
    void put(Column first, std::size_t s, int at, const PinLanes& value) noexcept { write(columns_, of_system(first, s), at, value); }
    void gather(Column of, Column to) noexcept {
        double* rows = columns_[to];
        const double* from = columns_[of];
        shares_.for_links([&](int place, int link) { rows[place] = from[link]; });
    }
    [[gnu::always_inline]] void eliminate(Factors& f, std::size_t s, int at, const PinLanes& absent, const PinLanes& row) noexcept {
        const PinLanes back = read(columns_, Column::ring_rear, at);
        const PinLanes inverse = 1.0 / ((1.0 + get(Column::ring_excess, s, at)) - back * f.ahead);  // each row waits for this
        f.behind = select_greater<rigid_lanes>(absent, row, f.behind, back * f.behind * inverse);
        f.ahead = read(columns_, Column::ring_front, at) * inverse;
        put(Column::ring_first, s, at, f.first_ahead);
        f.first_behind += select_greater<rigid_lanes>(absent, row, PinLanes(0.0), f.first_ahead * f.behind);
        f.first_ahead = select_greater<rigid_lanes>(absent, row, f.first_ahead, f.first_ahead * f.ahead);
        put(Column::ring_inverse, s, at, inverse);
        put(Column::ring_lower, s, at, f.behind);
        put(Column::ring_upper, s, at, f.ahead);
    }
    void eliminate_last(const Factors& f, std::size_t s) noexcept {
        const PinLanes back = read(columns_, Column::ring_rear, last_), on = read(columns_, Column::ring_front, last_);
        const PinLanes inverse = 1.0 / ((1.0 + get(Column::ring_excess, s, last_)) - back * f.ahead - on * neighbour<1>(f.first_behind));
        put(Column::ring_inverse, s, last_, inverse);
        put(Column::ring_lower, s, last_, back * f.behind * inverse);
        put(Column::ring_upper, s, last_, on * neighbour<1>(f.first_ahead) * inverse);
    }

    const RingShares shares_;
    const RigidView columns_;
    const int last_;  ///< where the last row begins
};

/// Friction P_i of all links of the velocities that the step leaves behind, by the friction per speed that the last step has left:
/// (1 + aF (4 - β_i - β_{i+1})) P_i - aF (β_i P_{i-1} + β_{i+1} P_{i+1}) = B_i; F friction per sliding speed (plate_secant), B friction if
/// no link's friction changed the sliding (plate_rhs), β_i the degree to which the halves of pin i stick together (joint_coupling), a of a
/// pin's speed per force over the step [m/s/N].
inline void solve_friction(double step_per_mass, RigidColumns& all) noexcept {
    const RigidView columns(all);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const PinLanes coupling = step_per_mass * read(columns, Column::plate_secant, i);
        const PinLanes rear = coupling * read(columns, Column::joint_coupling, i),
                       front = coupling * read(columns, Column::joint_coupling, i + 1);
        write(columns, Column::plate_rear, i, rear);
        write(columns, Column::plate_front, i, front);
        write(columns, Column::plate_excess, i, 4.0 * coupling - rear - front);
    }
    all.wrap(Column::plate_rhs, Column::plate_rhs);
    all.wrap(Column::plate_excess, Column::plate_front);
    LinkRing<1> ring(all);
    ring.eliminate({Column::plate_excess}, Column::plate_rear, Column::plate_front, 0);
    ring.solve({Column::plate_rhs}, {Column::plate_friction});
    all.wrap(Column::plate_friction, Column::plate_friction);
}

/// Sliding speed that the lengthening of both pins adds at the plates at +z, and subtracts at those at -z [m/s].
[[nodiscard]] inline PinLanes plate_parting(const RigidCoefficients& c, const RigidView& columns, int i) noexcept {
    return c.plate_reach * (read(columns, Column::lengthening, i + 1) - read(columns, Column::lengthening, i));
}

/// Share of the change of the tips' normal forces since the last step that friction along the pins takes into account. With the rest, pins
/// that plates hold oscillate with the factor h² tip_stiffness/m, at most 4 for any stable step of a leapfrog.
constexpr double expected_share = 0.75;

/// Velocities of the pins and of their halves on each other along z, and the halves' grip, before plates rub. Forces of the tips are those
/// of the last step and what is expected to be added since.
inline void free_slips(const RigidCoefficients& c, const RigidKick& kick, RigidColumns& all) noexcept {
    const RigidView columns(all);
    const PinLanes half_step(0.5 * expected_share * kick.step), per_slide(kick.step / c.slide_mass), per_mass(kick.step / c.mass);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const PinLanes along = read(columns, Column::vz, i), apart = read(columns, Column::vslide, i);
        const auto half_change = [&](int half, const PinLanes& speed) {
            const PinLanes stiffness = read(columns, Column::tip_stiffness_front + half, i);
            return half_step * (read(columns, Column::tip_loading_front + half, i) - stiffness * speed);
        };
        const PinLanes front = half_change(0, along + 0.5 * apart), rear = half_change(1, along - 0.5 * apart);
        const PinLanes on_slide = read(columns, Column::tip_force_slide, i) + (front - rear);
        const PinLanes on_pin = read(columns, Column::force_z, i) + read(columns, Column::tip_force_z, i) + 2.0 * (front + rear);
        const PinLanes drive = apart + per_slide * (read(columns, Column::force_slide, i) + on_slide);
        const PinLanes speed = kick.implicit() ? read(columns, Column::joint_slip, i) : abs(drive);
        const PinLanes grip =
            c.joint_friction.coefficient * read(columns, Column::joint_normal, i) * slip_factor<rigid_lanes>(c.joint_friction, speed);
        const PinLanes held = grip / (1.0 + per_slide * grip);
        write(columns, Column::axial_free_speed, i, along + per_mass * on_pin);
        write(columns, Column::tip_force_slide_expected, i, on_slide);
        write(columns, Column::joint_free_slip, i, drive);
        write(columns, Column::joint_secant, i, held);
        write(columns, Column::joint_coupling, i, per_slide * held);
    }
    all.wrap(Column::joint_free_slip, Column::tip_force_slide_expected);
}

/// Friction of the halves of a pin on each other along it, behind that of the plates on both and with the tips' forces as expected.
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
        write(columns, Column::joint_slip, i, abs(drive - per_slide * friction));
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

/// Plates of neighbouring links rub along the pin that they share, and its halves on each other. The sliding speeds that a step leaves
/// behind are kept for the next one. The loss by the pins' lengthening is counted with the tips that do its work.
inline void plate_friction(const RigidCoefficients& c, const RigidKick& kick, RigidColumns& all, Account& account) noexcept {
    const RigidView columns(all);
    PinSum lost(columns);
    free_slips(c, kick, all);
    const PinLanes per_mass(kick.step / c.mass);
    const auto parted = [&](int i) {
        return 0.5 * (1.0 - read(columns, Column::joint_coupling, i)) * read(columns, Column::joint_free_slip, i);
    };
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const PinLanes capacity = (0.5 * c.plate_friction.coefficient) * positive_part<rigid_lanes>(read(columns, Column::tension, i));
        const PinLanes parting = plate_parting(c, columns, i);
        const PinLanes drive =
            read(columns, Column::axial_free_speed, i + 1) - read(columns, Column::axial_free_speed, i) + parted(i + 1) + parted(i);
        const auto grip_at = [&](const PinLanes& now, Column kept) {
            return capacity * slip_factor<rigid_lanes>(c.plate_friction, kick.implicit() ? read(columns, kept, i) : abs(now));
        };
        const PinLanes low = grip_at(drive - parting, Column::plate_slip_low), high = grip_at(drive + parting, Column::plate_slip_high);
        const PinLanes push = low * (drive - parting) + high * (drive + parting);
        write(columns, Column::plate_secant, i, low + high);
        write(columns, Column::plate_secant_high, i, high);
        write(columns, Column::plate_free_slip, i, drive);
        write(columns, Column::plate_rhs, i, push);
        if (!kick.implicit()) write(columns, Column::plate_friction, i, push);
    }
    if (kick.implicit()) solve_friction(kick.step / c.mass, all);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const PinLanes friction = read(columns, Column::plate_friction, i), parting = plate_parting(c, columns, i);
        const PinLanes speed = axial_parting(columns, Column::vz, Column::vslide, i);
        lost.add(i, (kick.implicit() ? 0.5 * (friction + read(columns, Column::plate_friction_before, i)) : friction) * speed);
        const PinLanes slide = read(columns, Column::plate_free_slip, i) + per_mass * slowing(columns, i);
        const PinLanes high = read(columns, Column::plate_secant_high, i);
        write(columns, Column::plate_friction_moment, i, 2.0 * (high * (slide + parting)) - friction);
        write(columns, Column::plate_slip_low, i, abs(slide - parting));
        write(columns, Column::plate_slip_high, i, abs(slide + parting));
    }
    account.lose(Loss::plate_friction, lost.value());
    all.wrap(Column::plate_friction, Column::plate_friction_moment);
    joint_friction_expected(c, kick, all);
}

/// Inertia κ = β h² k that a step h adds against the rate of a link's stretch and yaw.
class StepInertia {
public:
    StepInertia(const RigidCoefficients& c, double step) noexcept
        : per_stiffness_(wave_share * step * step), stretch_(wave_share * step * step * c.pull.stiffness) {}
    [[nodiscard]] PinLanes stretch() const noexcept { return stretch_; }  ///< [kg]
    [[nodiscard, gnu::always_inline]] PinLanes yaw(const RigidView& columns, int i) const noexcept {
        return per_stiffness_ * read(columns, Column::yaw_stiffness, i);
    }

private:
    PinLanes per_stiffness_, stretch_;
};

inline constexpr std::array<Column, 2> of_stretch_and_yaw(Column first) noexcept { return {first, first + 1}; }

/// The left side of the equations of the links' impulses λ_i = κ_i t_i·(v_{i+1} - v_i), v the changes of velocities in a step:
/// (m/κ_i + 2) λ_i - t_{i-1}·t_i λ_{i-1} - t_i·t_{i+1} λ_{i+1}.
inline void begin_waves(const RigidCoefficients& c, double step, RigidColumns& all) noexcept {
    const RigidView columns(all);
    const StepInertia inertia(c, step);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        write(columns, Column::wave_cosine, i, dot(read_plane(columns, Column::line_x, i - 1), read_plane(columns, Column::line_x, i)));
        write(columns, Column::wave_excess, i, 1.0 + c.mass / inertia.stretch());
        write(columns, Column::wave_excess + 1, i, 1.0 + c.tilt_mass / inertia.yaw(columns, i));
    }
    all.wrap(Column::wave_cosine, Column::wave_cosine);
    all.wrap(Column::wave_excess, Column::wave_excess + 1);
    LinkRing<2>(all).eliminate(of_stretch_and_yaw(Column::wave_excess), Column::wave_cosine, Column::wave_cosine, 1);
}

/// Changes v of the velocities in a step by the forces F of the columns wave_force_x …: (M + β h² K) v = h F, K of stretch and yaw along
/// the pitch lines. Behind begin_waves().
inline void hold_waves(const RigidCoefficients& c, double step, RigidColumns& all) noexcept {
    const RigidView columns(all);
    const PinLanes per_mass(1.0 / c.mass), per_tilt(1.0 / c.tilt_mass), duration(step);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const Plane t = read_plane(columns, Column::line_x, i);
        const auto parting = [&](Column of) { return dot(read_plane(columns, of, i + 1) - read_plane(columns, of, i), t); };
        write(columns, Column::wave_rhs, i, duration * parting(Column::wave_force_x));
        write(columns, Column::wave_rhs + 1, i, duration * parting(Column::wave_force_p));
    }
    all.wrap(Column::wave_rhs, Column::wave_rhs + 1);
    LinkRing<2>(all).solve(of_stretch_and_yaw(Column::wave_rhs), of_stretch_and_yaw(Column::wave_impulse));
    all.wrap(Column::wave_impulse, Column::wave_impulse + 1);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const Plane behind = read_plane(columns, Column::line_x, i - 1), ahead = read_plane(columns, Column::line_x, i);
        const auto held = [&](Column force, Column impulse) {
            return duration * read_plane(columns, force, i) + read(columns, impulse, i) * ahead - read(columns, impulse, i - 1) * behind;
        };
        write_plane(columns, Column::growth_x, i, per_mass * held(Column::wave_force_x, Column::wave_impulse));
        write_plane(columns, Column::growth_p, i, per_tilt * held(Column::wave_force_p, Column::wave_impulse + 1));
    }
    all.wrap(Column::growth_x, Column::growth_q);
}

/// Change of the moment on pitch line i by this step's tips, as a force on pin i+1.
[[nodiscard, gnu::always_inline]] inline Plane moment_thrust(const RigidView& columns, int i) noexcept {
    const PinLanes change = read(columns, Column::tip_moment, i) - read(columns, Column::tip_moment_before, i);
    return (change * read(columns, Column::line_inverse, i)) * turned(read_plane(columns, Column::line_x, i));
}

inline void accelerate_pins(const RigidCoefficients& c, const RigidKick& kick, RigidColumns& all) noexcept {
    const RigidView columns(all);
    const PinLanes per_mass(1.0 / c.mass), per_tilt(1.0 / c.tilt_mass), per_slide(1.0 / c.slide_mass), per_bend(1.0 / c.bend_mass);
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
        const PinLanes rubbing = read(columns, Column::plate_friction, i) - read(columns, Column::plate_friction, i - 1);
        write(columns, Column::acceleration_z, i,
              per_mass * (read(columns, Column::force_z, i) + read(columns, Column::tip_force_z, i) + rubbing));
        write_plane(columns, Column::acceleration_bend_x, i,
                    per_bend * (read_plane(columns, Column::force_bend_x, i) + read_plane(columns, Column::tip_force_bend_x, i)));
        write(columns, Column::acceleration_slide, i,
              per_slide *
                  (read(columns, Column::force_slide, i) + read(columns, Column::tip_force_slide, i) + friction_on_slide(columns, i)));
    }
    if (!kick.implicit()) return;
    all.wrap(Column::wave_force_x, Column::wave_force_q);
    hold_waves(c, kick.step, all);
    const PinLanes per_step(1.0 / kick.step);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        for (int k = 0; k < 2; ++k) {
            write(columns, Column::acceleration_x + k, i, per_step * read(columns, Column::growth_x + k, i));
            write(columns, Column::acceleration_p + k, i, per_step * read(columns, Column::growth_p + k, i));
        }
    }
}

/// Changes of the velocities in the plane over the step, with the tips' friction of the last one.
inline void predict_waves(const RigidCoefficients& c, const RigidKick& kick, RigidColumns& all) noexcept {
    const RigidView columns(all);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const auto sum = [&](Column links, Column tips) { return read_plane(columns, links, i) + read_plane(columns, tips, i); };
        write_plane(columns, Column::wave_force_x, i, sum(Column::force_x, Column::tip_push_x));
        write_plane(columns, Column::wave_force_p, i, sum(Column::force_p, Column::tip_push_p));
    }
    all.wrap(Column::wave_force_x, Column::wave_force_q);
    begin_waves(c, kick.step, all);
    hold_waves(c, kick.step, all);
}

inline void drift_pins(double step, RigidColumns& all) noexcept {
    const RigidView columns(all);
    for (int k = 0; k < rigid_coordinates; ++k) {
        for (int i = 0; i < columns.padded(); i += rigid_lanes)
            write(columns, Column::x + k, i, read(columns, Column::x + k, i) + step * read(columns, Column::vx + k, i));
    }
}

/// ½ κ u' v' of the rates of stretch and yaw of link i before and after a kick: what waves add to ½ v·M v' [J].
[[nodiscard, gnu::always_inline]] inline PinLanes wave_energy(const StepInertia& inertia, double step, const RigidView& columns,
                                                              int i) noexcept {
    const Plane t = read_plane(columns, Column::line_x, i);
    const auto product = [&](Column velocity, Column acceleration) {
        const PinLanes before = dot(read_plane(columns, velocity, i + 1) - read_plane(columns, velocity, i), t);
        const PinLanes change = dot(read_plane(columns, acceleration, i + 1) - read_plane(columns, acceleration, i), t);
        return before * (before + step * change);
    };
    return 0.5 * (inertia.stretch() * product(Column::vx, Column::acceleration_x) +
                  inertia.yaw(columns, i) * product(Column::vp, Column::acceleration_p));
}

/// @return ½ v·M v' of the velocities before and after, M with the waves' inertia [J]
inline double kick_pins(const RigidCoefficients& c, double step, RigidColumns& all) noexcept {
    const RigidView columns(all);
    PinSum energy(columns);
    all.wrap(Column::acceleration_x, Column::acceleration_q);
    const StepInertia inertia(c, step);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        PinLanes of_pins = wave_energy(inertia, step, columns, i);
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
