#pragma once
/// Plates of a link: elastic bars between the two halves, with friction against axial sliding. Lanes run over the plates, or over links.
/// (model/EQUATIONS.md section 4)

#include "model/force/account.hpp"
#include "model/force/difference.hpp"
#include "model/law/friction.hpp"

namespace cvtflow::model {
namespace {

/// Elastic and damping tension of plates [N], as plate_terms() has it.
template <int P, int W, class Real, class Points, class Number>
[[nodiscard]] inline Lanes<W> plate_tension(const Coefficients& c, const Real& free_length, const Points& at_plates,
                                            const Number& stiffness, const Number& damping, const Difference<P, Real>& d,
                                            const Difference<P, Real>& rate) noexcept {
    using V = Lanes<W>;
    const V dx = at_plates.along(d.x), dy = at_plates.along(d.y), dz = d.z + at_plates.xi * d.e;
    const V vx = at_plates.along(rate.x), vy = at_plates.along(rate.y), vz = rate.z + at_plates.xi * rate.e;
    const V length = sqrt(dx * dx + dy * dy + dz * dz);
    const Reciprocals<W> inverse(length, regular_speed<W>(c.plate_friction, abs(vz)));
    return stiffness * (length - free_length) + damping * ((dx * vx + dy * vy + dz * vz) * inverse.first);
}

/// Behind the terms of a force, where observed: stored energy, power lost to damping and to friction.
inline constexpr std::size_t plate_books = 3;
template <int P, bool Observe>
inline constexpr std::size_t plate_rows = 2 * P + 4 + (Observe ? plate_books : 0);

/// Sums of those rows to an Account, or to LaneAccounts. books [plate_books]
template <class Real, class Book>
inline void book_plates(const Real* books, Book account) noexcept {
    account->store(Energy::plates, 0.5 * books[0]);
    account->lose(Loss::plate_damping, books[1]);
    account->lose(Loss::plate_friction, books[2]);
}

/// What W plates of a link, or one plate of W links, add to the force on the front half, in the order of Difference.
/// @param stiffness, damping Lanes<W> over plates, or numbers of the one plate
template <int P, int W, bool Observe, class Real, class Points, class Number>
[[nodiscard]] inline std::array<Lanes<W>, plate_rows<P, Observe>> plate_terms(const Coefficients& c, const Real& free_length,
                                                                              const Points& at_plates, const Number& stiffness,
                                                                              const Number& damping, const Difference<P, Real>& d,
                                                                              const Difference<P, Real>& rate) noexcept {
    using V = Lanes<W>;
    const V dx = at_plates.along(d.x), dy = at_plates.along(d.y), dz = d.z + at_plates.xi * d.e;
    const V vx = at_plates.along(rate.x), vy = at_plates.along(rate.y), vz = rate.z + at_plates.xi * rate.e;
    const V length = sqrt(dx * dx + dy * dy + dz * dz);
    const V sliding = regular_speed<W>(c.plate_friction, abs(vz));
    const Reciprocals<W> inverse(length, sliding);
    const V stretch = length - free_length;
    const V stretching = (dx * vx + dy * vy + dz * vz) * inverse.first;
    const V tension = stiffness * stretch + damping * stretching;
    const V slide =
        c.plate_friction.coefficient * positive_part<W>(tension) * slip_factor<W>(c.plate_friction, sliding, inverse.second) * vz;
    const V along = tension * inverse.first;
    std::array<V, plate_rows<P, Observe>> terms;
    at_plates.spread(-along * dx, -along * dy, -along * dz - slide, terms.data());
    if constexpr (Observe) {
        terms[2 * P + 4] = stiffness * stretch * stretch;
        terms[2 * P + 5] = damping * stretching * stretching;
        terms[2 * P + 6] = slide * vz;
    }
    return terms;
}

/// One chunk of W plates; adds the force on the front half to `pull`.
template <int P, int W, bool Observe>
inline void plate_chunk(const Coefficients& c, double free_length, const Difference<P>& d, const Difference<P>& rate, int first,
                        Difference<P>& pull, [[maybe_unused]] Account* account) noexcept {
    const auto of = [first](const auto& numbers) { return load<W>(&numbers[static_cast<std::size_t>(first)]); };
    alignas(64) double total[plate_rows<P, Observe>];
    sums<W>(
        plate_terms<P, W, Observe>(c, free_length, AxisPoints<P, W>(c.plates, first), of(c.plates.weight), of(c.plates.damping), d, rate),
        total);
    pull.add(total);
    if constexpr (Observe) book_plates(total + 2 * P + 4, account);
}

/// All plates of a link. Adds to the generalized forces f of the link. q [coordinates of the link], v [m/s], f [N, N·m]
template <int P, int W, bool Observe>
inline void plates(const Coefficients& c, const LinkKind& kind, const double* q, const double* v, double* f, Account* account) noexcept {
    const Difference<P> d(q, End::front, q, End::rear);
    const Difference<P> rate(v, End::front, v, End::rear);
    Difference<P> pull;
    for (int first = 0; first < c.plates.count; first += W) plate_chunk<P, W, Observe>(c, kind.free_length, d, rate, first, pull, account);
    pull.apply(1.0, f, End::front);
    pull.apply(-1.0, f, End::rear);
}

}  // namespace
}  // namespace cvtflow::model
