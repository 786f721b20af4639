#pragma once
/// Guides of the strands at rigid pins. (model/EQUATIONS.md section 8; pin halves: model/force/guide.hpp)

#include "model/force/guide.hpp"
#include "model/rigid/rigid_kernels.hpp"
#include "model/rigid/rigid_vectors.hpp"

namespace cvtflow::model {
namespace {

/// Adds the guides' forces to those on the middles of the pins.
inline void guide_pins(const RigidCoefficients& c, const RigidKick& kick, RigidColumns& columns, Account& account) noexcept {
    PinSum stored(columns), lost(columns);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const Plane at = read(columns.position.middle, i), rate = read(columns.velocity.middle, i);
        const GuideContact<rigid_lanes> contact(c.guide, 1.0, at.x, at.y, rate.x, rate.y);
        write(columns.force.middle, i, read(columns.force.middle, i) + Plane{contact.fx, contact.fy});
        stored.add(i, contact.energy);
        lost.add(i, drag_power(kick, columns.damping.guide, i, contact.damping, contact.approach) +
                        drag_power(kick, columns.damping.guide_friction, i, contact.friction, contact.speed));
    }
    account.store(Energy::supports, stored.value());
    account.lose(Loss::guide, lost.value());
}

}  // namespace
}  // namespace cvtflow::model
