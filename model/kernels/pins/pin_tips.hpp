#pragma once
/// Tips of whole pins, side by side: two of each, stored as the rear tips of links. Pins that touch nowhere are included with
/// forces of zero. (model/EQUATIONS.md sections 6 and 10)

#include "model/contact/friction_tips.hpp"
#include "model/kernels/chain_parts.hpp"
#include "model/kernels/lanes/lane_tips.hpp"
#include "model/kernels/pins/pin_motion.hpp"
#include "model/kernels/pins/pin_rows.hpp"

namespace cvtflow::model {

namespace {

/// Forces and moment of both tips of a pin on its coordinates.
template <int P, int W>
struct PinShare {
    std::array<Lanes<W>, pin_at<P>.link_size()> force;
    Lanes<W> moment;  ///< on the bisector [N·m]
};

template <int P, int W, bool Observe, class Contacts = NoContacts>
class PinTips {
public:
    using V = Lanes<W>;
    using Columns = LinkColumns<P, W>;

    /// @param phases of the first lane's pin on   @param own its number, counted from the range's first
    PinTips(const Coefficients& c, const SheaveMotion* sheaves, const Phase* phases, int own, const Contacts& contacts) noexcept
        : c_(c), phases_(phases), own_(own), contacts_(contacts), all_sheaves_(sheaves) {
        for (std::size_t pin = 0; pin < W; ++pin) any_ |= words_[pin] = phase_word(phases + tips_per_link * static_cast<int>(pin));
    }

    /// What the tips of each pin carry goes here, if observed; else nullptr.
    using Seen = std::array<LinkContact*, W>;

    /// Forces; reactions of the pins that touch to loads [W].
    void share(const Columns& columns, PinShare<P, W>& out, LinkLoad* loads, LaneAccounts<W>& account, const Seen& seen) const noexcept {
        out.force.fill(V(0.0));
        out.moment = V(0.0);
        if (any_ == 0) {
            if constexpr (Contacts::wanted) contacts_.no_tips(own_, W);
            return;
        }
        std::array<SheaveMotionLanes<W>, 2> sheaves;
        const V shaft = pulleys_of<P>(c_, all_sheaves_, columns, sheaves);
        std::array<TipReaction<V>, 2> reaction;
        const TipAction<V> minus = tip(OneTip<W, End::rear, 0>{}, 0, columns, sheaves, shaft, reaction[0], account, seen);
        const TipAction<V> plus = tip(OneTip<W, End::rear, 1>{}, 1, columns, sheaves, shaft, reaction[1], account, seen);
        V* f = out.force.data();
        constexpr auto& at = pin_at<P>;
        spread_end<P>(minus.total.x, plus.total.x, minus.tilt_x, plus.tilt_x, f + at.x(End::rear, 0));
        spread_end<P>(minus.total.y, plus.total.y, minus.tilt_y, plus.tilt_y, f + at.y(End::rear, 0));
        f[at.z(End::rear)] += minus.total.z + plus.total.z;
        f[at.e(End::rear)] += plus.total.z - minus.total.z;
        out.moment = minus.moment + plus.moment;
        write(reaction, shaft, loads);
    }

private:
    template <class Corner>
    [[nodiscard]] TipAction<V> tip(const Corner& corner, int number, const Columns& columns,
                                   const std::array<SheaveMotionLanes<W>, 2>& sheaves, [[maybe_unused]] const V& shaft,
                                   TipReaction<V>& reaction, LaneAccounts<W>& account, const Seen& seen) const noexcept {
        const auto own = sheaves_at(corner, sheaves.data());
        const auto geometry = tip_geometry<P>(c_, corner, columns.frame, columns.q(), own);
        const auto motion = tip_motion<P>(c_, corner, columns.frame, columns.v(), own, geometry);
        constexpr std::uint32_t stick_or_slip = 0x02020202;
        const PhaseLanes phases{phases_ + number, tips_per_link, (any_ & stick_or_slip) != 0, W};
        const auto forces = tip_forces<Observe, W>(c_.tip, geometry, motion, touching(number), phases, &account);
        if constexpr (Contacts::wanted)
            contacts_.tip(own_, W, number, geometry, motion, forces.normal, sheaves[static_cast<std::size_t>(number)], shaft);
        if constexpr (Observe) note(geometry, forces, number, seen);
        reaction = tip_reaction(geometry, motion, forces);
        return tip_action(c_, columns.frame, geometry, motion, forces);
    }

    /// What the tips `number` carry, of pins that touch somewhere.
    template <class Geometry>
    void note(const Geometry& geometry, const TipForces<V>& forces, int number, const Seen& seen) const noexcept {
        alignas(64) double depth[W], normal[W], axial[W];
        geometry.depth.copy_to(depth);
        forces.normal.copy_to(normal);
        axial_force(geometry, forces).copy_to(axial);
        for (std::size_t pin = 0; pin < W; ++pin) {
            if (words_[pin] == 0 || seen[pin] == nullptr) continue;
            seen[pin]->depth[number] = depth[pin];
            seen[pin]->normal[number] = normal[pin];
            seen[pin]->axial[number] = axial[pin];
        }
    }

    /// 1 where a tip touches, else 0.
    [[nodiscard]] V touching(int number) const noexcept {
        alignas(64) double touching[W];
        for (std::size_t pin = 0; pin < W; ++pin) touching[pin] = (words_[pin] >> (8 * number) & 0xffu) != 0 ? 1.0 : 0.0;
        return load<W>(touching);
    }

    void write(const std::array<TipReaction<V>, 2>& reaction, const V& shaft, LinkLoad* loads) const noexcept {
        alignas(64) double row[W];
        const auto give = [&](const V& lanes, auto of_load, std::size_t side) {
            lanes.copy_to(row);
            for (std::size_t pin = 0; pin < W; ++pin) (loads[pin].load.*of_load)[side] = row[pin];
        };
        for (std::size_t side = 0; side < 2; ++side) {
            give(reaction[side].force.x, &SheaveLoad::fx, side);
            give(reaction[side].force.y, &SheaveLoad::fy, side);
            give(reaction[side].force.z, &SheaveLoad::fz, side);
            give(reaction[side].moment.x, &SheaveLoad::mx, side);
            give(reaction[side].moment.y, &SheaveLoad::my, side);
            give(reaction[side].moment.z, &SheaveLoad::mz, side);
        }
        for (std::size_t pin = 0; pin < W; ++pin) loads[pin].shaft = static_cast<int>(shaft[pin]);
    }

    const Coefficients& c_;
    const Phase* phases_;
    int own_;
    const Contacts& contacts_;
    const SheaveMotion* all_sheaves_;
    std::array<std::uint32_t, W> words_{};  ///< phases of each pin
    std::uint32_t any_ = 0;
};

}  // namespace

namespace {

/// W pins side by side, in single precision if W says so. Column numbers count from the first pin of the range.
template <int P, int W, bool Steepest>
class PinFriction : private FrictionTips<P, W, Steepest> {
    using Base = FrictionTips<P, W, Steepest>;
    using Base::velocity, Base::contact, Base::field_, Base::numbers_;

public:
    using V = Lanes<W>;
    using Number = NumberOf<W>;
    using Tip = ContactComponents::Tip;
    static constexpr const ChainLayout& at = pin_at<P>;
    static constexpr AxisRows axis{at.x(End::rear, 0), at.y(End::rear, 0), at.z(End::rear)};

    using Base::Base;

    /// Tips and plates of pins first + own … + W - 1, own ≥ -1, to scratch.
    void forces(int own) const noexcept {
        plates(own);
        V moment(0.0);
        AtTips<V> tips{{V(0.0), V(0.0), V(0.0)}, {V(0.0), V(0.0), V(0.0)}};
        if (touching(own)) tips = Base::tip_friction(own, 0, axis, 0.5 * (turning(own - 1) + turning(own)), moment);
        int row = tips_row;
        for (const AtTip<V>* tip : {&tips.low, &tips.high}) {
            for (const V* force : {&tip->x, &tip->y, &tip->z}) put(row++, own, *force);
        }
        put(moment_row, own, moment);
    }

    /// Slopes of pins first + own … + W - 1; forces of these and of their neighbours must be in scratch.
    void pins(int own, const FrictionStageOf<Number>& stage) const noexcept {
        V f[at.link_size()];
        for (V& row : f) row = V(0.0);
        const auto tip = [&](int row) { return AtTip<V>{scratch(row, own), scratch(row + 1, own), scratch(row + 2, own)}; };
        const AtTips<V> tips{tip(tips_row), tip(tips_row + 3)};
        Base::add_impulses(own, 0, tips, stage);
        Base::spread(tips, axis, f);
        for (int k = 0; k < 2; ++k) f[axis.z + k] += scratch(plates_row + k, own - 1) - scratch(plates_row + k, own);
        const Plane<V> couple_before = couple(own - 1), couple_behind = couple(own);
        f[axis.x] += couple_before.x - couple_behind.x;
        f[axis.y] += couple_before.y - couple_behind.y;
        accelerate_pins<P, W>(numbers_.pin_lateral, numbers_.pin_axial, f);
        Base::with_sink(own, stage, [&](const auto& sink) {
            for (int row = 0; row < at.link_size(); ++row) sink.put(row, f[row]);
        });
    }

private:
    /// Rows of scratch: forces of both tips, their moment, what plates of the link behind do to z and e of the pin that follows.
    static constexpr int tips_row = 0, moment_row = 6, plates_row = 7, rows = 9;
    static_assert(rows <= FrictionOperator::scratch_rows(P + 1));

    [[nodiscard]] V scratch(int row, int own) const noexcept { return Base::kept(row, own + 1); }
    void put(int row, int own, const V& lanes) const noexcept { Base::keep(row, own + 1, lanes); }

    /// Couple of the moment on the line from pin own to the one that follows, on the latter.
    [[nodiscard]] Plane<V> couple(int own) const noexcept {
        const V moment = 0.5 * (scratch(moment_row, own) + scratch(moment_row, own + 1));
        const V each = moment * contact(ContactComponents::inverse_length, own);
        return {-(each * contact(ContactComponents::frame_y, own)), each * contact(ContactComponents::frame_x, own)};
    }

    [[nodiscard]] V turning(int own) const noexcept {
        return (contact(ContactComponents::frame_x, own) * (velocity(axis.y, own + 1) - velocity(axis.y, own)) -
                contact(ContactComponents::frame_y, own) * (velocity(axis.x, own + 1) - velocity(axis.x, own))) *
               contact(ContactComponents::inverse_length, own);
    }

    void plates(int own) const noexcept {
        V gap_z = velocity(axis.z, own + 1) - velocity(axis.z, own), gap_e = velocity(axis.z + 1, own + 1) - velocity(axis.z + 1, own);
        if constexpr (Base::counts_from_recorded) {
            gap_z += contact(field_.components.plate_gap(), own);
            gap_e += contact(field_.components.plate_gap() + 1, own);
        }
        V fz(0.0), fe(0.0);
        for (int j = 0; j < field_.components.plates; ++j) {
            const Number xi = numbers_.plate_position[static_cast<std::size_t>(j)];
            const V slide = contact(field_.components.plate(j), own) * sliding_share<W, Steepest>(numbers_.plate, gap_z + xi * gap_e);
            fz += slide;
            fe += xi * slide;
        }
        put(plates_row, own, -fz);
        put(plates_row + 1, own, -fe);
    }

    /// Whether a tip of the pins side by side is pressed on.
    [[nodiscard]] bool touching(int own) const noexcept {
        const auto friction_limit = [&](int corner) { return contact(field_.components.tip(corner) + Tip::friction_limit, own); };
        return !all_at_most<W>(larger<W>(friction_limit(0), friction_limit(1)), 0.0);
    }
};

}  // namespace

}  // namespace cvtflow::model
