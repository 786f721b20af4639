#pragma once
/// Tips of links side by side, corner by corner: links that touch nowhere come along with forces of zero. (model/kernels/link_lanes.hpp)

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "model/chain/chain_model.hpp"
#include "model/force/tips.hpp"
#include "model/kernels/link_lanes.hpp"
#include "model/kernels/link_sinks.hpp"

namespace cvtflow::model {
namespace {

/// @tparam Rigid whether sheaves only turn and move along z; then only those reactions are written
template <int W, bool Rigid, class Contacts>
class LaneTips {
public:
    using V = Lanes<W>;
    using Columns = LinkColumns<W>;
    using Reaction = TipReaction<V>;
    static constexpr int size = link_layout.link_size();

    /// @param count links that the lanes represent, from the first
    LaneTips(const Coefficients& c, const ChainRange& range, int first, int count, const Contacts& contacts) noexcept
        : c_(c),
          range_(range),
          phases_(range.phases + tips_per_link * first),
          group_(first - range.first),
          count_(std::min(count, W)),
          contacts_(contacts) {
        for (int link = 0; link < count_; ++link)
            any_ |= words_[static_cast<std::size_t>(link)] = phase_word(phases_ + tips_per_link * link);
    }

    /// Adds forces and moments on the links; reactions of those that touch to loads. @return whether any does
    bool add(const Columns& columns, V* f, V& moment, LinkLoad* loads) noexcept {
        const bool searches = contacts_.search() != nullptr;
        if (searches) find_near(columns);
        if (any_ == 0) {
            if (searches) keep_phases();
            contacts_.no_tips(group_, count_);
            return false;
        }
        note_touching();
        std::array<SheaveMotionLanes<W>, 2> sheaves;
        const V shaft = pulleys_of(c_, range_.sheaves, columns, sheaves);
        std::array<V, size> share;
        share.fill(V(0.0));
        std::array<Reaction, 2> rear, front;  // by side
        std::array<V, 2> turning = pair<End::rear>(columns, sheaves, shaft, rear, share);
        const std::array<V, 2> more = pair<End::front>(columns, sheaves, shaft, front, share);
        for (std::size_t side = 0; side < 2; ++side) turning[side] += more[side];
        for (int k = 0; k < size; ++k) f[k] += share[static_cast<std::size_t>(k)];
        moment += turning[0] + turning[1];
        if (searches) {
            std::copy_n(found_.begin(), count_, words_.begin());  // further lanes belong to others
            keep_phases();
            check_limits(columns, shaft);
        }
        contacts_.book_tips(group_, count_, books_);
        write(rear, front, shaft, loads);
        return true;
    }

private:
    /// Both tips of a half: adds their forces to share, returns their moments.
    template <End end>
    [[nodiscard]] std::array<V, 2> pair(const Columns& columns, const std::array<SheaveMotionLanes<W>, 2>& sheaves, const V& shaft,
                                        std::array<Reaction, 2>& reaction, std::array<V, size>& share) noexcept {
        const TipAction<V> minus = tip(OneTip<W, end, 0>{}, 2 * static_cast<int>(end), columns, sheaves.data(), shaft, reaction[0]);
        const TipAction<V> plus = tip(OneTip<W, end, 1>{}, 2 * static_cast<int>(end) + 1, columns, sheaves.data(), shaft, reaction[1]);
        load_end(end, minus, plus, share.data());
        return {minus.moment, plus.moment};
    }

    template <class Corner>
    [[nodiscard]] TipAction<V> tip(const Corner& corner, int number, const Columns& columns, const SheaveMotionLanes<W>* sheaves,
                                   const V& shaft, Reaction& reaction) noexcept {
        const auto sheave = [&] {
            if constexpr (Rigid)
                return rigid_sheaves_at(corner, sheaves);
            else
                return sheaves_at(corner, sheaves);
        }();
        const auto geometry = tip_geometry(c_, corner, columns.frame, columns.q(), sheave);
        const auto motion = tip_motion(c_, corner, columns.frame, columns.v(), sheave, geometry);
        const auto forces = forces_of(number, geometry, motion);
        contacts_.tip(TipLinks<W>{group_, count_, words_}, number, geometry, motion, forces, sheaves[number % 2], shaft);
        reaction = tip_reaction(geometry, motion, forces);
        return tip_action(c_, columns.frame, geometry, motion, forces);
    }

    /// Leaves out friction where contacts are recorded: it is solved for separately.
    template <class Geometry>
    [[nodiscard, gnu::always_inline]] auto forces_of(int number, const Geometry& geometry, const TipMotion<V>& motion) noexcept {
        if constexpr (Contacts::recorded) {
            const auto pressing = tip_pressing<W>(c_.tip, geometry, motion,
                                                  contacts_.search() == nullptr ? touching(number) : search(number, geometry.depth));
            deepest_ = larger<W>(pressing.depth, deepest_);
            return TipForces<V, Zero>{pressing.normal, {}};
        } else {
            constexpr std::uint32_t stick_or_slip = 0x02020202;
            const PhaseLanes phases{phases_ + number, tips_per_link, (any_ & stick_or_slip) != 0, static_cast<std::size_t>(count_)};
            return tip_forces<W>(c_.tip, geometry, motion, touching(number), phases, books_[static_cast<std::size_t>(number)]);
        }
    }

    /// Long before it is read: a vector waits for numbers that have just been stored one by one.
    void note_touching() noexcept {
        for (int number = 0; number < tips_per_link; ++number)
            for (std::size_t link = 0; link < W; ++link) touching_[number][link] = (words_[link] >> (8 * number) & 0xffu) != 0 ? 1.0 : 0.0;
    }
    /// 1 where a tip touches by its phase so far, else 0.
    [[nodiscard]] V touching(int number) const noexcept { return load<W>(touching_[number]); }

    // Where the record decides which tips touch.

    /// Above 0 where a link is so near its sheaves that its tips may touch; only there they do. A tip is as deep as a pin that is straight
    /// between flanks that are not tilted, up to the compliance of pins and sheaves.
    void find_near(const Columns& columns) noexcept {
        constexpr double yielding = 5e-4;  // m
        const V* q = columns.q();
        const V first(c_.centre_distance), middle = q[link_layout.x(End::rear, 0)] + q[link_layout.x(End::front, 0)];
        const auto by_shaft = [&](double one, double other) { return select_greater<W>(first, middle, V(one), V(other)); };
        const SheaveMotion* motions = range_.sheaves;
        const V minus = by_shaft(motions[0].z, motions[2].z), plus = by_shaft(motions[1].z, motions[3].z);
        const V centre = by_shaft(0.0, c_.centre_distance);
        const double touching_radius = c_.tip.touching_radius - c_.tip.radius * c_.tip.sine;
        near_ = V(-1.0);
        for (const End end : {End::rear, End::front}) {
            const V x = q[link_layout.x(end, 0)] - centre, y = q[link_layout.y(end, 0)], z = q[link_layout.z(end)];
            const V radial = c_.tip.sine * (touching_radius - sqrt(x * x + y * y)), length = c_.half_length + q[link_layout.e(end)];
            const V beyond = larger<W>(length - (z - minus), length + (z - plus));
            near_ = larger<W>(radial + c_.tip.cosine * beyond + yielding, near_);
        }
        found_.fill(0);
        any_ = all_at_most<W>(near_, 0.0) ? 0 : 1;
        if (any_ == 0) words_.fill(0);
    }

    /// 1 where a tip touches, by its depth and its phase so far, else 0; notes the new phases.
    [[nodiscard]] V search(int number, const V& depth) noexcept {
        alignas(64) double touches[W];
        const V bound = select_greater<W>(touching(number), V(0.0), V(-contacts_.search()->release), V(0.0));
        const V touching = select_greater<W>(near_, V(0.0), select_greater<W>(depth, bound, V(1.0), V(0.0)), V(0.0));
        touching.copy_to(touches);
        for (std::size_t link = 0; link < W; ++link) found_[link] |= static_cast<std::uint32_t>(touches[link] != 0.0) << (8 * number);
        return touching;
    }

    /// Writes changes only: other processors may have the line.
    void keep_phases() const noexcept {
        Phase* to = contacts_.search()->phases + tips_per_link * (range_.first + group_);
        for (int link = 0; link < count_; ++link, to += tips_per_link) {
            const std::uint32_t word = words_[static_cast<std::size_t>(link)];
            if (phase_word(to) != word) std::memcpy(to, &word, sizeof word);
        }
    }

    void check_limits(const Columns& columns, const V& shaft) const noexcept {
        TipSearch& search = *contacts_.search();
        const V* q = columns.q();
        const V x = 0.5 * (q[link_layout.x(End::rear, 0)] + q[link_layout.x(End::front, 0)]) - shaft * c_.centre_distance;
        const V y = 0.5 * (q[link_layout.y(End::rear, 0)] + q[link_layout.y(End::front, 0)]), square = x * x + y * y;
        const V touching = select_greater<W>(deepest_, V(0.0), square, V(0.0));
        if (!all_at_most<W>(deepest_, search.deepest) || !all_at_most<W>(-square, -search.innermost * search.innermost) ||
            !all_at_most<W>(touching, search.outermost * search.outermost))
            search.suspect = true;
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
    const Phase* phases_;  ///< phases of the first lane's link
    int group_;            ///< first lane's link, from the range's first
    int count_;
    alignas(64) double touching_[tips_per_link][W];
    std::array<std::uint32_t, W> words_{};  ///< phases of each link, 0 beyond the last
    std::uint32_t any_ = 0;
    std::array<std::uint32_t, W> found_{};  ///< phases of each link, by a search
    V near_{0.0}, deepest_{0.0};            ///< find_near(); deepest touching tip of each link [m]
    std::array<typename Contacts::PointBooks, tips_per_link> books_;
    const Contacts& contacts_;
};

/// LaneTips::add() of the links group, …, by what the pulleys are. @param loads of the range
template <int W, class Contacts>
inline bool add_tips(const Coefficients& c, const ChainRange& range, int group, int count, const Contacts& contacts,
                     const LinkColumns<W>& columns, Lanes<W>* f, Lanes<W>& moment, LinkLoad* loads) noexcept {
    const int first = range.first + group;
    // An eccentric sheave also moves across its axis, and where forces are observed, those that nothing yields to are, too.
    if (!Contacts::Books::observed && (c.layout.pulley_size | static_cast<int>(c.eccentric)) == 4)
        return LaneTips<W, true, Contacts>(c, range, first, count, contacts).add(columns, f, moment, loads + group);
    return LaneTips<W, false, Contacts>(c, range, first, count, contacts).add(columns, f, moment, loads + group);
}

}  // namespace
}  // namespace cvtflow::model
