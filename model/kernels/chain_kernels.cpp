#include <algorithm>

#include "model/basis/native_lanes.hpp"
#include "model/chain/chain_model.hpp"
#include "model/force/tips.hpp"
#include "model/kernels/kernels.hpp"
#include "model/kernels/lane_pass.hpp"
#include "model/kernels/link_lanes.hpp"
#include "model/kernels/observation_writer.hpp"

namespace cvtflow::model {
namespace {

/// Tips of links side by side against their sheaves, without forces: for detection after every step.
template <int W>
class LaneProbe {
public:
    using V = Lanes<W>;
    using Columns = LinkColumns<W>;

    LaneProbe(const Coefficients& c, const SheaveMotion* sheaves, bool with_slip) noexcept
        : c_(c), sheaves_(sheaves), with_slip_(with_slip) {}

    /// @param states blocks of `links` neighbouring links [unknowns]
    void run(const double* states, int links, TipProbe* probes) const noexcept {
        for (int first = 0; first < links; first += W)
            group(states + first * link_layout.link_block(), std::min(W, links - first), probes + first);
    }

private:
    static constexpr int numbers = sizeof(TipProbe) / sizeof(double);
    static constexpr int depth_row = 0, slip_row = tips_per_link, radius_row = 2 * tips_per_link;
    static_assert(numbers == radius_row + 1);

    /// states [unknowns]
    void group(const double* states, int count, TipProbe* probes) const noexcept {
        std::array<const double*, W> from;
        for (int lane = 0; lane < W; ++lane)
            from[static_cast<std::size_t>(lane)] = states + std::min(lane, count - 1) * link_layout.link_block();
        Columns columns;
        load_rows<W, link_layout.link_block()>(from, columns.state.data());
        columns.frame = link_frame(columns.q(), columns.v());
        std::array<SheaveMotionLanes<W>, 2> sheaves;
        const V shaft = pulleys_of(c_, sheaves_, columns, sheaves);
        std::array<V, numbers> rows;
        probe(OneTip<W, End::rear, 0>{}, 0, columns, sheaves.data(), rows.data());
        probe(OneTip<W, End::rear, 1>{}, 1, columns, sheaves.data(), rows.data());
        probe(OneTip<W, End::front, 0>{}, 2, columns, sheaves.data(), rows.data());
        probe(OneTip<W, End::front, 1>{}, 3, columns, sheaves.data(), rows.data());
        const V* q = columns.q();
        const V x = 0.5 * (q[link_layout.x(End::rear, 0)] + q[link_layout.x(End::front, 0)]) - shaft * c_.centre_distance;
        const V y = 0.5 * (q[link_layout.y(End::rear, 0)] + q[link_layout.y(End::front, 0)]);
        rows[radius_row] = sqrt(x * x + y * y);
        std::array<double*, W> to;
        for (int lane = 0; lane < count; ++lane) to[static_cast<std::size_t>(lane)] = reinterpret_cast<double*>(probes + lane);
        store_rows<W, numbers>(rows.data(), to, count);
    }

    template <class Corner>
    void probe(const Corner& corner, int number, const Columns& columns, const SheaveMotionLanes<W>* sheaves, V* rows) const noexcept {
        const auto sheave = sheaves_at(corner, sheaves);
        const auto geometry = tip_geometry(c_, corner, columns.frame, columns.q(), sheave);
        rows[depth_row + number] = geometry.depth;
        rows[slip_row + number] = V(0.0);
        if (!with_slip_) return;
        const auto slip = tangential(tip_motion(c_, corner, columns.frame, columns.v(), sheave, geometry).material, geometry.normal);
        rows[slip_row + number] = sqrt(dot(slip, slip));
    }

    const Coefficients& c_;
    const SheaveMotion* sheaves_;
    bool with_slip_;
};

void probe_links(const ChainModel& model, const double* states, int links, const SheaveMotion* sheaves, bool with_slip,
                 TipProbe* probes) noexcept {
    LaneProbe<native_lanes>(model.coefficients(), sheaves, with_slip).run(states, links, probes);
}

void slopes(const ChainModel& model, const ChainRange& range, double* slope, LinkLoad* loads) noexcept {
    LanePass<native_lanes>(model, range, slope, loads).run();
}

void observed_slopes(const ChainModel& model, const ChainRange& range, double* slope, LinkLoad* loads, Account* accounts,
                     LinkContact* contacts) noexcept {
    using Writer = ObservationWriter<native_lanes>;
    LanePass<native_lanes, Writer>(model, range, slope, loads, Writer(model.coefficients(), accounts, contacts)).run();
}

}  // namespace

template <>
ChainKernels chain_kernels<compiled_isa>() noexcept {
    if constexpr (slopes_alone)
        return {slopes, nullptr, nullptr};
    else
        return {slopes, observed_slopes, probe_links};
}

}  // namespace cvtflow::model
