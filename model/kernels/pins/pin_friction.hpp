#pragma once
/// Friction of whole pins as a function of velocities, lanes over pins: two tips each, plates of the link behind which a pin lies. Every
/// lane does the same operations in the same order whatever its neighbours are. (model/EQUATIONS.md sections 4, 6, 7 and 10)

#include "model/contact/friction_tips.hpp"
#include "model/kernels/pins/pin_rows.hpp"

namespace cvtflow::model {
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
