#pragma once
/// Worked example of the recipe "a force element": a damper along the links of both chains, F = c ℓ' [N] with c [N·s/m] and the rate ℓ' at
/// which the halves of a link part; c ℓ'² [W] is booked as Loss::inner. Compiled into kernels by model/force/further_element.hpp.
///
/// The default's numbers are floats: what is given here as coordinates has lost the digits of a stretch. An element of a stretch or a depth
/// takes its difference of doubles, as pack_place() does; a rate loses 1 um/s.

#include "model/force/account.hpp"
#include "model/force/link_frame.hpp"

namespace cvtflow::model {

inline double damping_of_example = 0.0;  ///< c [N·s/m]

namespace {

struct FurtherElement {
    /// Pin halves: adds to the generalized forces f of a link with velocities v, and to its moment about z, which a damper has none of.
    template <class Real, class Books>
    static void of_halves(const LinkFrameOf<Real>& frame, const Real* v, Real* f, Real&, Books& books) noexcept {
        constexpr int xa = link_layout.x(End::rear, 0), ya = link_layout.y(End::rear, 0), xb = link_layout.x(End::front, 0),
                      yb = link_layout.y(End::front, 0);
        const Real rate = (v[xb] - v[xa]) * frame.tx + (v[yb] - v[ya]) * frame.ty, force = damping_of_example * rate;
        f[xb] -= force * frame.tx;
        f[yb] -= force * frame.ty;
        f[xa] += force * frame.tx;
        f[ya] += force * frame.ty;
        books.lose(Loss::inner, force * rate);
    }

    /// Rigid pins: adds to the pull of links i … on their front halves; the rear halves get the opposite.
    template <class Motion, class Vector, class Sums>
    static void of_rigid_pins(const Motion& m, int i, Vector& pull, Sums& sums) noexcept {
        const auto force = damping_of_example * m.length_rate;
        pull = pull - force * m.t;
        sums.inner.add(i, force * m.length_rate);
    }
};

}  // namespace
}  // namespace cvtflow::model
