#pragma once
/// Plates of a link: elastic bars between the two halves, with friction against axial sliding. Lanes run over the plates, or over links.
/// Parts of both chains, sections of model/EQUATIONS.md; rigid pins are in model/rigid/:
///
///               pin halves (section 4)  rigid pins (section 11)                         energy          loss
///     stretch   plate_stretch()         rigid_links.hpp: link_force(), joint in series  Energy::plates  Loss::plate_damping
///     friction  plate_slide()           rigid_plates.hpp: plate_friction()                              Loss::plate_friction
///
/// T = k ε + c ε': tension of a plate [N]; v: sliding along the pins [m/s]; g: model/law/friction_laws.hpp [s/m].

#include "model/force/account.hpp"
#include "model/force/link_frame.hpp"
#include "model/law/friction_laws.hpp"

namespace cvtflow::model {
namespace {

/// Stretch of plates.
template <int W>
struct PlateStretch {
    Lanes<W> dx, dy, dz;           ///< distances between the halves [m]
    Lanes<W> vz;                   ///< sliding [m/s]
    Lanes<W> stretch, stretching;  ///< [m], [m/s]
    Lanes<W> tension;              ///< elastic and damping [N]
    Lanes<W> inverse_length;       ///< [1/m]
    Lanes<W> sliding;              ///< regular_speed(|vz|) [m/s]
    Lanes<W> inverse_sliding;      ///< [s/m]
};

/// @param stiffness, damping Lanes<W> over plates, or numbers of the one plate
template <int W, class Real, class Points, class Number>
[[nodiscard, gnu::always_inline]] inline PlateStretch<W> plate_stretch(const Coefficients& c, const Real& free_length,
                                                                       const Points& at_plates, const Number& stiffness,
                                                                       const Number& damping, const Difference<Real>& d,
                                                                       const Difference<Real>& rate) noexcept {
    using V = Lanes<W>;
    PlateStretch<W> s;
    s.dx = at_plates.along(d.x), s.dy = at_plates.along(d.y), s.dz = d.z + at_plates.xi * d.e;
    const V vx = at_plates.along(rate.x), vy = at_plates.along(rate.y);
    s.vz = rate.z + at_plates.xi * rate.e;
    const V length = sqrt(s.dx * s.dx + s.dy * s.dy + s.dz * s.dz);
    s.sliding = regular_speed<W>(c.plate_friction, abs(s.vz));
    const Reciprocals<W> inverse(length, s.sliding);
    s.inverse_length = inverse.first;
    s.inverse_sliding = inverse.second;
    s.stretch = length - free_length;
    s.stretching = (s.dx * vx + s.dy * vy + s.dz * s.vz) * inverse.first;
    s.tension = stiffness * s.stretch + damping * s.stretching;
    return s;
}

/// Friction of plates against axial sliding [N].
template <int W>
[[nodiscard]] inline Lanes<W> plate_slide(const Coefficients& c, const PlateStretch<W>& s) noexcept {
    return c.plate_friction.coefficient * positive_part<W>(s.tension) * slip_factor<W>(c.plate_friction, s.sliding, s.inverse_sliding) *
           s.vz;
}

/// Stored energy, power lost to damping and to friction: rows behind the terms of a force, where observed.
template <class Books>
inline constexpr std::size_t plate_rows = 2 * axis_terms + 2 + (Books::observed ? 3 : 0);

/// Sums of those rows, the three behind the force. totals [plate_rows]
template <class Real, class Books>
inline void book_plates(const Real* totals, Books& books) noexcept {
    books.store(Energy::plates, totals[2 * axis_terms + 2], 0.5);
    books.lose(Loss::plate_damping, totals[2 * axis_terms + 3]);
    books.lose(Loss::plate_friction, totals[2 * axis_terms + 4]);
}

/// Contributions of W plates of a link, or of one plate of W links, to the force on the front half, in the order of Difference.
/// @param slide plate_slide(), or Zero
template <int W, class Books, class Points, class Number, class Slide>
[[nodiscard, gnu::always_inline]] inline std::array<Lanes<W>, plate_rows<Books>> plate_terms(const Points& at_plates,
                                                                                             const Number& stiffness, const Number& damping,
                                                                                             const PlateStretch<W>& s,
                                                                                             const Slide& slide) noexcept {
    const Lanes<W> along = s.tension * s.inverse_length;
    std::array<Lanes<W>, plate_rows<Books>> terms;
    at_plates.spread(-along * s.dx, -along * s.dy, -along * s.dz - slide, terms.data());
    if constexpr (Books::observed) {
        terms[2 * axis_terms + 2] = stiffness * s.stretch * s.stretch;
        terms[2 * axis_terms + 3] = damping * s.stretching * s.stretching;
        terms[2 * axis_terms + 4] = slide * s.vz;
    }
    return terms;
}

/// Sum of the plates' elastic tensions.
template <class Kind, class Real>
[[nodiscard]] inline Real elastic_tension(const Coefficients& c, const Kind& kind, const Real* q) noexcept {
    using std::sqrt;
    const Difference<Real> d(q, End::front, q, End::rear);
    Real tension(0.0);
    for (std::size_t j = 0; j < static_cast<std::size_t>(c.plates.count); ++j) {
        Real dx(0.0), dy(0.0);
        for (int m = 0; m < axis_terms; ++m) {
            dx += d.x[m] * c.plates.basis[static_cast<std::size_t>(m)][j];
            dy += d.y[m] * c.plates.basis[static_cast<std::size_t>(m)][j];
        }
        const Real dz = d.z + c.plates.position[j] * d.e;
        tension += c.plates.weight[j] * (sqrt(dx * dx + dy * dy + dz * dz) - kind.free_length);
    }
    return tension;
}

}  // namespace
}  // namespace cvtflow::model
