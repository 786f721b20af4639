#pragma once
/// The four tips of every pin: normal forces, friction, and their sums on pins and sheaves. (model/EQUATIONS.md section 11)

#include <algorithm>

#include "model/variator/rigid/rigid_kernels.hpp"
#include "model/variator/rigid/rigid_tip.hpp"
#include "model/variator/rigid/rigid_vectors.hpp"

namespace cvtflow::model {
namespace {

/// Tips of eight pins.
class TipGroup {
public:
    [[gnu::always_inline]] TipGroup(const RigidCoefficients& c, const SheaveMotion* sheaves, const RigidKick& kick, RigidColumns& columns,
                                    int first) noexcept
        : c_(c), kick_(kick), columns_(columns), first_(first) {
        at_ = {read_plane(columns, Column::x, first), read_plane(columns, Column::p, first), read(columns, Column::z, first)};
        second_ = select_greater<rigid_lanes>(at_.middle.x, PinLanes(c.middle), PinLanes(1.0), PinLanes(0.0));
        read_half(half_[0], first - 1, 0.5);
        read_half(half_[1], first, -0.5);
        read_side<-1>(sheaves[0], sheaves[2], side_[0]);
        read_side<1>(sheaves[1], sheaves[3], side_[1]);
    }

    /// Whether all tips are certainly free: each half's sphere nearest to the axis against the flank nearest to it, as if of one tip.
    [[nodiscard, gnu::always_inline]] bool far() const noexcept {
        const SideMotion &low = side_[0], &high = side_[1];
        const auto size = [](const Plane& v) { return abs(v.x) + abs(v.y); };
        const auto more = [](const PinLanes& a, const PinLanes& b) { return larger<rigid_lanes>(a, b); };
        const PinLanes tilt = more(size({low.tilt_x, low.tilt_y}), size({high.tilt_x, high.tilt_y}));
        const PinLanes apart = size(low.arm - high.arm), off = more(abs(low.z), abs(high.z)) + c_.radius * c_.cosine;
        const auto nearness = [&](const HalfMotion& half) {
            const Plane arm = half.centre + low.arm;
            const PinLanes radius = sqrt(dot(arm, arm)), rise = abs(half.rise);
            const PinLanes a = radius - apart - tilt * (off + rise) - c_.touching_radius;
            const PinLanes h = smaller<rigid_lanes>(low.z, -high.z) - rise - tilt * (radius + apart);
            return -(c_.sine * a + c_.cosine * h);
        };
        return all_at_most<rigid_lanes>(more(nearness(half_[0]), nearness(half_[1])), 0.0);
    }

    [[gnu::always_inline]] void place() noexcept {
        for_tips([&](auto tip) __attribute__((always_inline)) { place_tip<tip.side>(c_, half_[tip.half], side_[tip.end], tips_[tip]); });
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
        columns_.clear(Column::tip_lean_x, Column::tip_rear, first_);
        columns_.clear(Column::tip_x, kick_.implicit() ? Column::flank + (rigid_tips - 1) : Column::reach + (rigid_tips - 1), first_);
    }

    [[gnu::always_inline]] void press(const SheaveMotion* sheaves, PinSum& energy, PinSum& damping) noexcept {
        rate_ = {read_plane(columns_, Column::vx, first_), read_plane(columns_, Column::vp, first_), read(columns_, Column::vz, first_)};
        read_half_rates(half_[0], first_ - 1, 0.5);
        read_half_rates(half_[1], first_, -0.5);
        read_side_rates<-1>(sheaves[0], sheaves[2], side_[0]);
        read_side_rates<1>(sheaves[1], sheaves[3], side_[1]);
        const PinLanes lead(-0.5 * kick_.step);
        const int further = c_.further_steps + (kick_.implicit() ? 0 : 1);
        for_tips([&](auto tip) __attribute__((always_inline)) {
            const HalfMotion& half = half_[tip.half];
            const PinLanes rate = depth_rate(half, side_[tip.end], tips_[tip], lead);
            NormalForce& n = normal_[tip] = normal_force(c_, tips_[tip].depth, rate, further);
            begin_[tip] = tip_slip<tip.side>(half, side_[tip.end], tips_[tip], n.shortening * rate);
            write(columns_, Column::normal + tip.column, first_, n.force);
            energy.add(first_, n.energy);
            damping.add(first_, drag_power(kick_, columns_, Column::tip_drag + tip.column, first_, n.force - n.elastic, rate));
        });
    }

    /// By how much velocities of the pins grow in the step if friction stays as it was.
    [[gnu::always_inline]] void predict() noexcept {
        if (!kick_.implicit()) return;
        TipForces total;
        for_tips([&](auto tip) __attribute__((always_inline)) {
            total.add<tip.side>(c_, half_[tip.half], tip.half, tips_[tip], tip_force<tip.side>(tips_[tip], normal_[tip], memory(tip)));
        });
        const PinLanes per_mass(kick_.step / c_.mass), per_tilt(kick_.step / c_.tilt_mass);
        const PinLanes rubbing = read(columns_, Column::rub, first_) - read(columns_, Column::rub, first_ - 1);
        growth_.middle = per_mass * (read_plane(columns_, Column::force_x, first_) + total.half[0] + total.half[1]);
        growth_.end = per_tilt * (read_plane(columns_, Column::force_p, first_) + total.end);
        growth_.z = per_mass * (read(columns_, Column::force_z, first_) + rubbing + total.z);
    }

    [[gnu::always_inline]] void rub(ReactionSum& reaction, CreepSum& creep, PinSum& lost) noexcept {
        TipForces total;
        ReactionSum::Sides on_side = {no_forces(), no_forces()};
        for_tips([&](auto tip) __attribute__((always_inline)) {
            const TipForce force = tip_force<tip.side>(tips_[tip], normal_[tip], friction(tip, lost));
            total.add<tip.side>(c_, half_[tip.half], tip.half, tips_[tip], force);
            add_on_sheave(tips_[tip], force, on_side[tip.end]);
            if (!kick_.implicit()) show_force(tip, force, creep);
        });
        reaction.subtract(second_, present(columns_, first_), on_side);
        store(total);
    }

private:
    /// @param line number of its pitch line   @param share of the halves' offset from each other that is this half's
    [[gnu::always_inline]] void read_half(HalfMotion& half, int line, double share) noexcept {
        const Plane offset = PinLanes(share) * read_plane(columns_, Column::part_x, first_);
        half.line = read_plane(columns_, Column::line_x, line);
        half.outward = {half.line.y, -half.line.x};
        half.sphere = PinLanes(c_.outward) * half.outward;
        half.centre = at_.middle + offset + half.sphere;
        half.rise = PinLanes(c_.outward / c_.half_length) * dot(at_.end, half.outward);
    }
    [[gnu::always_inline]] void read_half_rates(HalfMotion& half, int line, double share) noexcept {
        half.turn = read(columns_, Column::line_turn, line);
        half.slope_along = PinLanes(1.0 / c_.half_length) * dot(at_.end, half.line);
        half.velocity = rate_.middle + PinLanes(share) * read_plane(columns_, Column::part_vx, first_);
        half.sphere_velocity = half.velocity + (c_.outward * half.turn) * half.line;
        half.rise_rate = PinLanes(c_.outward / c_.half_length) * dot(rate_.end, half.outward) + c_.outward * (half.turn * half.slope_along);
    }

    /// A number of the sheaves of one side, for each pin that of its shaft.
    [[nodiscard]] PinLanes of(double SheaveMotion::*number, const SheaveMotion& driving, const SheaveMotion& driven) const noexcept {
        return select_greater<rigid_lanes>(second_, PinLanes(0.5), PinLanes(driven.*number), PinLanes(driving.*number));
    }

    template <int side>
    [[gnu::always_inline]] void read_side(const SheaveMotion& driving, const SheaveMotion& driven, SideMotion& s) noexcept {
        const auto value = [&](double SheaveMotion::*number) { return of(number, driving, driven); };
        s.sphere = PinLanes(side * (c_.lever - 1.0)) * at_.end;
        s.arm = PinLanes(side * c_.lever) * at_.end - Plane{value(&SheaveMotion::x), value(&SheaveMotion::y)};
        s.z = at_.z - (value(&SheaveMotion::z) - side * c_.half_length);
        s.tilt_x = value(&SheaveMotion::tilt_x);
        s.tilt_y = value(&SheaveMotion::tilt_y);
    }
    /// Velocities lead by half a step, in which the pins move on above the spinning sheave; those of the beginning trail by as much.
    template <int side>
    [[gnu::always_inline]] void read_side_rates(const SheaveMotion& driving, const SheaveMotion& driven, SideMotion& s) noexcept {
        const auto value = [&](double SheaveMotion::*number) { return of(number, driving, driven); };
        s.spin_x = value(&SheaveMotion::spin_x);
        s.spin_y = value(&SheaveMotion::spin_y);
        s.spin_z = value(&SheaveMotion::spin_z);
        const Plane velocity{value(&SheaveMotion::vx), value(&SheaveMotion::vy)};
        s.velocity = PinLanes(side) * rate_.end - velocity + (0.5 * kick_.step * s.spin_z) * turned(rate_.middle);
        s.sphere_velocity = PinLanes(side * c_.lever) * rate_.end - velocity;
        s.velocity_z = rate_.z - value(&SheaveMotion::vz);
    }

    template <class Tip>
    void show_force(Tip tip, const TipForce& f, CreepSum& creep) noexcept {
        const TipPlace& place = tips_[tip];
        const Slip& u = begin_[tip];
        const PinLanes speed = sqrt(u.round * u.round + u.flank * u.flank);
        const PinLanes grip = friction_factor(c_.tip_friction, friction_limit(tip, PinLanes(0.0), speed), PinLanes(0.0), speed);
        const PinLanes radius = sqrt(dot(place.point, place.point));
        creep.add(present(columns_, first_), second_, grip, radius, u.round);
        write(columns_, Column::sliding + tip.column, first_, speed);
        write(columns_, Column::reach + tip.column, first_, radius);
        const PinLanes outward = dot(f.push, place.radial) + dot(f.friction, place.radial);
        write(columns_, Column::outward + tip.column, first_, -outward);
        write(columns_, Column::axial + tip.column, first_, -(f.push_z + f.friction_z));
    }

    /// Friction of the last step.
    template <class Tip>
    [[nodiscard]] Slip memory(Tip tip) const noexcept {
        return {read(columns_, Column::round + tip.column, first_), read(columns_, Column::flank + tip.column, first_)};
    }

    /// Sliding velocity behind the growth of the velocities: the pin has moved on by half a step as well.
    template <class Tip>
    [[nodiscard]] Slip slip_now(Tip tip) const noexcept {
        const Plane carried = (kick_.step * side_[tip.end].spin_z) * turned(rate_.middle + PinLanes(0.5) * growth_.middle);
        const Plane change = growth_.middle + PinLanes(tip.side) * growth_.end - carried;
        return begin_[tip] + slip_of<tip.side>(tips_[tip], change, growth_.z);
    }

    /// Friction now. Contacts of a pin are solved one after the other, each with the velocities that those before it leave: the velocity
    /// that its friction of the last step leaves is corrected by r times the change, r its own response, with some room for what its
    /// moments do to neighbouring pins.
    template <class Tip>
    [[nodiscard, gnu::always_inline]] Slip friction(Tip tip, PinSum& lost) noexcept {
        const bool implicit = kick_.implicit();
        const Slip old = memory(tip);
        const PinLanes response(1.1 * kick_.step * (1.0 / c_.mass + 1.0 / c_.tilt_mass));
        const Slip free = implicit ? slip_now(tip) - response * old : begin_[tip];
        const PinLanes speed = sqrt(free.round * free.round + free.flank * free.flank);
        const Slip force = (-friction_factor(c_.tip_friction, friction_limit(tip, response, speed), response, speed)) * free;
        const Slip mean = implicit ? PinLanes(0.5) * (free + response * force + begin_[tip]) : free;
        lost.add(first_, -(force.round * mean.round + force.flank * mean.flank));
        write(columns_, Column::round + tip.column, first_, force.round);
        write(columns_, Column::flank + tip.column, first_, force.flank);
        if (implicit) follow(tip, force - old);
        return force;
    }

    /// Most friction of a tip, by its law at the speed that friction leaves. @param v without friction
    [[nodiscard, gnu::always_inline]] PinLanes friction_limit(std::size_t tip, const PinLanes& response, const PinLanes& v) const noexcept {
        const NormalForce& n = normal_[tip];
        const PinLanes limit = c_.tip_friction.coefficient * n.force;
        if (c_.tip_law == nullptr) return limit;
        const PinLanes full = limit * pressure_factor<rigid_lanes>(*c_.tip_law, n.root_depth), slowest(c_.tip_friction.saturation_speed);
        return full * speed_factor<rigid_lanes>(*c_.tip_law, braked_speed<rigid_lanes>(*c_.tip_law, response * full, v, slowest));
    }

    /// Velocities behind a change of a tip's friction.
    template <class Tip>
    [[gnu::always_inline]] void follow(Tip tip, const Slip& change) noexcept {
        const TipPlace& place = tips_[tip];
        const Plane f = change.round * turned(place.radial) + (change.flank * place.in) * place.radial;
        growth_.middle = growth_.middle + PinLanes(kick_.step / c_.mass) * f;
        growth_.end = growth_.end + PinLanes(tip.side * kick_.step / c_.tilt_mass) * f;
        growth_.z += PinLanes(tip.side * kick_.step / c_.mass) * (change.flank * place.out);
    }

    [[gnu::always_inline]] void store(const TipForces& total) noexcept {
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
    PinMotion growth_;  ///< of the velocities in this step
    HalfMotion half_[2];
    SideMotion side_[2];
    PinLanes second_;
    TipPlace tips_[rigid_tips];
    NormalForce normal_[rigid_tips];
    Slip begin_[rigid_tips];  ///< sliding velocities at the beginning of the step
};

inline void press_tips(const RigidCoefficients& c, const SheaveMotion* sheaves, const RigidKick& kick, RigidColumns& columns,
                       RigidReaction& reaction, Account& account) noexcept {
    PinSum energy(columns), damping(columns), friction(columns);
    ReactionSum on_sheaves;
    CreepSum creep;
    TipBounds bounds;
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        TipGroup group(c, sheaves, kick, columns, i);
        if (kick.implicit() && !pressed(columns, i) && group.far()) {
            group.release();
            continue;
        }
        group.place();
        group.bound(bounds);
        if (!kick.implicit()) group.show_depths();
        if (group.free()) {
            group.release();
            continue;
        }
        group.press(sheaves, energy, damping);
        group.predict();
        group.rub(on_sheaves, creep, friction);
    }
    on_sheaves.store(reaction.sheaves);
    creep.store(reaction);
    bounds.store(c, reaction);
    account.store(Energy::tips, energy.value());
    account.lose(Loss::tip_damping, damping.value());
    account.lose(Loss::tip_friction, friction.value());
}

inline void tip_depths(const RigidCoefficients& c, const SheaveMotion* sheaves, RigidColumns& columns, double* depth) noexcept {
    const RigidKick kick;
    TipGroup group(c, sheaves, kick, columns, 0);
    group.place();
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
