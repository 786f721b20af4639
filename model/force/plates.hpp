#pragma once
/// Plates of a link: elastic bars between the two halves, with friction against axial sliding. Lanes run over links.
/// Parts of both chains, sections of model/EQUATIONS.md; rigid pins are in model/rigid/:
///
///               pin halves (section 4)  rigid pins (section 11)                         energy          loss
///     stretch   plate_stretch()         rigid_links.hpp: link_force(), joint in series  Energy::plates  Loss::plate_damping
///     friction  plate_slide()           rigid_plates.hpp: plate_friction()                              Loss::plate_friction
///
/// T = k ε + c ε': tension of a plate [N]. In the default's step friction is solved for by the sweeps (model/contact/sweep_lanes.hpp); its
/// limit is that of plate_limit().

#include "model/force/account.hpp"
#include "model/force/link_frame.hpp"
#include "model/law/friction_laws.hpp"

namespace cvtflow::model {
namespace {

/// How the halves of packs are apart.
template <class Real>
struct PackPlace {
    Difference<Real> apart;
    Real longer;       ///< mean distance along the link beyond the free length [m]
    Real free_length;  ///< [m]
};
/// @param q coordinates of the links
template <class Real>
[[nodiscard]] inline PackPlace<Real> pack_place(const Real* q, const LinkFrameOf<Real>& frame, const Real& free_length) noexcept {
    const Difference<Real> apart(q, End::front, q, End::rear);
    return {apart, apart.x[0] * frame.tx + apart.y[0] * frame.ty - free_length, free_length};
}

/// Modes of that, or of how fast, along the link and across it; of the mean along it what exceeds the free length.
template <class Real>
struct PackOpening {
    Real along[axis_terms], across[axis_terms], z, e;

    PackOpening(const Difference<Real>& d, const LinkFrameOf<Real>& frame) noexcept : z(d.z), e(d.e) {
        for (int m = 0; m < axis_terms; ++m) {
            along[m] = d.x[m] * frame.tx + d.y[m] * frame.ty;
            across[m] = d.y[m] * frame.tx - d.x[m] * frame.ty;
        }
    }
    PackOpening(const PackPlace<Real>& place, const LinkFrameOf<Real>& frame) noexcept : PackOpening(place.apart, frame) {
        along[0] = place.longer;
        across[0] = Real(0.0);
    }
};

/// A distance between the ends of plates, a velocity or a force on the front one: along the link, across it, along the pins.
template <class Real>
struct PlateVector {
    Real along, across, z;
};

/// Plates, one of each of W links.
template <int W>
struct PlateStretch {
    Lanes<W> whole;                ///< distance of the halves along the link [m]
    Lanes<W> inverse_length;       ///< [1/m]
    Lanes<W> stretch, stretching;  ///< [m], [m/s]
    Lanes<W> elastic, damped;      ///< forces of spring and damper [N]
    Lanes<W> tension;              ///< their sum [N]
};

/// A plate of free length ℓ that is longer by x, across by y and z: |(ℓ + x, y, z)| - ℓ = x + (y² + z²)/(|…| + ℓ + x), so that the stretch
/// (µm) does not drown in the rounding of ℓ.   @param stiffness [N/m], damping [N·s/m]   @param d its `along` is x
template <int W, class Number>
[[nodiscard, gnu::always_inline]] inline PlateStretch<W> plate_stretch(const Lanes<W>& free_length, const Number& stiffness,
                                                                       const Number& damping, const PlateVector<Lanes<W>>& d,
                                                                       const PlateVector<Lanes<W>>& rate) noexcept {
    PlateStretch<W> s;
    s.whole = free_length + d.along;
    const Lanes<W> square = d.across * d.across + d.z * d.z, length = sqrt(s.whole * s.whole + square);
    const Reciprocals<W> inverse(length, length + s.whole);
    s.inverse_length = inverse.first;
    s.stretch = d.along + square * inverse.second;
    s.stretching = (s.whole * rate.along + d.across * rate.across + d.z * rate.z) * inverse.first;
    s.elastic = stiffness * s.stretch;
    s.damped = damping * s.stretching;
    s.tension = s.elastic + s.damped;
    return s;
}

/// Full friction of plates against axial sliding: μ N [N].
template <int W>
[[nodiscard]] inline Lanes<W> plate_limit(const Coefficients& c, const PlateStretch<W>& s) noexcept {
    return c.plate_friction.coefficient * positive_part<W>(s.tension);
}
/// Their friction per speed of sliding [N·s/m].
template <int W>
[[nodiscard]] inline Lanes<W> plate_slide(const Coefficients& c, const PlateStretch<W>& s, const Lanes<W>& sliding) noexcept {
    return plate_limit(c, s) * slip_factor<W>(c.plate_friction, abs(sliding));
}

/// Force on the front end. @param slide plate_slide(), or Zero
template <int W, class Slide>
[[nodiscard, gnu::always_inline]] inline PlateVector<Lanes<W>> plate_force(const PlateStretch<W>& s, const PlateVector<Lanes<W>>& d,
                                                                           const Lanes<W>& sliding, const Slide& slide) noexcept {
    const Lanes<W> pull = -s.tension * s.inverse_length;
    return {pull * s.whole, pull * d.across, pull * d.z - slide * sliding};
}

/// Modes at places that are mirrored in the middle.
template <int W>
struct MirroredPoints {
    Lanes<W> even, odd;
    MirroredPoints(const Lanes<W>* modes, const AxisPoint<W>& at) noexcept
        : even(modes[0] + at.basis[2] * modes[2]), odd(at.basis[1] * modes[1] + at.basis[3] * modes[3]) {}
    [[nodiscard]] Lanes<W> at(bool mirrored) const noexcept { return mirrored ? even - odd : even + odd; }
};

/// All plates of W links, two at a time that are mirrored in the middle: force on the front halves.
/// @param frictions friction per speed, or Zero, from a plate's number, PlateStretch and sliding speed
template <int W, class Points, class Books, class Frictions>
[[nodiscard, gnu::always_inline]] inline Difference<Lanes<W>> pack_force(const Points& plates, const PackPlace<Lanes<W>>& place,
                                                                         const PackOpening<Lanes<W>>& rate,
                                                                         const LinkFrameOf<Lanes<W>>& frame, Books& books,
                                                                         const Frictions& frictions) noexcept {
    using V = Lanes<W>;
    static_assert(axis_terms == 4);
    const PackOpening<V> d(place, frame);
    V along[axis_terms], across[axis_terms];
    for (int m = 0; m < axis_terms; ++m) along[m] = across[m] = V(0.0);
    Difference<V> force;
    for (int plate = plates.count / 2; plate < plates.count; ++plate) {
        const int opposite = plates.count - 1 - plate;
        const AxisPoint<W> at(plates, plate);
        const MirroredPoints<W> points[4] = {{d.along, at}, {d.across, at}, {rate.along, at}, {rate.across, at}};
        const auto pull = [&](int one, bool mirrored) {
            const auto j = static_cast<std::size_t>(one);
            const V tilt = at.xi * d.e, tilting = at.xi * rate.e;
            const PlateVector<V> to{points[0].at(mirrored), points[1].at(mirrored), mirrored ? d.z - tilt : d.z + tilt},
                moving{points[2].at(mirrored), points[3].at(mirrored), mirrored ? rate.z - tilting : rate.z + tilting};
            const auto s = plate_stretch<W>(place.free_length, plates.weight[j], plates.damping[j], to, moving);
            books.store(Energy::plates, s.elastic * s.stretch, 0.5);
            books.lose(Loss::plate_damping, s.damped * s.stretching);
            const auto slide = frictions(one, s, moving.z);
            books.lose(Loss::plate_friction, number<V>(slide * moving.z) * moving.z);
            return plate_force<W>(s, to, moving.z, slide);
        };
        const PlateVector<V> a = pull(plate, false);
        const PlateVector<V> b = opposite == plate ? PlateVector<V>{V(0.0), V(0.0), V(0.0)} : pull(opposite, true);
        const auto spread = [&](const V& sum, const V& difference, V* modes) {
            modes[0] += sum;
            modes[1] += at.basis[1] * difference;
            modes[2] += at.basis[2] * sum;
            modes[3] += at.basis[3] * difference;
        };
        spread(a.along + b.along, a.along - b.along, along);
        spread(a.across + b.across, a.across - b.across, across);
        force.z += a.z + b.z;
        force.e += at.xi * (a.z - b.z);
    }
    for (int m = 0; m < axis_terms; ++m) {
        force.x[m] = along[m] * frame.tx - across[m] * frame.ty;
        force.y[m] = along[m] * frame.ty + across[m] * frame.tx;
    }
    return force;
}

}  // namespace
}  // namespace cvtflow::model
