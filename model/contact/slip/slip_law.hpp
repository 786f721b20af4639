#pragma once
/// The friction law at a contact with two slips: force, its derivative as a product of roots, lanes over links. (model/EQUATIONS.md section
/// 7)

#include "model/contact/slip/slip_rows.hpp"
#include "model/law/friction.hpp"

namespace cvtflow::model {
namespace {

/// φ(w) and R with φ'(w) = R Rᵀ, row by row.
struct SlipLaw {
    SlipV force[2];
    FloatLanes root[4];
};

template <int Points>
class SlipLaws {
public:
    using Rows = SlipRows<Points>;
    using Point = typename Rows::Point;
    using Tip = typename Rows::Tip;
    using V = SlipV;

    SlipLaws(const SlipSpace& space, SlipGroup& group) noexcept
        : rows_(space, group), c_(space.chain().coefficients()), tip_curve_(space.tip_curve()), g_(group) {}

    /// Rooted: with R, else only the force. @param w the contact's two slips
    template <bool Rooted>
    [[nodiscard]] SlipLaw law(int contact, const V* w) const noexcept {
        if (g_.continuation == 1.0) return usual<Rooted>(contact, w);
        const double inverse = 1.0 / g_.continuation;
        const V less[2] = {inverse * w[0], inverse * w[1]};
        SlipLaw wide = usual<Rooted>(contact, less);
        if (!Rooted) return wide;
        for (FloatLanes& root : wide.root) root = FloatLanes(static_cast<float>(__builtin_sqrt(inverse))) * root;
        return wide;
    }

private:
    /// The law with the saturation speeds that it has.
    template <bool Rooted>
    [[nodiscard]] SlipLaw usual(int contact, const V* w) const noexcept {
        if (contact == SlipContacts::plates) return of_plates<Rooted>(w);
        if (contact < SlipContacts::first_joint) return of_tip<Rooted>(contact - SlipContacts::first_tip, w);
        const int number = contact - SlipContacts::first_joint;
        const V friction_limit = number < rows_.points() ? rows_.point(End::rear, number, Point::friction_limit)
                                                         : rows_.point(End::front, number - rows_.points(), Point::friction_limit);
        return isotropic<Rooted>(c_.joint.friction, friction_limit, w, V(0.0));
    }

    /// Along the slip the tangent counts, across it the secant.
    template <bool Rooted>
    [[nodiscard]] static SlipLaw isotropic(const FrictionCurve& curve, const V& friction_limit, const V* w, const V& sticks) noexcept {
        const V speed = sqrt(w[0] * w[0] + w[1] * w[1]), half(0.5);
        const V at_rest(curve.inverse_saturation_speed);
        const V secant = select_greater<slip_lanes>(sticks, half, at_rest, slip_factor<slip_lanes>(curve, speed));
        const V tangent = select_greater<slip_lanes>(sticks, half, at_rest, slip_tangent<slip_lanes>(curve, speed));
        const V held = friction_limit * secant;
        if constexpr (!Rooted) return {{held * w[0], held * w[1]}, {}};
        const FloatLanes along = sqrt(narrow(friction_limit * tangent)), across = sqrt(narrow(held)), rough = narrow(speed), least(1e-30f);
        const FloatLanes inverse = 1.0f / larger(rough, least);
        const FloatLanes x = select_greater(rough, least, inverse * narrow(w[0]), 1.0f),
                         y = select_greater(rough, least, inverse * narrow(w[1]), 0.0f);
        return {{held * w[0], held * w[1]}, {along * x, -(across * y), along * y, across * x}};
    }

    template <bool Rooted>
    [[nodiscard]] SlipLaw of_tip(int corner, const V* w) const noexcept {
        return isotropic<Rooted>(tip_curve_, rows_.tip_value(corner, Tip::friction_limit), w, rows_.tip_value(corner, Tip::sticks));
    }

    /// Plates slide by w_0 + ξ w_1 each.
    template <bool Rooted>
    [[nodiscard]] SlipLaw of_plates(const V* w) const noexcept {
        const FrictionCurve& curve = c_.plate_friction;
        SlipLaw all{{V(0.0), V(0.0)}, {0.0f, 0.0f, 0.0f, 0.0f}};
        V k00(0.0), k10(0.0), k11(0.0);
        for (int plate = 0; plate < c_.plates.count; ++plate) {
            const double xi = c_.plates.position[static_cast<std::size_t>(plate)];
            const V sliding = w[0] + xi * w[1];
            const V friction_limit = get(g_.plates, plate);
            const V force = friction_limit * friction_share<slip_lanes>(curve, sliding),
                    tangent = friction_limit * slip_tangent<slip_lanes>(curve, abs(sliding));
            all.force[0] += force;
            all.force[1] += xi * force;
            if constexpr (!Rooted) continue;
            k00 += tangent;
            k10 += xi * tangent;
            k11 += xi * (xi * tangent);
        }
        if constexpr (!Rooted) return all;
        const FloatLanes top = sqrt(narrow(k00));
        const FloatLanes below = narrow(k10) / larger(top, 1e-30f);
        all.root[0] = top;
        all.root[2] = below;
        all.root[3] = sqrt(larger(narrow(k11) - below * below, 0.0f));
        return all;
    }

    Rows rows_;
    const Coefficients& c_;
    const FrictionCurve& tip_curve_;
    const SlipGroup& g_;
};

}  // namespace
}  // namespace cvtflow::model
