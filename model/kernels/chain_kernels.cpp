#include <algorithm>
#include <cmath>

#include "model/basis/isa.hpp"
#include "model/chain/chain_model.hpp"
#include "model/force/tips.hpp"
#include "model/kernels/chain_parts.hpp"
#include "model/kernels/lane_pass.hpp"
#include "model/kernels/link_lanes.hpp"
#include "model/kernels/native_kernels.hpp"

namespace cvtflow::model {
namespace {

/// Tips of links side by side against their sheaves, without forces: for detection after every step.
template <int P, int W>
class LaneProbe {
public:
    using V = Lanes<W>;
    using Columns = LinkColumns<P, W>;

    LaneProbe(const Coefficients& c, const SheaveMotion* sheaves, bool with_slip) noexcept
        : c_(c), sheaves_(sheaves), with_slip_(with_slip) {}

    /// @param states blocks of `links` neighbouring links [unknowns]
    void run(const double* states, int links, TipProbe* probes) const noexcept {
        for (int first = 0; first < links; first += W)
            group(states + first * link_layout<P>.link_block(), std::min(W, links - first), probes + first);
    }

private:
    static constexpr int numbers = sizeof(TipProbe) / sizeof(double);
    static constexpr int depth_row = 0, slip_row = tips_per_link, radius_row = 2 * tips_per_link;
    static_assert(numbers == radius_row + 1);

    /// states [unknowns]
    void group(const double* states, int count, TipProbe* probes) const noexcept {
        std::array<const double*, W> from;
        for (int lane = 0; lane < W; ++lane)
            from[static_cast<std::size_t>(lane)] = states + std::min(lane, count - 1) * link_layout<P>.link_block();
        Columns columns;
        load_rows<W, link_layout<P>.link_block()>(from, columns.state.data());
        columns.frame = link_frame<P>(columns.q(), columns.v());
        std::array<SheaveMotionLanes<W>, 2> sheaves;
        const V shaft = pulleys_of<P>(c_, sheaves_, columns, sheaves);
        std::array<V, numbers> rows;
        probe(OneTip<W, End::rear, 0>{}, 0, columns, sheaves.data(), rows.data());
        probe(OneTip<W, End::rear, 1>{}, 1, columns, sheaves.data(), rows.data());
        probe(OneTip<W, End::front, 0>{}, 2, columns, sheaves.data(), rows.data());
        probe(OneTip<W, End::front, 1>{}, 3, columns, sheaves.data(), rows.data());
        const V* q = columns.q();
        const V x = 0.5 * (q[link_layout<P>.x(End::rear, 0)] + q[link_layout<P>.x(End::front, 0)]) - shaft * c_.centre_distance;
        const V y = 0.5 * (q[link_layout<P>.y(End::rear, 0)] + q[link_layout<P>.y(End::front, 0)]);
        rows[radius_row] = sqrt(x * x + y * y);
        std::array<double*, W> to;
        for (int lane = 0; lane < count; ++lane) to[static_cast<std::size_t>(lane)] = reinterpret_cast<double*>(probes + lane);
        store_rows<W, numbers>(rows.data(), to, count);
    }

    template <class Corner>
    void probe(const Corner& corner, int number, const Columns& columns, const SheaveMotionLanes<W>* sheaves, V* rows) const noexcept {
        const auto sheave = sheaves_at(corner, sheaves);
        const auto geometry = tip_geometry<P>(c_, corner, columns.frame, columns.q(), sheave);
        rows[depth_row + number] = geometry.depth;
        rows[slip_row + number] = V(0.0);
        if (!with_slip_) return;
        const auto slip = tangential(tip_motion<P>(c_, corner, columns.frame, columns.v(), sheave, geometry).material, geometry.normal);
        rows[slip_row + number] = sqrt(dot(slip, slip));
    }

    const Coefficients& c_;
    const SheaveMotion* sheaves_;
    bool with_slip_;
};

/// One pass over a range of links, keeping the frame and the joint of the link before.
template <int P, bool Observe>
class LinkPass {
public:
    LinkPass(const ChainModel& model, const ChainRange& range) noexcept
        : model_(model), c_(model.coefficients()), range_(range), frame_(frame_of(range.first - 1)) {}

    /// @param accounts, contacts of the range's first link on, where observed
    void run(double* slope, LinkLoad* loads, Account* accounts, LinkContact* contacts) noexcept {
        Account neighbour;  // the joint behind the last link is booked by the next range
        LinkFrame here = frame_of(range_.first);
        JointForce<P> joints[2];  // of the pins behind and before a link, taking turns
        joint_between(range_.first, frame_, here, joints[0], accounts);
        for (int link = range_.first; link < range_.last; ++link) {
            const int place = link - range_.first;
            const LinkFrame ahead = frame_of(link + 1);
            const JointForce<P>& rear = joints[place & 1];
            JointForce<P>& front = joints[(place & 1) ^ 1];
            joint_between(link + 1, here, ahead, front,
                          link + 1 < range_.last ? part_of(accounts, place + 1, AccountPart::joint) : &neighbour);
            link_slope(link, here, rear, front, slope + place * link_layout<P>.link_block(), loads[place],
                       part_of(accounts, place, AccountPart::joint), contacts != nullptr ? contacts + place : nullptr);
            here = ahead;
        }
    }

private:
    [[nodiscard]] const double* state(int link) const noexcept {
        return range_.window + (link - range_.first + 1) * link_layout<P>.link_block();
    }
    [[nodiscard]] LinkFrame frame_of(int link) const noexcept {
        return link_frame<P>(state(link), state(link) + link_layout<P>.link_size());
    }

    /// Joint of the pin between link - 1 and link.
    void joint_between(int link, const LinkFrame& before, const LinkFrame& after, JointForce<P>& out, Account* account) const noexcept {
        joint_part<P, Observe>(c_, before, after, state(link - 1), state(link), out, account);
    }

    [[nodiscard]] static Account* part_of(Account* accounts, int place, AccountPart part) noexcept {
        return Observe ? accounts + account_parts * place + static_cast<int>(part) : nullptr;
    }

    /// @param accounts, contact those of this link
    void link_slope(int link, const LinkFrame& frame, const JointForce<P>& rear, const JointForce<P>& front, double* slope, LinkLoad& load,
                    Account* accounts, LinkContact* contact) const noexcept {
        constexpr int size = link_layout<P>.link_size();
        double* f = slope + size;
        std::memcpy(slope, state(link) + size, size * sizeof(double));
        const double moment = link_part<P, Observe>(c_, link, frame, state(link), f, part_of(accounts, 0, AccountPart::link));
        const Phase* phases = range_.phases + tips_per_link * link;
        TipShare<P> share;
        const bool touching = any_touching(phases);
        if constexpr (Observe) {
            if (contact != nullptr) *contact = {.tension = elastic_tension<P>(c_, c_.kind(link), state(link))};
        }
        if (touching) {
            tip_part<P, Observe>(model_, frame, state(link), range_.sheaves, phases, share, load, part_of(accounts, 0, AccountPart::tips),
                                 contact);
        }
        assemble<P>(frame, moment, rear, front, touching ? &share : nullptr, f);
        accelerate<P>(model_.inertia(), f);
    }

    const ChainModel& model_;
    const Coefficients& c_;
    const ChainRange& range_;
    LinkFrame frame_;
};

template <int P, bool Observe>
void slopes_of(const ChainModel& model, const ChainRange& range, double* slope, LinkLoad* loads, Account* accounts,
               LinkContact* contacts) noexcept {
    LinkPass<P, Observe>(model, range).run(slope, loads, accounts, contacts);
}

template <int P>
void probe_link(const ChainModel& model, const double* state, const SheaveMotion* sheaves, bool with_slip, TipProbe& probe) noexcept {
    const Coefficients& c = model.coefficients();
    const double* v = state + link_layout<P>.link_size();
    const SheaveMotion* shaft_sheaves = sheaves + 2 * model.shaft_of(state);
    const LinkFrame frame = link_frame<P>(state, v);
    const FourTips four;
    const auto sheave = sheaves_at(four, shaft_sheaves);
    const auto geometry = tip_geometry<P>(c, four, frame, state, sheave);
    geometry.depth.copy_to(probe.depth);
    TipLanes(0.0).copy_to(probe.slip);
    if (with_slip) {
        const auto motion = tip_motion<P>(c, four, frame, v, sheave, geometry);
        const Vector3<TipLanes> slip = tangential(motion.material, geometry.normal);
        TipLanes(sqrt(dot(slip, slip))).copy_to(probe.slip);
    }
    const double x =
        0.5 * (state[link_layout<P>.x(End::rear, 0)] + state[link_layout<P>.x(End::front, 0)]) - model.shaft_of(state) * c.centre_distance;
    const double y = 0.5 * (state[link_layout<P>.y(End::rear, 0)] + state[link_layout<P>.y(End::front, 0)]);
    probe.radius = std::sqrt(x * x + y * y);
}

template <int P>
void probe_links(const ChainModel& model, const double* states, int links, const SheaveMotion* sheaves, bool with_slip,
                 TipProbe* probes) noexcept {
    LaneProbe<P, native_lanes>(model.coefficients(), sheaves, with_slip).run(states, links, probes);
}

/// Links side by side are faster with vectors of 4 and 8 lanes. With 2 lanes (and 16 registers) they are at high order slower than lanes
/// inside a link.
template <int P>
inline constexpr bool links_side_by_side = native_lanes != 2 || P < 2;

template <int P>
void slopes(const ChainModel& model, const ChainRange& range, double* slope, LinkLoad* loads, Account* accounts) noexcept {
    if constexpr (links_side_by_side<P>) {
        LanePass<P, native_lanes>(model, range, slope, loads).run();
    } else {
        slopes_of<P, false>(model, range, slope, loads, accounts, nullptr);
    }
}

}  // namespace

template <>
ChainKernels chain_kernels<compiled_isa>(int order) noexcept {
    return of_order(order, []<int P>() -> ChainKernels {
        if constexpr (slopes_alone)
            return {slopes<P>, nullptr, nullptr, nullptr};
        else
            return {slopes<P>, slopes_of<P, true>, probe_link<P>, probe_links<P>};
    });
}

}  // namespace cvtflow::model
