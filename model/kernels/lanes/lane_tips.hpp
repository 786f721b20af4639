#pragma once
/// Tips of links side by side, corner by corner. Links that touch nowhere come along with forces of zero.
/// (model/kernels/lanes/link_lanes.hpp)

#include <algorithm>

#include "model/force/tip/tips.hpp"
#include "model/kernels/lanes/contact_writer.hpp"
#include "model/kernels/lanes/link_lanes.hpp"
#include "model/variator/chain_model.hpp"

namespace cvtflow::model {
namespace {

/// @tparam Rigid whether sheaves only turn and move along z; then only those reactions are written
template <int P, int W, bool Rigid, class Contacts = NoContacts>
class LaneTips {
public:
    using V = Lanes<W>;
    using Columns = LinkColumns<P, W>;
    using Reaction = TipReaction<V>;
    static constexpr int size = at<P>.link_size();

    /// @param count links that the lanes represent, from the first
    LaneTips(const Coefficients& c, const ChainRange& range, int first, int count, const Contacts& contacts) noexcept
        : c_(c),
          range_(range),
          phases_(range.phases + tips_per_link * first),
          own_(first - range.first),
          count_(std::min(count, W)),
          contacts_(contacts) {
        for (int link = 0; link < count_; ++link)
            any_ |= words_[static_cast<std::size_t>(link)] = phase_word(phases_ + tips_per_link * link);
    }

    /// Adds forces and moments on the links; reactions of those that touch to loads.
    void add(const Columns& columns, V* f, V& moment, LinkLoad* loads) const noexcept {
        if (any_ == 0) {
            if constexpr (Contacts::wanted) contacts_.no_tips(own_, count_);
            return;
        }
        std::array<SheaveMotionLanes<W>, 2> sheaves;
        const V shaft = pulleys_of<P>(c_, range_.sheaves, columns, sheaves);
        std::array<V, size> share;
        share.fill(V(0.0));
        std::array<Reaction, 2> rear, front;  // by side
        std::array<V, 2> turning = pair<End::rear>(columns, sheaves, shaft, rear, share);
        const std::array<V, 2> more = pair<End::front>(columns, sheaves, shaft, front, share);
        for (std::size_t side = 0; side < 2; ++side) turning[side] += more[side];
        for (int k = 0; k < size; ++k) f[k] += share[static_cast<std::size_t>(k)];
        moment += turning[0] + turning[1];
        write(rear, front, shaft, loads);
    }

private:
    /// Both tips of a half: adds their forces to share, returns their moments.
    template <End end>
    [[nodiscard]] std::array<V, 2> pair(const Columns& columns, const std::array<SheaveMotionLanes<W>, 2>& sheaves, const V& shaft,
                                        std::array<Reaction, 2>& reaction, std::array<V, size>& share) const noexcept {
        const TipAction<V> minus = tip(OneTip<W, end, 0>{}, 2 * static_cast<int>(end), columns, sheaves.data(), shaft, reaction[0]);
        const TipAction<V> plus = tip(OneTip<W, end, 1>{}, 2 * static_cast<int>(end) + 1, columns, sheaves.data(), shaft, reaction[1]);
        load_end<P>(end, minus, plus, share.data());
        return {minus.moment, plus.moment};
    }

    template <class Corner>
    [[nodiscard]] TipAction<V> tip(const Corner& corner, int number, const Columns& columns, const SheaveMotionLanes<W>* sheaves,
                                   [[maybe_unused]] const V& shaft, Reaction& reaction) const noexcept {
        const auto own = [&] {
            if constexpr (Rigid)
                return rigid_sheaves_at(corner, sheaves);
            else
                return sheaves_at(corner, sheaves);
        }();
        const auto geometry = tip_geometry<P>(c_, corner, columns.frame, columns.q(), own);
        const auto motion = tip_motion<P>(c_, corner, columns.frame, columns.v(), own, geometry);
        const auto forces = forces_of(number, geometry, motion);
        if constexpr (Contacts::wanted) contacts_.tip(own_, count_, number, geometry, motion, forces.normal, sheaves[number % 2], shaft);
        reaction = tip_reaction(geometry, motion, forces);
        return tip_action(c_, columns.frame, geometry, motion, forces);
    }

    /// Without friction where contacts are recorded: it is solved for apart from all else.
    template <class Geometry>
    [[nodiscard, gnu::always_inline]] auto forces_of(int number, const Geometry& geometry, const TipMotion<V>& motion) const noexcept {
        if constexpr (Contacts::wanted) {
            return TipForces<V, Zero>{tip_pressing<W>(c_.tip, geometry, motion, touching(number)).normal, {}};
        } else {
            constexpr std::uint32_t stick_or_slip = 0x02020202;
            const PhaseLanes phases{phases_ + number, tips_per_link, (any_ & stick_or_slip) != 0, static_cast<std::size_t>(count_)};
            return tip_forces<false, W>(c_.tip, geometry, motion, touching(number), phases, nullptr);
        }
    }

    /// 1 where a tip touches, else 0.
    [[nodiscard]] V touching(int number) const noexcept {
        alignas(64) double touching[W];
        for (std::size_t link = 0; link < W; ++link) touching[link] = (words_[link] >> (8 * number) & 0xffu) != 0 ? 1.0 : 0.0;
        return load<W>(touching);
    }

    void write(const std::array<Reaction, 2>& rear, const std::array<Reaction, 2>& front, const V& shaft, LinkLoad* loads) const noexcept {
        constexpr std::size_t numbers = sizeof(SheaveLoad) / sizeof(double);
        const auto sums = [&](auto part, auto axis) {
            return std::array{rear[0].*part.*axis + front[0].*part.*axis, rear[1].*part.*axis + front[1].*part.*axis};
        };
        using Axis = Vector3<V>;
        constexpr auto force = &Reaction::force, moment = &Reaction::moment;
        if constexpr (Rigid) {
            const auto fz = sums(force, &Axis::z), mz = sums(moment, &Axis::z);
            std::array<V, 4> rows{fz[0], fz[1], mz[0], mz[1]};
            scatter(rows, shaft, loads, [](const double* row, SheaveLoad& load) {
                std::memcpy(load.fz, row, sizeof load.fz);
                std::memcpy(load.mz, row + 2, sizeof load.mz);
            });
        } else {
            std::array<V, numbers> rows;
            std::size_t row = 0;
            for (const auto part : {force, moment}) {
                for (const auto axis : {&Axis::x, &Axis::y, &Axis::z}) {
                    const auto both = sums(part, axis);
                    rows[row++] = both[0];
                    rows[row++] = both[1];
                }
            }
            scatter(rows, shaft, loads,
                    [](const double* numbers_of_link, SheaveLoad& load) { std::memcpy(&load, numbers_of_link, sizeof load); });
        }
    }

    /// Gives every touching link its column of rows.
    template <std::size_t numbers, class Take>
    void scatter(const std::array<V, numbers>& rows, const V& shaft, LinkLoad* loads, const Take& take) const noexcept {
        alignas(64) double column[W][numbers];
        std::array<double*, W> to;
        for (std::size_t link = 0; link < W; ++link) to[link] = column[link];
        store_rows<W, static_cast<int>(numbers)>(rows.data(), to, count_);
        for (std::size_t link = 0; link < W; ++link) {
            if (words_[link] == 0) continue;
            take(column[link], loads[link].load);
            loads[link].shaft = static_cast<int>(shaft[link]);
        }
    }

    const Coefficients& c_;
    const ChainRange& range_;
    const Phase* phases_;  ///< of the first lane's link
    int own_;              ///< first lane's link, from the range's first
    int count_;
    std::array<std::uint32_t, W> words_{};  ///< phases of each link, 0 beyond the last
    std::uint32_t any_ = 0;
    const Contacts& contacts_;
};

}  // namespace
}  // namespace cvtflow::model
