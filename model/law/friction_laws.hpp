#pragma once
/// The friction laws: how friction rises with speed, as the share s of its full strength, its secant s/v and its tangent ds/dv, over lanes
/// and so for numbers with derivatives, too. All start with the slope 1/v0 and are concave. The factors of a tip's law by speed and by
/// pressure are at the end. The bits are the same for every number of lanes. (model/EQUATIONS.md section 7)
///
/// Force of a contact: μ N · s(v/v0) · by speed · by pressure. Two keys of a scene choose its factors:
///
///     key                 factor                                  laws
///     detail.friction     s(v/v0), of all contacts                FrictionLaws: PiecewiseLaw, SmoothedLaw
///     tip.friction_law    by speed and pressure, of tips alone    TipLaw: constant (none), table, lubricated (tip_law())
///
/// A law of the first kind is a struct with these functions; `FrictionLaws` lists them. A curve takes its numbers from the
/// first three. One of the second kind is a table: a function that fills TipLaw::by_speed, whatever its formula.

#include <algorithm>
#include <utility>

#include "model/basis/lanes.hpp"
#include "model/law/friction.hpp"

namespace cvtflow::model {
namespace {

/// Linear up to the saturation speed, constant beyond.
struct PiecewiseLaw {
    static constexpr FrictionLaw law = FrictionLaw::piecewise;

    /// v/v0 up to which s = v/v0 [1], given `detail.smoothing` d [1].
    [[nodiscard]] static double proportional(double /*d*/) noexcept { return 1.0; }
    /// v/v0 from which s = 1 [1].
    [[nodiscard]] static double full(double /*d*/) noexcept { return 1.0; }
    /// FrictionCurve::shape. v0 [m/s]
    [[nodiscard]] static double shape(double /*d*/, double /*v0*/) noexcept { return 0.0; }

    /// Divisor of the secant, > 0. speed ≥ 0 [m/s]
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

/// Piecewise law with a parabola instead of the corner, between 1 - d and 1 + d: s = u - (u - 1 + d)²/4d, written from its lower end, so
/// that nothing cancels at low speed.
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

/// The speed that the slope divides by, > 0: for some laws v itself, but at least the speed below which s is proportional to v. [m/s]
template <int W, class Laws = FrictionLaws>
[[nodiscard]] inline Lanes<W> regular_speed(const FrictionCurve& curve, const Lanes<W>& speed) noexcept {
    return Laws::visit(curve.law, [&](auto law) { return law.template divisor<W>(curve, speed); });
}

/// The secant g(v) = s/v [s/m]. Continuous.
/// @param regular regular_speed(v)   @param inverse 1/regular, which the caller may have from a shared division
template <int W, class Laws = FrictionLaws>
[[nodiscard]] inline Lanes<W> slip_factor(const FrictionCurve& curve, const Lanes<W>& regular, const Lanes<W>& inverse) noexcept {
    return Laws::visit(curve.law, [&](auto law) { return law.template secant<W>(curve, regular, inverse); });
}

/// g(v) for speeds v ≥ 0 [m/s].
template <int W, class Laws = FrictionLaws>
[[nodiscard]] inline Lanes<W> slip_factor(const FrictionCurve& curve, const Lanes<W>& speed) noexcept {
    const Lanes<W> regular = regular_speed<W, Laws>(curve, speed);
    return slip_factor<W, Laws>(curve, regular, 1.0 / regular);
}

/// g(v) from v² [m²/s²]. Where no lane slips beyond the proportional speed, nothing is divided and no root taken: the factor is known, to
/// the bit.
template <int W, class Laws = FrictionLaws>
[[nodiscard]] inline Lanes<W> slip_factor_of_square(const FrictionCurve& curve, const Lanes<W>& square) noexcept {
    if (all_at_most<W>(square, curve.linear_speed_squared)) return Lanes<W>(curve.inverse_saturation_speed);
    return slip_factor<W, Laws>(curve, sqrt(square));
}

/// The tangent ds/dv [s/m] for speeds v ≥ 0 [m/s].
template <int W, class Laws = FrictionLaws>
[[nodiscard]] inline Lanes<W> slip_tangent(const FrictionCurve& curve, const Lanes<W>& speed) noexcept {
    return Laws::visit(curve.law, [&](auto law) { return law.template tangent<W>(curve, speed); });
}

/// s of a velocity along one axis [m/s], with its sign [1].
template <int W, class Laws = FrictionLaws>
[[nodiscard]] inline Lanes<W> friction_share(const FrictionCurve& curve, const Lanes<W>& velocity) noexcept {
    return Laws::visit(curve.law, [&](auto law) { return law.template share<W>(curve, velocity); });
}

/// Divisor v/s(v) of the secant at the speed v ≥ 0 that friction leaves a contact: v + b s(v) = left + b, b the speed that friction of full
/// strength takes. Newton's method from below, where it cannot overshoot: s is concave. Four steps find s to 5e-5 with b = 1000 v0. [m/s]
/// @param left what that would leave, may be below 0 [m/s]   @param braking b [m/s]
template <int W, class Laws = FrictionLaws>
[[nodiscard]] inline Lanes<W> divisor_left(const FrictionCurve& curve, const Lanes<W>& left, const Lanes<W>& braking) noexcept {
    return Laws::visit(curve.law, [&](auto law) {
        if constexpr (law.law == FrictionLaw::piecewise) return larger<W>(left, Lanes<W>(curve.saturation_speed));
        Lanes<W> v = positive_part<W>(left);
        for (int step = 0; step < 4; ++step) {
            const Lanes<W> missing = left - v + braking * (1.0 - law.template share<W>(curve, v));
            v = positive_part<W>(v + missing / (1.0 + braking * law.template tangent<W>(curve, v)));
        }
        return 1.0 / slip_factor<W, Laws>(curve, v);
    });
}

/// Factor by sliding speed ≥ 0 [m/s]. Every interval adds what it gains below the speed, so no lane has to find its interval.
template <int W>
[[nodiscard]] inline Lanes<W> speed_factor(const TipLaw& law, const Lanes<W>& speed) noexcept {
    const SpeedProfile& p = law.by_speed;
    Lanes<W> sum(p.first);
    for (std::size_t k = 0; k < static_cast<std::size_t>(p.intervals); ++k) {
        const Lanes<W> along = (speed - Lanes<W>(p.begin[k])) * Lanes<W>(p.inverse[k]);
        const Lanes<W> t = larger<W>(smaller<W>(along, Lanes<W>(1.0)), Lanes<W>(0.0));
        sum += t * (Lanes<W>(p.linear[k]) + t * (Lanes<W>(p.square[k]) + t * Lanes<W>(p.cube[k])));
    }
    return sum;
}

/// d factor/d speed [s/m].
template <int W>
[[nodiscard]] inline Lanes<W> speed_factor_slope(const TipLaw& law, const Lanes<W>& speed) noexcept {
    const SpeedProfile& p = law.by_speed;
    const Lanes<W> none(0.0), one(1.0);
    Lanes<W> sum(0.0);
    for (std::size_t k = 0; k < static_cast<std::size_t>(p.intervals); ++k) {
        const Lanes<W> inverse(p.inverse[k]), t = (speed - Lanes<W>(p.begin[k])) * inverse;
        const Lanes<W> slope = (Lanes<W>(p.linear[k]) + t * (Lanes<W>(2.0 * p.square[k]) + t * Lanes<W>(3.0 * p.cube[k]))) * inverse;
        sum += select_greater<W>(t, none, select_greater<W>(one, t, slope, none), none);
    }
    return sum;
}

/// speed_factor() from v² [m²/s²]; constant below a µm/s, where a root has no slope.
template <int W>
[[nodiscard]] inline Lanes<W> speed_factor_of_square(const TipLaw& law, const Lanes<W>& square) noexcept {
    return speed_factor<W>(law, sqrt(larger<W>(square, Lanes<W>(1e-12))));
}

/// Speed w that a contact remembers, a step after it was `before`, at a constant sliding speed: w' = (speed + v0) (speed - w)/L, by Padé's
/// approximant 1/(1 + x + x²/2) of e^-x, which is between 0 and 1 and tends to 0. [m/s]
/// @param step [s]   @param before, speed ≥ 0 [m/s]
template <int W>
[[nodiscard]] inline Lanes<W> remembered_speed(const TipLaw& law, double saturation_speed, double step, const Lanes<W>& before,
                                               const Lanes<W>& speed) noexcept {
    constexpr double fastest = 1e12;  // 1/m: x² stays a float
    const Lanes<W> x = (speed + Lanes<W>(saturation_speed)) * Lanes<W>(std::min(step / law.memory, fastest));
    const Lanes<W> passed = x + 0.5 * x * x;
    return before + (speed - before) * (passed / (1.0 + passed));
}

/// Factor by pressure ≥ 0, from √δ of Hertz' depth [√m].
template <int W>
[[nodiscard]] inline Lanes<W> pressure_factor(const TipLaw& law, const Lanes<W>& root_depth) noexcept {
    return positive_part<W>(Lanes<W>(law.without_pressure) + Lanes<W>(law.per_root_depth) * root_depth);
}

/// Sliding speed v ≥ slowest that solves v + b m(v) = w, with the law's factor m: two steps of Newton's method from the smallest solution
/// that is possible. Where friction falls so fast that there are several, steps are bounded and the first branch is kept.
/// @param braking b: speed that the contact loses by friction of its full strength [m/s]   @param speed w, without friction [m/s]
template <int W>
[[nodiscard]] inline Lanes<W> braked_speed(const TipLaw& law, const Lanes<W>& braking, const Lanes<W>& speed,
                                           const Lanes<W>& slowest) noexcept {
    Lanes<W> v = larger<W>(speed - braking, slowest);
    for (int step = 0; step < 2; ++step) {
        const Lanes<W> excess = v + braking * speed_factor<W>(law, v) - speed;
        const Lanes<W> slope = larger<W>(Lanes<W>(1.0) + braking * speed_factor_slope<W>(law, v), Lanes<W>(0.25));
        v = larger<W>(v - excess / slope, slowest);
    }
    return v;
}

}  // namespace
}  // namespace cvtflow::model
