#pragma once
/// Worked example of the recipe "a force element": a strut with damper between the halves of a link, evaluated for both chains side by
/// side. Compiled into kernels by model/force/further_element.hpp.
///
/// | symbol | meaning | unit |
/// | ℓ | distance of the middles of both halves: |d_0| of pin halves, |d| of rigid pins (EQUATIONS.md sections 1 and 11) | m |
/// | E = k (ℓ - ℓ_s)²/2 | stored energy, booked as Energy::pack | J |
/// | F = k (ℓ - ℓ_s) + c ℓ' | force that pulls the halves together | N |
/// | c ℓ'² | lost power, booked as Loss::inner | W |

#include "model/force/account.hpp"
#include "model/force/link_frame.hpp"

namespace cvtflow::model {
namespace {

struct FurtherElement {
    static constexpr double stiffness = 1e6;  ///< k [N/m]
    static constexpr double damping = 200.0;  ///< c [N·s/m]
    static constexpr double length = 8e-3;    ///< ℓ_s [m]

    /// Part that both chains share. @tparam Real a number, links side by side, or a number with derivatives
    template <class Real>
    struct Strut {
        Real force, energy, power;
        Strut(const Real& distance, const Real& rate) noexcept
            : force(stiffness * (distance - length) + damping * rate),
              energy(0.5 * stiffness * (distance - length) * (distance - length)),
              power(damping * rate * rate) {}
    };

    /// Pin halves: adds to the generalized forces f of a link with velocities v, and to its moment about z, which a strut has none of.
    template <class Real, class Books>
    static void of_halves(const LinkFrameOf<Real>& frame, const Real* v, Real* f, Real&, Books& books) noexcept {
        constexpr int xa = link_layout.x(End::rear, 0), ya = link_layout.y(End::rear, 0), xb = link_layout.x(End::front, 0),
                      yb = link_layout.y(End::front, 0);
        const Strut<Real> strut(1.0 / frame.inverse_length, (v[xb] - v[xa]) * frame.tx + (v[yb] - v[ya]) * frame.ty);
        const Real fx = strut.force * frame.tx, fy = strut.force * frame.ty;
        f[xb] -= fx;
        f[yb] -= fy;
        f[xa] += fx;
        f[ya] += fy;
        books.store(Energy::pack, strut.energy);
        books.lose(Loss::inner, strut.power);
    }

    /// Rigid pins: adds to the pull of links i … on their front halves; the rear halves get the opposite.
    template <class Motion, class Vector, class Sums>
    static void of_rigid_pins(const Motion& m, int i, Vector& pull, Sums& sums) noexcept {
        const Strut strut(1.0 / m.inverse, m.length_rate);
        pull = pull - strut.force * m.t;
        sums.pack.add(i, strut.energy);
        sums.inner.add(i, strut.power);
    }
};

}  // namespace
}  // namespace cvtflow::model
