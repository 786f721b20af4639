#include "model/observe/rigid_forces.hpp"

#include <algorithm>
#include <cmath>

namespace cvtflow::model {

namespace {

[[nodiscard]] std::size_t at_entry(int number) noexcept { return static_cast<std::size_t>(number); }

struct PlaneVector {
    double x, y;
};

[[nodiscard]] PlaneVector plane(const RigidColumns& columns, Column first, int entry) noexcept {
    return {columns[first][entry], columns[first + 1][entry]};
}

void show_tips(const RigidChain& chain, int link, ChainForces& forces) {
    for (int tip = 0; tip < tips_per_link; ++tip) {
        const std::size_t n = at_entry(tips_per_link * link + tip);
        forces.tip_normal[n] = chain.of_tip(Column::normal, link, tip);
        forces.tip_tangential[n] = -chain.of_tip(Column::round, link, tip);
        forces.tip_radial[n] = chain.of_tip(Column::outward, link, tip);
        const double round = chain.of_tip(Column::round, link, tip), flank = chain.of_tip(Column::flank, link, tip);
        forces.tip_sliding[n] = chain.of_tip(Column::sliding, link, tip);
        forces.tip_power[n] = std::sqrt(round * round + flank * flank) * forces.tip_sliding[n];
        forces.tip_radius[n] = chain.of_tip(Column::reach, link, tip);
    }
    for (int end = 0; end < 2; ++end) {  // both tips press on a half, whose middle carries the mean
        const double minus = chain.of_tip(Column::axial, link, 2 * end), plus = chain.of_tip(Column::axial, link, 2 * end + 1);
        forces.half_axial[at_entry(2 * link + end)] = -0.5 * (std::abs(minus) + std::abs(plus));
    }
}

/// The pack's tension and yaw moment, shared by its two lumped plates.
void show_plates(const RigidChain& chain, int link, ChainForces& forces) {
    const RigidColumns& columns = chain.columns();
    const PlaneVector twist = plane(columns, Column::twist_x, link), t = plane(columns, Column::line_x, link);
    const double tension = columns[Column::tension][link], yaw = -(twist.x * t.x + twist.y * t.y);
    const double lever = std::sqrt(chain.model().coefficients().plate_square), difference = lever > 0.0 ? yaw / lever : 0.0;
    forces.plate_tension[at_entry(2 * link)] = 0.5 * (tension - difference);
    forces.plate_tension[at_entry(2 * link + 1)] = 0.5 * (tension + difference);
}

/// What the links press the halves of a pin together by, across and along the bisector of their pitch lines.
void show_joint(const RigidChain& chain, int pin, ChainForces& forces) {
    const RigidColumns& columns = chain.columns();
    const PlaneVector before = plane(columns, Column::pull_x, pin - 1), after = plane(columns, Column::pull_x, pin);
    const PlaneVector bisector = plane(columns, Column::bisector_x, pin), half{0.5 * (before.x + after.x), 0.5 * (before.y + after.y)};
    forces.joint_normal[at_entry(pin)] = std::max(0.0, -(half.x * bisector.x + half.y * bisector.y));
    forces.joint_friction[at_entry(pin)] = -(bisector.x * half.y - bisector.y * half.x);
}

}  // namespace

void observe_rigid_forces(const RigidChain& chain, const double* state, const SheaveMotion* sheaves, ChainForces& forces) noexcept {
    const ChainLayout& at = chain.model().layout();
    chain.evaluate(state, sheaves);
    for (int link = 0; link < at.links; ++link) {
        if (at.pulley_size != 0) show_tips(chain, link, forces);
        show_plates(chain, link, forces);
        show_joint(chain, link, forces);
    }
}

}  // namespace cvtflow::model
