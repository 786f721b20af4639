#include "model/observe/creep.hpp"

#include "model/basis/order.hpp"
#include "model/kernels/chain_parts.hpp"
#include "model/variator/rigid/rigid_chain.hpp"

namespace cvtflow::model {

namespace {

/// Adds the tips of a link to the sums of their pulley.
template <int P>
void add_link(const ChainModel& chain, const double* q, const SheaveMotion* sheaves, const Phase* phases, Creep& sums) noexcept {
    const Coefficients& c = chain.coefficients();
    const double* v = q + at<P>.link_size();
    const auto shaft = static_cast<std::size_t>(chain.shaft_of(q));
    const FourTips four;
    const LinkFrame frame = link_frame<P>(q, v);
    const auto sheave = sheaves_at(four, sheaves + 2 * shaft);
    const auto geometry = tip_geometry<P>(c, four, frame, q, sheave);
    const auto motion = tip_motion<P>(c, four, frame, v, sheave, geometry);
    const PhaseLanes of_tips = phases_of_link(phases);
    const TipLanes normal = tip_forces<false, tips_per_link>(c.tip, geometry, motion, touching_lanes(phases), of_tips, nullptr).normal;
    const auto slip = tangential(motion.material, geometry.normal);
    const TipLanes hold = grip<tips_per_link>(c.tip, normal, sqrt(positive_part<tips_per_link>(geometry.depth)), dot(slip, slip), of_tips);
    const auto& r = motion.sheave_arm;
    const TipLanes square = r.x * r.x + r.y * r.y, around = r.x * slip.y - r.y * slip.x;
    sums.hold[shaft] += sum<tips_per_link>(hold * square);
    sums.drag[shaft] += sum<tips_per_link>(hold * around);
    sums.power += sum<tips_per_link>(hold * around * around / square);
}

template <int P>
void add_chain(const ChainModel& chain, const double* state, const SheaveMotion* sheaves, const Phase* phases, Creep& sums) noexcept {
    const ChainLayout& layout = chain.layout();
    for (int link = 0; link < layout.links; ++link) {
        const Phase* own = phases + tips_per_link * link;
        if (any_touching(own)) add_link<P>(chain, state + layout.link_begin(link), sheaves, own, sums);
    }
}

}  // namespace

Creep observe_creep(const ChainModel& chain, const double* state, const SheaveMotion* sheaves, const Phase* phases) noexcept {
    Creep sums;
    const ChainLayout& layout = chain.layout();
    if (layout.pulley_size == 0) return sums;
    if (chain.rigid() != nullptr) {
        const RigidReaction& found = chain.rigid()->forces().reaction;
        return {found.hold, found.drag, found.creep_power};
    }
    of_order(layout.order, [&]<int P>() { add_chain<P>(chain, state, sheaves, phases, sums); });
    return sums;
}

}  // namespace cvtflow::model
