#pragma once
/// Guides of the strands at rigid pins. (model/EQUATIONS.md section 8; pin halves: model/force/guide.hpp)

#include "model/force/guide.hpp"
#include "model/rigid/rigid_kernels.hpp"
#include "model/rigid/rigid_links.hpp"

namespace cvtflow::model {
namespace {

/// Adds the guides' forces to those on the middles of the pins.
inline void guide_pins(const RigidCoefficients& c, const RigidKick& kick, PinColumns& columns, Account& account) noexcept {
    PinSum stored(columns), lost(columns);
    for (int i = 0; i < columns.padded(); i += rigid_lanes) {
        const Plane at = read(columns.position.middle, i), rate = read(columns.velocity.middle, i);
        const GuideContact<pin_width> contact(c.guide, 1.0, at.x, at.y, rate.x, rate.y);
        write(columns.force.middle, i, read(columns.force.middle, i) + Plane{contact.fx, contact.fy});
        stored.add(i, contact.energy);
        lost.add(i, drag_power(kick, columns.damping.guide, i, contact.damping, contact.approach) +
                        drag_power(kick, columns.damping.guide_friction, i, contact.friction, contact.speed));
    }
    account.store(Energy::supports, stored.value());
    account.lose(Loss::guide, lost.value());
}

/// RigidKernels::links.
inline void step_links(const RigidCoefficients& c, const RigidKick& kick, PinColumns& columns, Account& account) noexcept {
    account = {};
    drift_pins(kick.step, columns);
    pitch_lines(columns);
    rolling_frames(c, columns);
    link_forces(c, kick, columns, account);
    joint_forces(c, kick, columns, account);
    sum_link_forces(columns);
    if (kick.implicit()) filter_waves(c, kick, columns, account);
    if (c.guide.present) guide_pins(c, kick, columns, account);
}

}  // namespace
}  // namespace cvtflow::model
