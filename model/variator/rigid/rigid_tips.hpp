#pragma once
/// The four tips of every pin: normal forces, friction, and their sums on pins and sheaves. (model/EQUATIONS.md section 11)

#include <algorithm>

#include "model/variator/rigid/rigid_friction.hpp"
#include "model/variator/rigid/rigid_kernels.hpp"
#include "model/variator/rigid/rigid_tip.hpp"

namespace cvtflow::model {
namespace {

[[nodiscard]] inline std::array<PinLanes, 6> none() noexcept {
    std::array<PinLanes, 6> zero;
    zero.fill(PinLanes(0.0));
    return zero;
}

/// Sums over pins of what their tips do to the four sheaves.
class ReactionSum {
public:
    /// @param second 1 for pins that belong to the driven shaft   @param present 0 for pins that only fill the last vector
    void add(const PinLanes& second, const PinLanes& present, const std::array<std::array<PinLanes, 6>, 2>& forces) noexcept {
        const PinLanes here = present * second, there = present - here;
        for (std::size_t side = 0; side < 2; ++side) {
            for (std::size_t k = 0; k < 6; ++k) {
                on_[0][side][k] += there * forces[side][k];
                on_[1][side][k] += here * forces[side][k];
            }
        }
    }
    void store(SheaveForces& to) const noexcept {
        for (std::size_t sheave = 0; sheave < 4; ++sheave) sums<rigid_lanes, 6>(on_[sheave / 2][sheave % 2], to[sheave].data());
    }

private:
    std::array<std::array<std::array<PinLanes, 6>, 2>, 2> on_{{{none(), none()}, {none(), none()}}};
};

/// Tips 0 and 1 are the front half's at -z and +z, 2 and 3 the rear half's.
[[nodiscard]] constexpr std::size_t half_of(std::size_t tip) noexcept { return tip / 2; }
[[nodiscard]] constexpr std::size_t side_of(std::size_t tip) noexcept { return tip % 2; }

/// Tips of eight pins.
class TipGroup {
public:
    TipGroup(const RigidCoefficients& c, const SheaveMotion* sheaves, const RigidKick& kick, RigidColumns& columns, int first) noexcept
        : c_(c), kick_(kick), columns_(columns), first_(first) {
        read_pins();
        read_half(0, first - 1, 0.5);
        read_half(1, first, -0.5);
        second_ = select_greater<rigid_lanes>(at_.middle.x, PinLanes(c.middle), PinLanes(1.0), PinLanes(0.0));
        for (int side = 0; side < 2; ++side) read_sheave(sheaves[side], sheaves[2 + side], side);
        for (std::size_t tip = 0; tip < rigid_tips; ++tip)
            place_tip(c, at_, half_[half_of(tip)], sheave_[side_of(tip)], side_of(tip) == 0 ? -1.0 : 1.0, tips_[tip]);
    }

    [[nodiscard]] bool free() const noexcept {
        const PinLanes front = larger<rigid_lanes>(tips_[0].depth, tips_[1].depth),
                       rear = larger<rigid_lanes>(tips_[2].depth, tips_[3].depth);
        return all_at_most<rigid_lanes>(larger<rigid_lanes>(front, rear), 0.0);
    }

    void bound(TipBounds& bounds) const noexcept {
        for (const TipPlace& tip : tips_) bounds.add(tip);
    }

    [[nodiscard]] const PinLanes& depth(std::size_t tip) const noexcept { return tips_[tip].depth; }
    void show_depths() noexcept {
        for (std::size_t tip = 0; tip < rigid_tips; ++tip) write(columns_, Column::depth + static_cast<int>(tip), first_, depth(tip));
    }

    void release() noexcept {
        for (int c = static_cast<int>(Column::tip_lean_x); c < static_cast<int>(Column::count); ++c) {
            const Column column = static_cast<Column>(c);
            if (column != Column::tip_moment && column != Column::tip_moment_before) write(columns_, column, first_, PinLanes(0.0));
        }
    }

    void press(PinSum& energy, PinSum& damping) noexcept {
        for (std::size_t tip = 0; tip < rigid_tips; ++tip) {
            const PinLanes rate = depth_rate(c_, rate_, half_[half_of(tip)], sheave_[side_of(tip)], tips_[tip], -0.5 * kick_.step);
            normal_[tip] = normal_force(c_, tips_[tip].depth, rate, kick_.implicit() ? 1 : 2);
            shortening_[tip] = normal_[tip].shortening * rate;
            write(columns_, Column::normal + static_cast<int>(tip), first_, normal_[tip].force);
            energy.add(first_, normal_[tip].energy);
            const PinLanes drag = normal_[tip].force - normal_[tip].elastic;
            damping.add(first_, drag_power(kick_, columns_, Column::tip_drag + static_cast<int>(tip), first_, drag, rate));
        }
    }

    /// Velocities that the pins have after the step if friction stays as it was.
    void predict() noexcept {
        if (!kick_.implicit()) return;
        for (std::size_t tip = 0; tip < rigid_tips; ++tip) begin_[tip] = slip_at(tip, -0.5 * kick_.step);
        TotalForces total;
        for (std::size_t tip = 0; tip < rigid_tips; ++tip) total.add(half_of(tip), push(tip, memory(tip)));
        const PinLanes per_mass(kick_.step / c_.mass), per_tilt(kick_.step / c_.tilt_mass);
        const auto known = [&](Column column) { return read(columns_, column, first_); };
        rate_.middle = rate_.middle + per_mass * (read_plane(columns_, Column::force_x, first_) + total.half[0] + total.half[1]);
        rate_.end = rate_.end + per_tilt * (read_plane(columns_, Column::force_p, first_) + total.end);
        rate_.z +=
            per_mass * (known(Column::force_z) + read(columns_, Column::rub, first_) - read(columns_, Column::rub, first_ - 1) + total.z);
    }

    void rub(ReactionSum& reaction, PinSum& lost) noexcept {
        TotalForces total;
        std::array<std::array<PinLanes, 6>, 2> on_side = {none(), none()};
        for (std::size_t tip = 0; tip < rigid_tips; ++tip) {
            const TipForce force = tip_force(tips_[tip], normal_[tip], friction(tip, lost));
            total.add(half_of(tip), on_pin(c_, half_[half_of(tip)], tips_[tip], force));
            if (!kick_.implicit()) show_force(tip, force);
            const std::array<PinLanes, 6> reacting = on_sheave(c_, tips_[tip], force);
            for (std::size_t k = 0; k < 6; ++k) on_side[side_of(tip)][k] += reacting[k];
        }
        reaction.add(second_, present(), on_side);
        store(total);
    }

private:
    struct TotalForces {
        Plane half[2] = {{0.0, 0.0}, {0.0, 0.0}};
        Plane end{0.0, 0.0};
        PinLanes z{0.0}, moment[2] = {0.0, 0.0};
        void add(std::size_t which, const TipForces& f) noexcept {
            half[which] = half[which] + f.half;
            end = end + f.end;
            z += f.z;
            moment[which] += f.moment;
        }
    };

    void read_pins() noexcept {
        at_ = {read_plane(columns_, Column::x, first_), read_plane(columns_, Column::p, first_), read(columns_, Column::z, first_)};
        rate_ = {read_plane(columns_, Column::vx, first_), read_plane(columns_, Column::vp, first_), read(columns_, Column::vz, first_)};
    }

    /// @param line number of its pitch line   @param side half of the halves' offset from each other that is this half's
    void read_half(std::size_t which, int line, double side) noexcept {
        HalfMotion& half = half_[which];
        half.offset = PinLanes(side) * read_plane(columns_, Column::part_x, first_);
        half.offset_rate = PinLanes(side) * read_plane(columns_, Column::part_vx, first_);
        half.line = read_plane(columns_, Column::line_x, line);
        half.outward = {half.line.y, -half.line.x};
        half.turn = read(columns_, Column::line_turn, line);
        const PinLanes per_half(1.0 / c_.half_length);
        half.slope_out = per_half * dot(at_.end, half.outward);
        half.slope_along = per_half * dot(at_.end, half.line);
        half.slope_out_rate = per_half * dot(rate_.end, half.outward);
    }

    void read_sheave(const SheaveMotion& driving, const SheaveMotion& driven, int side) noexcept {
        const auto of = [&](double SheaveMotion::*number) {
            return select_greater<rigid_lanes>(second_, PinLanes(0.5), PinLanes(driven.*number), PinLanes(driving.*number));
        };
        SheaveSide& s = sheave_[static_cast<std::size_t>(side)];
        s.centre = {of(&SheaveMotion::x), of(&SheaveMotion::y)};
        s.z = of(&SheaveMotion::z) - (side == 0 ? -c_.half_length : c_.half_length);
        s.tilt_x = of(&SheaveMotion::tilt_x);
        s.tilt_y = of(&SheaveMotion::tilt_y);
        s.velocity = {of(&SheaveMotion::vx), of(&SheaveMotion::vy)};
        s.velocity_z = of(&SheaveMotion::vz);
        s.spin_x = of(&SheaveMotion::spin_x);
        s.spin_y = of(&SheaveMotion::spin_y);
        s.spin_z = of(&SheaveMotion::spin_z);
    }

    [[nodiscard]] PinLanes present() const noexcept {
        PinLanes one(1.0);
        for (int lane = std::max(0, columns_.pins() - first_); lane < rigid_lanes; ++lane) one.set(static_cast<std::size_t>(lane), 0.0);
        return one;
    }

    void show_force(std::size_t tip, const TipForce& f) noexcept {
        const TipPlace& place = tips_[tip];
        const PinLanes outward = f.normal * dot(place.normal, place.radial) + dot(f.friction, place.radial);
        write(columns_, Column::outward + static_cast<int>(tip), first_, -outward);
        write(columns_, Column::axial + static_cast<int>(tip), first_, -(f.normal * place.normal_z + f.friction_z));
    }

    /// Friction of the last step.
    [[nodiscard]] Slip memory(std::size_t tip) const noexcept {
        const int k = static_cast<int>(tip);
        return {read(columns_, Column::round + k, first_), read(columns_, Column::flank + k, first_)};
    }

    [[nodiscard]] TipForces push(std::size_t tip, const Slip& friction) const noexcept {
        return on_pin(c_, half_[half_of(tip)], tips_[tip], tip_force(tips_[tip], normal_[tip], friction));
    }

    /// Sliding velocity of the velocities as they are, which lead by some time [s].
    [[nodiscard]] Slip slip_at(std::size_t tip, double lead) const noexcept {
        return tip_slip(c_, rate_, half_[half_of(tip)], sheave_[side_of(tip)], tips_[tip], shortening_[tip], lead);
    }

    /// Friction now. Contacts of a pin are solved one after the other, each with the velocities that those before it leave: the velocity
    /// that its friction of the last step leaves is corrected by r times the change, r its own response, with some room for what its
    /// moments do to neighbouring pins.
    [[nodiscard]] Slip friction(std::size_t tip, PinSum& lost) noexcept {
        const int k = static_cast<int>(tip);
        const Slip old = memory(tip);
        const PinLanes response(1.1 * kick_.step * (1.0 / c_.mass + 1.0 / c_.tilt_mass));
        Slip slip = slip_at(tip, 0.5 * kick_.step);
        slip = {slip.round - response * old.round, slip.flank - response * old.flank};
        const PinLanes speed = sqrt(slip.round * slip.round + slip.flank * slip.flank);
        const PinLanes factor = -friction_factor(c_.tip_friction, c_.tip_friction.coefficient * normal_[tip].force, response, speed);
        const Slip force{factor * slip.round, factor * slip.flank};
        slip = {slip.round + response * force.round, slip.flank + response * force.flank};
        const Slip mean = kick_.implicit() ? Slip{0.5 * (slip.round + begin_[tip].round), 0.5 * (slip.flank + begin_[tip].flank)} : slip;
        lost.add(first_, PinLanes(-1.0) * (force.round * mean.round + force.flank * mean.flank));
        write(columns_, Column::round + k, first_, force.round);
        write(columns_, Column::flank + k, first_, force.flank);
        if (kick_.implicit()) follow(tip, {force.round - old.round, force.flank - old.flank});
        return force;
    }

    /// Velocities behind a change of a tip's friction.
    void follow(std::size_t tip, const Slip& change) noexcept {
        const TipForce f = tip_force(tips_[tip], NormalForce{0.0, 0.0, 0.0, 0.0}, change);
        rate_.middle = rate_.middle + PinLanes(kick_.step / c_.mass) * f.friction;
        rate_.end = rate_.end + PinLanes(tips_[tip].side * kick_.step / c_.tilt_mass) * f.friction;
        rate_.z += kick_.step / c_.mass * f.friction_z;
    }

    void store(const TotalForces& total) noexcept {
        const Rolling rolling = read_rolling(columns_, first_);
        write_plane(columns_, Column::tip_lean_x, first_, rolling * (PinLanes(0.5) * (total.half[0] - total.half[1])));
        write(columns_, Column::tip_front, first_, total.moment[0]);
        write(columns_, Column::tip_rear, first_, total.moment[1]);
        write_plane(columns_, Column::tip_x, first_, total.half[0] + total.half[1]);
        write(columns_, Column::tip_z, first_, total.z);
        write_plane(columns_, Column::tip_p, first_, total.end);
    }

    const RigidCoefficients& c_;
    const RigidKick& kick_;
    RigidColumns& columns_;
    int first_;
    PinMotion at_, rate_;
    HalfMotion half_[2];
    SheaveSide sheave_[2];
    PinLanes second_;
    TipPlace tips_[rigid_tips];
    NormalForce normal_[rigid_tips];
    Slip begin_[rigid_tips];           ///< sliding velocities at the beginning of the step
    PinLanes shortening_[rigid_tips];  ///< rate at which the half pins shorten [m/s]
};

inline void press_tips(const RigidCoefficients& c, const SheaveMotion* sheaves, const RigidKick& kick, RigidColumns& columns,
                       RigidReaction& reaction, Account& account) noexcept {
    PinSum energy(columns), damping(columns), friction(columns);
    ReactionSum on_sheaves;
    TipBounds bounds;
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        TipGroup group(c, sheaves, kick, columns, i);
        group.bound(bounds);
        if (!kick.implicit()) group.show_depths();
        if (group.free()) {
            group.release();
            continue;
        }
        group.press(energy, damping);
        group.predict();
        group.rub(on_sheaves, friction);
    }
    on_sheaves.store(reaction.sheaves);
    bounds.store(c, reaction);
    account.store(Energy::tips, energy.value());
    account.lose(Loss::tip_damping, damping.value());
    account.lose(Loss::tip_friction, friction.value());
}

inline void tip_depths(const RigidCoefficients& c, const SheaveMotion* sheaves, RigidColumns& columns, double* depth) noexcept {
    const RigidKick kick;
    const TipGroup group(c, sheaves, kick, columns, 0);
    for (std::size_t tip = 0; tip < rigid_tips; ++tip) group.depth(tip).copy_to(depth + tip * rigid_lanes);
}

/// M_i = n_i·(A_i g_i + A_{i+1} g_{i+1}) + moments of the tips on the halves that turn with pitch line i.
inline void tip_moments(RigidColumns& columns) noexcept {
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const Plane normal = turned(read_plane(columns, Column::line_x, i));
        const Plane lean = read_plane(columns, Column::tip_lean_x, i) + read_plane(columns, Column::tip_lean_x, i + 1);
        write(columns, Column::tip_moment_before, i, read(columns, Column::tip_moment, i));
        write(columns, Column::tip_moment, i,
              dot(normal, lean) + read(columns, Column::tip_rear, i) + read(columns, Column::tip_front, i + 1));
    }
}

}  // namespace
}  // namespace cvtflow::model
