#pragma once
/// The factors of a tip's friction law over lanes, with the same bits for every number of lanes. (model/EQUATIONS.md section 7)

#include "model/basis/lanes.hpp"
#include "model/law/tip_law.hpp"

namespace cvtflow::model {
namespace {

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

/// The same from v² [m²/s²]; constant below a µm/s, where a root has no slope.
template <int W>
[[nodiscard]] inline Lanes<W> speed_factor_of_square(const TipLaw& law, const Lanes<W>& square) noexcept {
    return speed_factor<W>(law, sqrt(larger<W>(square, Lanes<W>(1e-12))));
}

/// Factor by pressure ≥ 0, from √δ of Hertz' depth [√m].
template <int W>
[[nodiscard]] inline Lanes<W> pressure_factor(const TipLaw& law, const Lanes<W>& root_depth) noexcept {
    return positive_part<W>(Lanes<W>(law.without_pressure) + Lanes<W>(law.per_root_depth) * root_depth);
}

/// Sliding speed v ≥ slowest that solves v + b m(v) = w, with the law's factor m: two steps of Newton's method from the smallest solution
/// that is possible. Where friction falls so fast that there are several, steps are bounded and the first branch is kept.
/// @param braking b: by how much friction of its full strength slows the contact [m/s]   @param speed w, without friction [m/s]
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
