#pragma once
/// The elements of model/force at one point - a plate, a point of a joint, a tip - over numbers with derivatives. Their arguments are the
/// same for every order of the axis, so they are compiled once.

#include "bench/method/jacobian/dual_lanes.hpp"
#include "bench/method/product_names.hpp"
#include "model/force/joint.hpp"
#include "model/force/plates.hpp"
#include "model/force/tips.hpp"

namespace cvtflow::bench {
namespace {

/// A plate sees a difference of order 0: x, y, z and their rates.
inline constexpr int six = directions<6>;
/// So does a point of a joint, with the direction and turning of both links: x, y, three rates, three of each link.
inline constexpr int eleven = directions<11>;
/// A tip sees the axis as a straight line, of order 1: five of the half, the link's direction, five rates, the turning, the sheave's
/// motion.
inline constexpr int two_dozen = directions<24>;

/// Force of one plate on the front half: x, y, z and its moment along the axis.
[[nodiscard, gnu::noinline]] inline std::array<Lanes<six>, 4> plate_at(const Coefficients& c, const LinkKind& kind, int plate,
                                                                       const Difference<0, Lanes<six>>& d,
                                                                       const Difference<0, Lanes<six>>& rate) noexcept {
    const auto j = static_cast<std::size_t>(plate);
    const AxisPoint<0, six> place(c.plates, plate);
    const auto stretch = plate_stretch<0, six>(c, Lanes<six>(kind.free_length), place, c.plates.weight[j], c.plates.damping[j], d, rate);
    return plate_terms<0, six, NoBooks>(place, c.plates.weight[j], c.plates.damping[j], stretch, plate_slide(c, stretch));
}

using PointOfJoint = JointTerms<0, eleven>;

/// One point of a joint, in the order of JointForce.
[[nodiscard, gnu::noinline]] inline PointOfJoint joint_at(const Coefficients& c, const JointFrames<Lanes<eleven>>& frames, int point,
                                                          const Difference<0, Lanes<eleven>>& gap,
                                                          const Difference<0, Lanes<eleven>>& rate) noexcept {
    const AxisPoint<0, eleven> place(c.joint_points, point);
    const Lanes<eleven> weight(c.joint_points.weight[static_cast<std::size_t>(point)]);
    const auto motion = joint_motion<0, eleven>(c.joint, frames, place, gap, rate);
    NoBooks none;
    PointOfJoint terms = rolling_contact_force<0, eleven>(c.joint, frames, place, weight, motion, none);
    if (all_at_most<eleven>(beyond_clearance<eleven>(c.joint, frames, motion), 0.0)) return terms;
    const PointOfJoint held = clearance_force<0, eleven>(c.joint, frames, place, weight, motion, none);
    for (std::size_t k = 0; k < terms.size(); ++k) terms[k] += held[k];
    return terms;
}

/// Effect of a tip on its link and on its sheave.
struct TipEffect {
    TipAction<Lanes<two_dozen>> action{};
    TipReaction<Lanes<two_dozen>> reaction{};
};

/// A tip on one side, or nothing where it has a gap. q, v: of a link of order 1, whose rear half is the tip's
template <int side>
[[nodiscard, gnu::noinline]] inline TipEffect tip_at(const Coefficients& c, const LinkFrameOf<Lanes<two_dozen>>& frame,
                                                     const Lanes<two_dozen>* q, const Lanes<two_dozen>* v,
                                                     const SheaveLanes<Lanes<two_dozen>>& sheave, Phase phase) noexcept {
    const OneTip<two_dozen, End::rear, side> tip;
    const auto geometry = tip_geometry<1>(c, tip, frame, q, sheave);
    if (!(geometry.depth.value > 0.0)) return {};
    const auto motion = tip_motion<1>(c, tip, frame, v, sheave, geometry);
    const PhaseLanes phases{&phase, 0, phase == Phase::stick || phase == Phase::slip, 1};
    NoBooks none;
    const auto forces = tip_forces<two_dozen>(c.tip, geometry, motion, Lanes<two_dozen>(1.0), phases, none);
    return {tip_action(c, frame, geometry, motion, forces), tip_reaction(geometry, motion, forces)};
}

}  // namespace
}  // namespace cvtflow::bench
