#pragma once
/// Guides of the strands: two rails, inside and outside of each strand, fixed in space along the common tangents of the pulleys at the
/// start ratio. Contact with a pin, or with half of one. (model/EQUATIONS.md section 8)

#include "model/basis/lanes.hpp"
#include "model/force/account.hpp"
#include "model/force/link_frame.hpp"
#include "model/machine/coefficients.hpp"

namespace cvtflow::model {
namespace {

/// Pins side by side at a guide, in the lower strand mirrored to the upper one.
template <int W>
struct GuideContact {
    using V = Lanes<W>;
    V share;              ///< fraction of the stiffness: 1, less at the ends of a rail, 0 outside it
    V offset;             ///< u from the middle between the rails, outwards [m]
    V energy;             ///< [J]
    V normal;             ///< N ≥ 0 [N]
    V damping, approach;  ///< damping part of N [N], against its rate d' [m/s]
    V friction, speed;    ///< force along the strand [N], against its speed s' [m/s]
    V fx, fy;             ///< force on the pin [N]

    /// @param part of a pin: 1, or ½ for one of its halves   @param x, y [m]   @param vx, vy [m/s]
    GuideContact(const GuideCoefficients& g, double part, const V& x, const V& y, const V& vx, const V& vy) noexcept {
        const V one(1.0), strand = select_greater<W>(y, V(0.0), one, -one), up = strand * y, up_rate = strand * vy;
        const V along = g.cosine * x + g.sine * up;
        speed = g.cosine * vx + g.sine * up_rate;
        offset = g.cosine * up - g.sine * x - g.radius;
        const V side = select_greater<W>(offset, V(0.0), one, -one);
        const V depth = positive_part<W>(side * offset - g.clearance);
        approach = side * (g.cosine * up_rate - g.sine * vx);
        const V entered = along - g.begin, left = g.end - along;
        const V way = positive_part<W>(smaller<W>(g.per_ramp * smaller<W>(entered, left), one));
        const V inward = select_greater<W>(left, entered, one, -one);
        share = way * way * (3.0 - 2.0 * way);
        const V elastic = (part * g.stiffness) * share * depth;
        energy = 0.5 * elastic * depth;
        normal = elastic * positive_part<W>(1.0 + g.damping * approach);
        damping = normal - elastic;
        friction = g.friction * normal * larger<W>(smaller<W>(g.per_full_speed * speed, one), -one);
        const V lip = (3.0 * part * g.stiffness * g.per_ramp) * inward * way * (1.0 - way) * depth * depth;
        const V forward = -(lip + friction), outward = -side * normal;
        fx = g.cosine * forward - g.sine * outward;
        fy = strand * (g.sine * forward + g.cosine * outward);
    }
};

/// Adds the guides' forces to those of links side by side: half a pin at each end. A separate function, so that the code of machines
/// without guides is unchanged. q [coordinates of the link], v [m/s, rad/s], f [N, N·m]
template <int W, class Books>
[[gnu::noinline]] inline void guide_force(const GuideCoefficients& g, const Lanes<W>* q, const Lanes<W>* v, Lanes<W>* f,
                                          Books& books) noexcept {
    for (const End end : {End::rear, End::front}) {
        const int x = link_layout.x(end, 0), y = link_layout.y(end, 0);
        const GuideContact<W> contact(g, 0.5, q[x], q[y], v[x], v[y]);
        books.store(Energy::supports, contact.energy);
        books.lose(Loss::guide, contact.damping * contact.approach + contact.friction * contact.speed);
        f[x] += contact.fx;
        f[y] += contact.fy;
    }
}

}  // namespace
}  // namespace cvtflow::model
