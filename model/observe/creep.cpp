#include "model/observe/creep.hpp"

#include "model/basis/order.hpp"
#include "model/kernels/chain_parts.hpp"
#include "model/kernels/pins/pin_among_others.hpp"
#include "model/variator/rigid/rigid_chain.hpp"

namespace cvtflow::model {

namespace {

/// Adds the tips in the lanes to the sums of their pulley.
template <int W, int P>
void add_tips(const TipCoefficients& tip, const TipGeometry<P, Lanes<W>>& geometry, const TipMotion<Lanes<W>>& motion,
              const Lanes<W>& touching, const PhaseLanes& phases, std::size_t shaft, Creep& sums) noexcept {
    const Lanes<W> normal = tip_forces<false, W>(tip, geometry, motion, touching, phases, nullptr).normal;
    const auto v = tangential(motion.material, geometry.normal);
    const Lanes<W> hold = grip<W>(tip, normal, sqrt(positive_part<W>(geometry.depth)), dot(v, v), phases);
    const auto& r = motion.sheave_arm;
    const Lanes<W> square = r.x * r.x + r.y * r.y, around = r.x * v.y - r.y * v.x;
    sums.hold[shaft] += sum<W>(hold * square);
    sums.drag[shaft] += sum<W>(hold * around);
    sums.power += sum<W>(hold * around * around / square);
}

template <int P>
void add_link(const ChainModel& chain, const double* q, const SheaveMotion* sheaves, const Phase* phases, Creep& sums) noexcept {
    const Coefficients& c = chain.coefficients();
    const double* v = q + at<P>.link_size();
    const int shaft = chain.shaft_of(q);
    const FourTips four;
    const LinkFrame frame = link_frame<P>(q, v);
    const auto sheave = sheaves_at(four, sheaves + 2 * shaft);
    const auto geometry = tip_geometry<P>(c, four, frame, q, sheave);
    const auto motion = tip_motion<P>(c, four, frame, v, sheave, geometry);
    add_tips<tips_per_link>(c.tip, geometry, motion, touching_lanes(phases), phases_of_link(phases), static_cast<std::size_t>(shaft), sums);
}

template <int P>
void add_pin(const ChainModel& chain, const double* state, int pin, const SheaveMotion* sheaves, const Phase* phases,
             Creep& sums) noexcept {
    const Coefficients& c = chain.coefficients();
    NeighbourWindow strip;
    const PinAmongOthers<P> among(chain, strip.of(c.layout, state, pin), sheaves);
    among.tips([&](int side, const auto& geometry, const auto& motion) {
        const PhaseLanes own{phases + side, 1, phases[side] != Phase::touching, 1};
        const Lanes<1> touching(phases[side] == Phase::free ? 0.0 : 1.0);
        add_tips<1>(c.tip, geometry, motion, touching, own, static_cast<std::size_t>(among.shaft()), sums);
    });
}

template <int P>
void add_chain(const ChainModel& chain, const double* state, const SheaveMotion* sheaves, const Phase* phases, Creep& sums) noexcept {
    const ChainLayout& layout = chain.layout();
    for (int link = 0; link < layout.links; ++link) {
        const Phase* own = phases + tips_per_link * link;
        if (!any_touching(own)) continue;
        if (layout.whole)
            add_pin<P>(chain, state, link, sheaves, own, sums);
        else
            add_link<P>(chain, state + layout.link_begin(link), sheaves, own, sums);
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
