#pragma once
/// The four tips of pins side by side, of all pins of the chain that may touch: places, normal forces, friction, and their sums on pins and
/// sheaves. (model/EQUATIONS.md section 11)

#include <algorithm>
#include <new>

#include "model/rigid/near_pins.hpp"
#include "model/rigid/rigid_links.hpp"
#include "model/rigid/rigid_tip.hpp"
#include "model/rigid/tip_motion.hpp"

namespace cvtflow::model {
namespace {

/// Energy and losses of tips: of each of eight pins, added up over blocks.
struct TipAccount {
    PinLanes energy{0.0};                               ///< [J]
    PinLanes damping{0.0}, friction{0.0}, plates{0.0};  ///< plates: as pins lengthen [W]
};

/// Tips of one or two blocks of pins: in floats over a step of a leapfrog, with friction that acts in it; in doubles of an instant.
template <int W>
class TipGroup {
    using V = Lanes<W>;
    using PlaneV = PlaneOf<W>;
    static constexpr bool implicit = is_single<W>;

public:
    [[gnu::always_inline]] TipGroup(const RigidCoefficients& c, const TipNumbers<W>& numbers, const SheaveMotion* sheaves,
                                    const RigidKick& kick, const PinColumns& columns, const typename PinBlocks<W>::Blocks& blocks) noexcept
        : c_(c), n_(numbers), kick_(kick), pins_(columns, blocks), tip_(columns.tip), motion_(c, numbers, sheaves, kick, pins_) {
        for (std::size_t k = 0; k < rigid_tips; ++k)
            tips_[k].half = &motion_.half(k), tips_[k].side = &motion_.side(k), tips_[k].number = k;
    }

    [[gnu::always_inline]] void place() noexcept {
        for (Tip& tip : tips_) place_tip<W>(n_, *tip.half, *tip.side, tip);
    }

    [[nodiscard]] bool free(int block) const noexcept {
        const V front = larger<W>(tips_[0].depth, tips_[1].depth), rear = larger<W>(tips_[2].depth, tips_[3].depth);
        return all_at_most<pin_width>(pins_.piece(larger<W>(front, rear), block), 0.0);
    }

    void bound(TipBounds<W>& bounds) const noexcept {
        for (const Tip& tip : tips_) bounds.add(tip);
    }

    [[nodiscard]] const V& depth(std::size_t k) const noexcept { return tips_[k].depth; }
    void show_depths() noexcept {
        for (std::size_t k = 0; k < rigid_tips; ++k) pins_.write(tip_.depth[k], depth(k));
    }

    void release(int block) noexcept {
        for (const auto& part : tip_.written_rows()) pins_.columns().clear(part, pins_[block].first, rigid_lanes);
    }

    /// Normal forces; and forces along z with the friction of the last step.
    [[gnu::always_inline]] void press(const SheaveMotion* sheaves, TipAccount& account) noexcept {
        motion_.read_rates(sheaves);
        V stored(0.0), damped(0.0);
        shortened_ = V(0.0);
        for (Tip& tip : tips_) {
            const V rate = depth_rate<W>(*tip.half, *tip.side, tip, n_.lead);
            RigidNormalForce<W> n;
            rigid_normal_force<W>(n_, tip.depth, rate, n);
            const V shortening = n.shortening * rate;
            tip.normal_force = n.force, tip.shortening = n.shortening;
            tip.begin = tip_slip<W>(n_, *tip.half, *tip.side, tip, shortening);
            tip.friction = {pins_.read(tip_.tangential[tip.number]), pins_.read(tip_.radial[tip.number])};
            tip.capacity = capacity(tip, n.root_depth);
            shortened_ += shortening;
            pins_.write(tip_.normal[tip.number], n.force);
            stored += n.energy;
            const V drag = n.force - n.elastic;  // as in drag_power()
            PinReal* const dragged = tip_.damping_force[tip.number];
            damped += (implicit ? 0.5 * (drag + pins_.read(dragged)) : drag) * rate;
            pins_.write(dragged, drag);
        }
        pins_.write(tip_.lengthening, V(-0.25) * shortened_);
        add(stored, account.energy);
        add(damped, account.damping);
        if (!implicit) return;
        pull_ = pull(pins_.columns().plate.moment);
        const RigidTipForces<W> total = forces();
        parting_ = V(0.5) * (total.z[0] - total.z[1]);
        pins_.write(tip_.force.z, total.z[0] + total.z[1]);
        pins_.write(tip_.force.slide, parting_);
    }

    /// Friction at `friction_time`, one contact of a pin after the other, each with the velocities after those before it, in two sweeps;
    /// and the sums of all forces.
    [[gnu::always_inline]] void rub(ReactionSum& reaction, TipAccount& account) noexcept {
        pull_ = pull(pins_.columns().plate.moment);
        add((implicit ? V(0.5) * (pull_ + pull(pins_.columns().plate.moment_before)) : pull_) * shortened_, account.plates);
        VelocityChange change;
        if (implicit) predict(change);
        for (int sweep = 0; sweep < (implicit ? 2 : 1); ++sweep) {
            for (Tip& tip : tips_) rub(tip, change);
        }
        V lost(0.0);
        for (const Tip& tip : tips_) lost += store(tip, change);
        add(lost, account.friction);
        RigidTipForces<W> total = forces();
        for (std::size_t end = 0; end < 2; ++end) {
            const PressedTip<W> tips[] = {pressed(tips_[end]), pressed(tips_[end + 2])};
            total.add_moments(n_, tips_[end].side->side, tips);
            std::array<V, 6> on_sheave;
            on_sheave.fill(V(0.0));
            for (const PressedTip<W>& tip : tips) add_on_sheave<W>(tip.place, tip.force, on_sheave);
            show(tips_[end], tips[0].force), show(tips_[end + 2], tips[1].force);
            subtract(on_sheave, end, reaction);
        }
        store(total);
    }

private:
    struct Tip : TipPlace<W> {
        const HalfMotion<W>* half;
        const SideMotion<W>* side;
        std::size_t number;
        V normal_force, shortening;  ///< members of RigidNormalForce
        V capacity;                  ///< capacity()
        V factor;                    ///< friction per free sliding velocity [N·s/m]
        RigidSlip<W> begin;          ///< sliding velocity at the beginning of the step [m/s]
        RigidSlip<W> friction;       ///< friction of the last step, then of the last sweep [N]
    };

    /// Changes of the pins' velocities until friction acts [m/s].
    struct VelocityChange {
        PlaneV middle, end;  ///< changes of the middle, with bending, and of the ends
        V z, apart;          ///< along z: mean of both halves, and of the front half against it
        V free_share;        ///< share of a parting force that friction between the halves leaves
        PlaneV moved_on[2];  ///< change of the velocity against the sheave at -z, +z, as pin and sheave move on
    };

    /// Adds numbers of the valid pins, block by block.
    [[gnu::always_inline]] void add(const V& terms, PinLanes& to) const noexcept {
        pins_.over_blocks([&](int block) { to += pins_.present(block) * pins_.piece(terms, block); });
    }
    [[gnu::always_inline]] void subtract(const std::array<V, 6>& forces, std::size_t end, ReactionSum& from) const noexcept {
        pins_.over_blocks([&](int block) {
            std::array<PinLanes, 6> of_block;
            for (std::size_t k = 0; k < of_block.size(); ++k) of_block[k] = pins_.piece(forces[k], block);
            from.subtract(pins_.piece(motion_.driven(), block), pins_.present(block), end, of_block);
        });
    }

    /// Λ/4 by the moments of plates.
    [[nodiscard, gnu::always_inline]] V pull(const PinReal* moment) const noexcept {
        return V(0.25 * c_.plate_reach) * (pins_.read(moment) - pins_.read(moment, -1));
    }

    /// Writes what is observed alone: radius, and forces on the sheave.
    [[gnu::always_inline]] void show(const Tip& tip, const RigidTipForce<W>& force) noexcept {
        pins_.write(tip_.radius[tip.number], dot(tip.point, tip.radial));
        pins_.write(tip_.sheave_outward[tip.number], -dot(force.push + force.friction, tip.radial));
        pins_.write(tip_.sheave_axial[tip.number], -(force.push_z + force.friction_z));
    }

    [[nodiscard, gnu::always_inline]] PressedTip<W> pressed(const Tip& tip) const noexcept {
        return {tip, *tip.half, rigid_tip_force<W>(tip, tip.normal_force, tip.shortening, pull_, tip.friction)};
    }
    /// Forces of all tips on their pins.
    [[nodiscard, gnu::always_inline]] RigidTipForces<W> forces() const noexcept {
        RigidTipForces<W> total;
        for (std::size_t end = 0; end < 2; ++end) total.add(n_, tips_[end].side->side, {pressed(tips_[end]), pressed(tips_[end + 2])});
        return total;
    }

    /// Predicts the changes if friction stays constant.
    [[gnu::always_inline]] void predict(VelocityChange& change) noexcept {
        const RigidTipForces<W> total = forces();
        const auto& columns = pins_.columns();
        const PlaneV middle = n_.per_mass * (pins_.read(columns.force.middle) + total.half[0] + total.half[1]);
        change.middle = middle + n_.per_bend * (pins_.read(columns.force.bend) + total.bend);
        change.end = n_.per_tilt * (pins_.read(columns.force.end) + total.end);
        const V front = pins_.read(columns.plate.friction, -1), rear = pins_.read(columns.plate.friction);
        const V free = pins_.read(columns.force.slide) - V(0.5) * (rear + front) - pins_.read(columns.joint.friction);
        change.free_share = 1.0 - pins_.read(columns.joint.coupling);
        change.z = n_.per_mass * ((pins_.read(columns.force.z) + (rear - front)) + (total.z[0] + total.z[1]));
        change.apart = n_.per_half_mass * (free + parting_ + change.free_share * (V(0.5) * (total.z[0] - total.z[1]) - parting_));
        for (std::size_t end = 0; end < 2; ++end)
            change.moved_on[end] = tips_[end].side->moved_on + (V(2.0 * friction_time - 1.0) * tips_[end].side->turned_by) * turned(middle);
    }

    /// Change of the sliding velocity by changes of the velocities: the pin has moved as well.
    [[nodiscard, gnu::always_inline]] RigidSlip<W> slip_change(const Tip& tip, const VelocityChange& change) const noexcept {
        const V& side = tip.side->side;
        const PlaneV v = change.middle + (side * change.end - change.moved_on[end_of_tip(tip.number)]);
        return slip_of<W>(tip, v, change.z + V(sign_of(half_of_tip(tip.number))) * change.apart);
    }

    /// Friction of a tip. The velocity after the friction of before is corrected by r times the change of friction, r the contact's
    /// response.
    [[gnu::always_inline]] void rub(Tip& tip, VelocityChange& change) noexcept {
        const RigidSlip<W> old = tip.friction;
        const RigidSlip<W> free = implicit ? (tip.begin - n_.response * old) + slip_change(tip, change) : tip.begin;
        const V speed = sqrt(free.tangential * free.tangential + free.radial * free.radial);
        tip.factor = friction_factor<W>(c_.tip_friction, friction_limit(tip, speed), n_.response, speed);
        tip.friction = (-tip.factor) * free;
        if (implicit) follow(tip, tip.friction - old, change);
    }
    /// Writes the friction of a tip. @return power that is lost, in a step at the mean of the velocities before and after [W]
    [[nodiscard, gnu::always_inline]] V store(const Tip& tip, const VelocityChange& change) noexcept {
        const RigidSlip<W>& f = tip.friction;
        const RigidSlip<W> mean = implicit ? tip.begin + V(0.5 / friction_time) * slip_change(tip, change) : tip.begin;
        pins_.write(tip_.tangential[tip.number], f.tangential);
        pins_.write(tip_.radial[tip.number], f.radial);
        pins_.write(tip_.grip[tip.number], implicit ? tip.factor / (1.0 - n_.response * tip.factor) : tip.factor);
        return -(f.tangential * mean.tangential + f.radial * mean.radial);
    }

    /// Changes the velocities by a change of a tip's friction.
    [[gnu::always_inline]] void follow(const Tip& tip, const RigidSlip<W>& by, VelocityChange& change) noexcept {
        const V& side = tip.side->side;
        const PlaneV f = by.tangential * turned(tip.radial) + (by.radial * tip.in) * tip.radial;
        change.middle = change.middle + n_.per_mass_or_bend * f;
        change.end = change.end + (side * n_.per_tilt) * f;
        const V along = n_.per_mass * (by.radial * tip.out_z);
        change.z += along;
        change.apart += V(sign_of(half_of_tip(tip.number))) * (change.free_share * along);
    }

    /// Largest friction of a tip [N]; a law without memory reduces it by the sliding speed.
    [[nodiscard, gnu::always_inline]] V capacity(const Tip& tip, const V& root_depth) noexcept {
        const V limit = n_.friction * tip.normal_force;
        if (c_.tip_law == nullptr) return limit;
        const V full = limit * pressure_factor<W>(*c_.tip_law, root_depth);
        return c_.remembers() ? full * speed_factor<W>(*c_.tip_law, remember(tip)) : full;
    }
    /// The same by the law at the speed under friction. @param v speed without friction
    [[nodiscard, gnu::always_inline]] V friction_limit(const Tip& tip, const V& v) const noexcept {
        if (c_.tip_law == nullptr || c_.remembers()) return tip.capacity;
        const V slowest(implicit ? c_.tip_friction.saturation_speed : 0.0);
        return tip.capacity * speed_factor<W>(*c_.tip_law, braked_speed<W>(*c_.tip_law, n_.response * tip.capacity, v, slowest));
    }

    /// Remembered speed now. A tip without friction in the last step, and one at an instant, remembers its present speed.
    [[nodiscard, gnu::always_inline]] V remember(const Tip& tip) noexcept {
        PinReal* const row = tip_.remembered_speed[tip.number];
        const RigidSlip<W>& slip = tip.begin;
        const V speed = sqrt(slip.tangential * slip.tangential + slip.radial * slip.radial);
        V remembered = speed;
        if (implicit) {
            const V rubbed = abs(tip.friction.tangential) + abs(tip.friction.radial);
            const V follows = remembered_speed<W>(*c_.tip_law, c_.tip_friction.saturation_speed, kick_.step, pins_.read(row), speed);
            remembered = select_greater<W>(rubbed, V(0.0), follows, speed);
        }
        pins_.write(row, remembered);
        return remembered;
    }

    [[gnu::always_inline]] void store(const RigidTipForces<W>& total) noexcept {
        const PlaneV opening = V(0.5) * (total.half[0] - total.half[1]), sum = total.half[0] + total.half[1];
        pins_.over_blocks([&](int block) {
            const int first = pins_[block].first;
            const PlaneOf parting{pins_.piece(opening.x, block), pins_.piece(opening.y, block)};
            write(tip_.offset_moment, first, read_rolling(pins_.columns(), first) * parting);
        });
        const V numbers[] = {total.moment[0], total.moment[1]}, forces[] = {sum.x,        sum.y,       total.z[0] + total.z[1],
                                                                            total.end.x,  total.end.y, V(0.5) * (total.z[0] - total.z[1]),
                                                                            total.bend.x, total.bend.y};
        for (int k = 0; k < 2; ++k) pins_.write(tip_.moment_of_half[k], numbers[k]);
        const auto rows = tip_.force.all();
        for (std::size_t k = 0; k < rigid_coordinates; ++k) pins_.write(rows[k], forces[k]);
    }

    const RigidCoefficients& c_;
    const TipNumbers<W>& n_;
    const RigidKick& kick_;
    PinBlocks<W> pins_;
    const typename RigidRowsOf<PinReal>::TipRows& tip_;
    RigidTipMotion<W> motion_;
    Tip tips_[rigid_tips];
    V pull_;       ///< Λ/4: a quarter of the force of plates that lengthens the pin [N]
    V shortened_;  ///< sum over the tips of the rates at which half pins shorten [m/s]
    V parting_;    ///< force on ζ with the friction of the last step [N]
};

/// Tips of a whole chain in groups, between their normal forces and their friction, in the memory that the columns hold for them.
class HeldTips {
    static constexpr int W = tip_width;
    using Group = TipGroup<W>;
    using Pins = PinBlocks<W>;

public:
    HeldTips(const RigidCoefficients& c, const SheaveMotion* sheaves, const RigidKick& kick) noexcept : numbers_(c, sheaves, kick) {
        static_assert(sizeof(HeldTips) <= held_at_least && sizeof(Group) * rigid_lanes <= held_per_block * lane_count<W>);
    }

    [[gnu::noinline]] void press(const RigidCoefficients& c, const SheaveMotion* sheaves, const RigidKick& kick, const PinColumns& columns,
                                 const Pins::Blocks& blocks) noexcept {
        Group& group = *new (groups() + count_) Group(c, numbers_, sheaves, kick, columns, blocks);
        group.place();
        group.bound(bounds_);
        if (!is_single<W>) group.show_depths();
        Pins::Blocks alone{};
        int left = 0;
        for (int block = 0; block < Pins::count; ++block) {
            if (group.free(block)) {
                group.release(block);
            } else {
                ++left, alone.front() = blocks[static_cast<std::size_t>(block)];
            }
        }
        if (left == 0) return;
        if (left < Pins::count) {  // pins that have left their sheaves have no friction, whatever is computed beside them
            alone.back() = {alone.front().first, 0};
            return press(c, sheaves, kick, columns, alone);
        }
        group.press(sheaves, account_);
        ++count_;
    }
    [[gnu::noinline]] void rub() noexcept {
        for (int k = 0; k < count_; ++k) groups()[k].rub(on_sheaves_, account_);
    }
    void store(const RigidCoefficients& c, RigidReaction& reaction, Account& account) const noexcept {
        on_sheaves_.store(reaction.sheaves);
        bounds_.store(c, reaction);
        account.store(Energy::tips, total(account_.energy));
        account.lose(Loss::tip_damping, total(account_.damping));
        account.lose(Loss::tip_friction, total(account_.friction));
        account.lose(Loss::plate_friction, total(account_.plates));
    }

    int beyond = 0;  ///< pins of a block that continues with copies of the first ones

private:
    [[nodiscard]] Group* groups() noexcept { return reinterpret_cast<Group*>(this + 1); }

    TipNumbers<W> numbers_;
    TipAccount account_;
    ReactionSum on_sheaves_;
    TipBounds<W> bounds_;
    int count_ = 0;
};

/// Presses the tips of near pins: in a step of pins that may touch until near pins are found again.
inline void press_tips(const RigidCoefficients& c, const SheaveMotion* sheaves, const RigidKick& kick, PinColumns& columns) noexcept {
    using Blocks = PinBlocks<tip_width>;
    in_step ? renew_near_pins(c, sheaves, kick, columns) : find_near_pins_now(c, sheaves, columns);
    if (c.remembers()) wrap(columns, columns.tip.remembered());
    auto& tips = *new (columns.held()) HeldTips(c, sheaves, kick);
    typename Blocks::Blocks blocks;
    std::size_t found = 0;
    tips.beyond = over_near_pins(columns, [&](const PinBlock& block) {
        blocks[found++] = block;
        if (found == blocks.size()) tips.press(c, sheaves, kick, columns, blocks), found = 0;
    });
    if (found != 0) blocks.back() = {blocks[0].first, 0}, tips.press(c, sheaves, kick, columns, blocks);
    if (!in_step) unwrap(columns, RowRange{columns.tip.depth[0], columns.tip.depth[3]}, tips.beyond);
    for (const auto& part : columns.tip.written_rows()) unwrap(columns, part, tips.beyond);
    if (c.remembers()) unwrap(columns, columns.tip.remembered(), tips.beyond);
}

void rub_tips(const RigidCoefficients& c, PinColumns& columns, RigidReaction& reaction, Account& account) noexcept {
    auto& tips = *std::launder(reinterpret_cast<HeldTips*>(columns.held()));
    tips.rub();
    for (const auto& part : columns.tip.written_rows()) unwrap(columns, part, tips.beyond);
    wrap(columns, RowRange{columns.tip.normal[0], columns.tip.normal[rigid_tips - 1]});
    tips.store(c, reaction, account);
}

inline void tip_depths(const RigidCoefficients& c, const SheaveMotion* sheaves, PinColumns& columns, PinReal* depth) noexcept {
    constexpr int W = pin_width;
    const RigidKick kick;
    drift_pins(0.0, columns);
    pitch_lines(columns);
    rolling_frames(c, columns);
    const TipNumbers<W> numbers(c, sheaves, kick);
    TipGroup<W> group(c, numbers, sheaves, kick, columns, {PinBlock{0, rigid_lanes}});
    group.place();
    for (std::size_t tip = 0; tip < rigid_tips; ++tip) group.depth(tip).copy_to(depth + tip * rigid_lanes);
}

inline double contact_changes(const PinColumns& columns) noexcept {
    const PinLanes one(1.0), none(0.0);
    PinLanes changes(0.0);
    for (std::size_t tip = 0; tip < rigid_tips; ++tip) {
        for (int i = 0; i < columns.padded(); i += rigid_lanes) {
            const auto presses = select_greater<pin_width>(read(columns.tip.normal[tip], i), none, one, none);
            changes += abs(presses - read(columns.tip.touching[tip], i));
        }
    }
    return total(changes);
}

}  // namespace
}  // namespace cvtflow::model
