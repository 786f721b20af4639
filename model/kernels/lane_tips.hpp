#pragma once
/// Tips of links side by side, corner by corner. Links that touch nowhere come along with forces of zero. (model/kernels/link_lanes.hpp)

#include <algorithm>

#include "model/chain_model.hpp"
#include "model/force/tips.hpp"
#include "model/kernels/link_lanes.hpp"

namespace cvtflow::model {
namespace {

template <int P, int W>
class LaneTips {
public:
    using V = Lanes<W>;
    using Columns = LinkColumns<P, W>;
    static constexpr int size = at<P>.link_size();

    /// @param count links that the lanes stand for, from the first
    LaneTips(const ChainModel& model, const ChainRange& range, int first, int count) noexcept
        : model_(model), c_(model.coefficients()), range_(range), phases_(range.phases + tips_per_link * first), count_(count) {
        for (int link = 0; link < count; ++link) any_ |= phase_word(phases_ + tips_per_link * link);
    }

    /// Adds forces and moments on the links; reactions of those that touch to loads.
    void add(const Columns& columns, V* f, V& moment, LinkLoad* loads) const noexcept {
        if (any_ == 0) return;
        std::array<SheaveMotionLanes<W>, 2> sheaves;
        const V shaft = pulleys_of(columns, sheaves);
        std::array<V, size> share;
        share.fill(V(0.0));
        std::array<TipReaction<V>, 2> reaction;   // rear + front, by side
        std::array<V, 2> turning;
        for (const End end : {End::rear, End::front}) {
            std::array<TipPush<V>, 2> push;
            for (int side = 0; side < 2; ++side) {
                const auto k = static_cast<std::size_t>(side);
                TipReaction<V> own;
                push[k] = tip({end, side}, columns, sheaves.data(), own);
                turning[k] = end == End::rear ? push[k].moment : turning[k] + push[k].moment;
                reaction[k] = end == End::rear ? own : sum_of(reaction[k], own);
            }
            load_end<P>(end, push[0], push[1], share.data());
        }
        for (int k = 0; k < size; ++k) f[k] += share[static_cast<std::size_t>(k)];
        moment += turning[0] + turning[1];
        write(reaction, shaft, loads);
    }

private:
    /// The two sheaves of every link's pulley; returns the shafts' numbers.
    [[nodiscard]] V pulleys_of(const Columns& columns, std::array<SheaveMotionLanes<W>, 2>& sheaves) const noexcept {
        const V middle = columns.state[static_cast<std::size_t>(at<P>.x(End::rear, 0))] + columns.state[static_cast<std::size_t>(at<P>.x(End::front, 0))];
        const auto by_shaft = [&](double first, double second) { return select_greater<W>(V(c_.centre_distance), middle, V(first), V(second)); };
        constexpr std::size_t numbers = sizeof(SheaveMotion) / sizeof(double);
        for (std::size_t side = 0; side < 2; ++side) {
            std::array<double, numbers> first, second;
            std::memcpy(first.data(), &range_.sheaves[side], sizeof first);
            std::memcpy(second.data(), &range_.sheaves[2 + side], sizeof second);
            std::array<V, numbers> rows;
            static_assert(sizeof rows == sizeof sheaves[side]);
            for (std::size_t k = 0; k < numbers; ++k) rows[k] = by_shaft(first[k], second[k]);
            std::memcpy(static_cast<void*>(&sheaves[side]), rows.data(), sizeof rows);
        }
        return by_shaft(0.0, 1.0);
    }

    [[nodiscard]] TipPush<V> tip(const OneTip<W>& corner, const Columns& columns, const SheaveMotionLanes<W>* sheaves, TipReaction<V>& reaction) const noexcept {
        const auto own = sheaves_at(corner, sheaves);
        const auto geometry = tip_geometry<P>(c_, corner, columns.frame, columns.q(), own);
        const auto motion = tip_motion<P>(c_, corner, columns.frame, columns.v(), own, geometry);
        constexpr std::uint32_t stick_or_slip = 0x02020202;
        const Phase* first = phases_ + 2 * static_cast<int>(corner.end) + corner.side;
        const auto forces = tip_forces<false, W>(c_.tip, geometry, motion, touching(first), {first, tips_per_link, (any_ & stick_or_slip) != 0, static_cast<std::size_t>(count_)}, nullptr);
        reaction = tip_reaction(geometry, motion, forces);
        return tip_push(c_, columns.frame, geometry, motion, forces);
    }

    /// 1 where a tip touches, else 0.
    [[nodiscard]] V touching(const Phase* first) const noexcept {
        alignas(64) double touching[W];
        for (int link = 0; link < W; ++link) touching[link] = link < count_ && first[tips_per_link * link] != Phase::free ? 1.0 : 0.0;
        return load<W>(touching);
    }

    [[nodiscard]] static TipReaction<V> sum_of(const TipReaction<V>& a, const TipReaction<V>& b) noexcept {
        return {{a.force.x + b.force.x, a.force.y + b.force.y, a.force.z + b.force.z}, {a.moment.x + b.moment.x, a.moment.y + b.moment.y, a.moment.z + b.moment.z}};
    }

    void write(const std::array<TipReaction<V>, 2>& reaction, const V& shaft, LinkLoad* loads) const noexcept {
        constexpr int numbers = sizeof(SheaveLoad) / sizeof(double);
        const auto& [a, b] = reaction;
        const std::array<V, numbers> rows{a.force.x, b.force.x, a.force.y, b.force.y, a.force.z, b.force.z,
                                          a.moment.x, b.moment.x, a.moment.y, b.moment.y, a.moment.z, b.moment.z};
        alignas(64) double load[W][numbers];
        std::array<double*, W> to;
        for (std::size_t link = 0; link < W; ++link) to[link] = load[link];
        store_rows<W, numbers>(rows.data(), to, count_);
        for (int link = 0; link < std::min(count_, W); ++link) {   // GCC 12 does not know that count ≤ W
            if (phase_word(phases_ + tips_per_link * link) == 0) continue;
            std::memcpy(&loads[link].load, load[link], sizeof load[link]);
            loads[link].shaft = static_cast<int>(shaft[static_cast<std::size_t>(link)]);
        }
    }

    const ChainModel& model_;
    const Coefficients& c_;
    const ChainRange& range_;
    const Phase* phases_;   ///< of the first lane's link
    int count_;
    std::uint32_t any_ = 0;
};

}  // namespace
}  // namespace cvtflow::model
