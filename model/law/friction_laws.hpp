#pragma once
/// The friction laws: how friction rises with speed, as the share s of its full strength, its secant s/v and its tangent ds/dv, over lanes
/// and so for numbers with derivatives, too. All start with the slope 1/v0 and are concave. (model/EQUATIONS.md section 7)
///
/// A law is a struct with these functions; `FrictionLaws` at the end lists them. What a curve holds of a law comes from the first three.

#include "model/basis/lanes.hpp"
#include "model/law/friction_curve.hpp"

namespace cvtflow::model {
namespace {

/// Linear up to the saturation speed, constant beyond.
struct PiecewiseLaw {
    static constexpr FrictionLaw law = FrictionLaw::piecewise;

    /// v/v0 up to which s = v/v0 [1], given `detail.smoothing` d [1].
    [[nodiscard]] static double proportional(double /*d*/) noexcept { return 1.0; }
    /// v/v0 from which s = 1 [1].
    [[nodiscard]] static double full(double /*d*/) noexcept { return 1.0; }
    /// FrictionCurve::shape; v0 [m/s].
    [[nodiscard]] static double shape(double /*d*/, double /*v0*/) noexcept { return 0.0; }

    /// What the secant divides by, > 0. speed ≥ 0 [m/s]
    template <int W>
    [[nodiscard]] static Lanes<W> divisor(const FrictionCurve& curve, const Lanes<W>& speed) noexcept {
        return larger<W>(speed, Lanes<W>(curve.proportional_speed));
    }
    /// s/v [s/m]. @param inverse 1/divisor, which the caller may have from a shared division
    template <int W>
    [[nodiscard]] static Lanes<W> secant(const FrictionCurve&, const Lanes<W>& /*divisor*/, const Lanes<W>& inverse) noexcept {
        return inverse;
    }
    /// ds/dv [s/m]. speed ≥ 0 [m/s]
    template <int W>
    [[nodiscard]] static Lanes<W> tangent(const FrictionCurve& curve, const Lanes<W>& speed) noexcept {
        return select_greater<W>(speed, Lanes<W>(curve.full_speed), Lanes<W>(0.0), Lanes<W>(curve.inverse_saturation_speed));
    }
    /// s with the sign of the velocity along one axis [1]. velocity [m/s]
    template <int W>
    [[nodiscard]] static Lanes<W> share(const FrictionCurve& curve, const Lanes<W>& velocity) noexcept {
        return larger<W>(smaller<W>(curve.inverse_saturation_speed * velocity, Lanes<W>(1.0)), Lanes<W>(-1.0));
    }
};

/// With the corner replaced by a parabola between 1 - d and 1 + d: s = u - (u - 1 + d)²/4d, written from its lower end, so that nothing
/// cancels at low speed.
struct SmoothedLaw {
    static constexpr FrictionLaw law = FrictionLaw::smoothed;

    [[nodiscard]] static double proportional(double d) noexcept { return 1.0 - d; }  ///< d [1]
    [[nodiscard]] static double full(double d) noexcept { return 1.0 + d; }          ///< d [1]
    /// 1/(4 d v0²) [s²/m²]
    [[nodiscard]] static double shape(double d, double v0) noexcept { return 0.25 / (d * v0 * v0); }

    template <int W>
    [[nodiscard]] static Lanes<W> divisor(const FrictionCurve& curve, const Lanes<W>& speed) noexcept {
        return PiecewiseLaw::divisor<W>(curve, speed);
    }
    template <int W>
    [[nodiscard]] static Lanes<W> secant(const FrictionCurve& curve, const Lanes<W>& divisor, const Lanes<W>& inverse) noexcept {
        const Lanes<W> beyond = divisor - curve.proportional_speed;
        const Lanes<W> parabola = curve.inverse_saturation_speed - curve.shape * (beyond * beyond) * inverse;
        return select_greater<W>(divisor, Lanes<W>(curve.full_speed), inverse, parabola);
    }
    template <int W>
    [[nodiscard]] static Lanes<W> tangent(const FrictionCurve& curve, const Lanes<W>& speed) noexcept {
        const Lanes<W> beyond = positive_part<W>(speed - curve.proportional_speed);
        return select_greater<W>(speed, Lanes<W>(curve.full_speed), Lanes<W>(0.0),
                                 curve.inverse_saturation_speed - 2.0 * curve.shape * beyond);
    }
    template <int W>
    [[nodiscard]] static Lanes<W> share(const FrictionCurve& curve, const Lanes<W>& velocity) noexcept {
        const Lanes<W> speed = abs(velocity), beyond = positive_part<W>(speed - curve.proportional_speed);
        const Lanes<W> rising = curve.inverse_saturation_speed * speed - curve.shape * (beyond * beyond);
        const Lanes<W> reached = select_greater<W>(speed, Lanes<W>(curve.full_speed), Lanes<W>(1.0), rising);
        return select_greater<W>(velocity, Lanes<W>(0.0), reached, -reached);
    }
};

/// Some laws, one of which is chosen when the program runs.
template <class First, class... Rest>
struct LawList {
    /// act(Law{}) for the law; for the last one otherwise.
    template <class Act>
    [[gnu::always_inline]] static auto visit(FrictionLaw law, const Act& act) noexcept {
        if constexpr (sizeof...(Rest) == 0) {
            return act(First{});
        } else {
            return law == First::law ? act(First{}) : LawList<Rest...>::visit(law, act);
        }
    }
};

/// All laws of `detail.friction`.
using FrictionLaws = LawList<PiecewiseLaw, SmoothedLaw>;

}  // namespace
}  // namespace cvtflow::model
