#pragma once
/// Writes the tips of a contact field, links side by side in lanes: a part of RecordPass. And NoContacts, with which LanePass observes
/// nothing.

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "model/basis/lanes.hpp"
#include "model/chain/chain_model.hpp"
#include "model/contact/contact_field.hpp"
#include "model/contact/friction_operator.hpp"
#include "model/force/joint.hpp"
#include "model/force/tips.hpp"
#include "model/kernels/link_lanes.hpp"

namespace cvtflow::model {
namespace {

/// No observation: forces only, so nothing is written.
struct NoContacts {
    using Books = NoBooks;
    using PointBooks = NoBooks;
    static constexpr bool recorded = false;
    static constexpr TipSearch* search() noexcept { return nullptr; }
    static void tip(const auto& /*links*/, int, const auto&...) noexcept {}
    static void no_tips(int, int) noexcept {}
    static void tension(int, int, const auto&...) noexcept {}
    static void book(AccountPart, int, int, const auto& /*books*/) noexcept {}
    static void book_point(const auto& /*total*/, const auto& /*of_point*/, auto& /*books*/) noexcept {}
    static void book_plates(const auto& /*total*/, auto& /*books*/) noexcept {}
    static void book_tips(int, int, const auto& /*of_tips*/) noexcept {}
};

/// Links of a group whose tips are computed.
template <int W>
struct TipLinks {
    int group, count;                             ///< first, from the range's first link; lanes that represent links
    const std::array<std::uint32_t, W>& touches;  ///< phases of each link, 0: it touches nowhere
};

/// Destination of the numbers of W links in rows of columns, of doubles or of floats.
template <int W, class Number>
struct GroupRows {
    Number* to;  ///< row 0, lane 0
    std::ptrdiff_t stride;
    int count;  ///< lanes to be written, from the first one

    [[gnu::always_inline]] void put(int row, const Lanes<W>& lanes) const noexcept {
        Number* const place = to + row * stride;
        if (count == lane_count<W>)
            store(lanes, place);
        else
            put_some(place, lanes);
    }

private:
    [[gnu::noinline]] void put_some(Number* place, const Lanes<W>& lanes) const noexcept {
        alignas(64) Number buffer[static_cast<std::size_t>(lane_count<W>)];
        store(lanes, buffer);
        std::copy_n(buffer, std::max(count, 0), place);
    }
    static void store(const Lanes<W>& lanes, NumberOf<W>* place) noexcept { lanes.copy_to(place); }
    static void store(const Lanes<W>& lanes, float* place) noexcept requires(!is_single<W>) { store_rounded<W>(lanes, place); }
};

/// Writes tips of groups of W links; `group` counts from the range's first, `count` of the lanes represent links. Lanes outside the range
/// are left out.
template <int W>
class ContactWriter : public NoContacts {
public:
    using V = Lanes<W>;
    using Tip = ContactComponents::Tip;
    using Rows = GroupRows<W, float>;
    static constexpr bool recorded = true;

    /// @param search nullptr: tips touch as the range's phases state
    ContactWriter(const FrictionOperator& friction, const ChainRange& range, const ContactDrift& drift, const ContactRecord& to,
                  TipSearch* search) noexcept
        : c_(friction.chain().coefficients()), range_(range), drift_(drift), field_(to.field), search_(search) {}

    [[nodiscard]] TipSearch* search() const noexcept { return search_; }

    /// Links that touch nowhere.
    void no_tips(int group, int count) const noexcept {
        const Rows to = rows(group, count);
        for (int corner = 0; corner < tips_per_link; ++corner) to.put(field_.components.tip(corner) + Tip::friction_limit, V(0.0));
    }

    /// @param sheave of the tip's side for every link, shaft its number
    template <class Forces>
    void tip(const TipLinks<W>& links, int corner, const TipGeometry<V>& g, const TipMotion<V>& m, const Forces& forces,
             const SheaveMotionLanes<W>& sheave, const V& shaft) const noexcept {
        const int group = links.group, count = links.count;
        const Rows to = rows(group, count);
        const int row = field_.components.tip(corner);
        to.put(row + Tip::normal, g.normal.x);
        to.put(row + Tip::normal + 1, g.normal.y);
        to.put(row + Tip::normal + 2, g.normal.z);
        to.put(row + Tip::lever_x, m.lever_x);
        to.put(row + Tip::lever_y, m.lever_y);
        const V limit = c_.tip.friction.coefficient * forces.normal;
        to.put(row + Tip::friction_limit,
               c_.tip.law == nullptr ? limit : limit * pressure_factor<W>(*c_.tip.law, sqrt(positive_part<W>(g.depth))));
        surface(to, corner, m, sheave, shaft);
        const GroupRows<W, double> arms = rows_of(field_.arms, group, count);
        arms.put(3 * corner, m.sheave_arm.x);
        arms.put(3 * corner + 1, m.sheave_arm.y);
        arms.put(3 * corner + 2, m.sheave_arm.z);
    }

private:
    [[nodiscard]] Rows rows(int group, int count) const noexcept { return rows_of(field_.columns, group, count); }
    template <class Any>
    [[nodiscard]] GroupRows<W, Any> rows_of(ColumnsOf<Any>& columns, int group, int count) const noexcept {
        return {columns.at(0, range_.first + group + range_.shift), columns.stride(), std::min(count, W)};
    }

    /// Velocity of the sheave at a tip's contact, and how it changes over the step while both go round.
    void surface(const Rows& to, int corner, const TipMotion<V>& m, const SheaveMotionLanes<W>& s, const V& shaft) const noexcept {
        const Vector3<V>& p = m.sheave_arm;
        const auto change = [&](int number) {
            return select_greater<W>(shaft, V(0.5), V(drift_.change[2 + corner % 2][number]), V(drift_.change[corner % 2][number]));
        };
        const V x = s.spin_y * p.z - s.spin_z * p.y, y = s.spin_z * p.x - s.spin_x * p.z, z = s.spin_x * p.y - s.spin_y * p.x;
        const V cx = change(3), cy = change(4), cz = change(5);
        const double h = drift_.step;
        const int row = field_.components.tip(corner);
        to.put(row + Tip::sheave, -m.material.x);
        to.put(row + Tip::sheave + 1, -m.material.y);
        to.put(row + Tip::sheave + 2, -m.material.z);
        to.put(row + Tip::drift, change(0) + cy * p.z - cz * p.y + h * (s.spin_y * z - s.spin_z * y));
        to.put(row + Tip::drift + 1, change(1) + cz * p.x - cx * p.z + h * (s.spin_z * x - s.spin_x * z));
        to.put(row + Tip::drift + 2, change(2) + cx * p.y - cy * p.x + h * (s.spin_x * y - s.spin_y * x));
    }

    const Coefficients& c_;  ///< friction included
    const ChainRange& range_;
    const ContactDrift& drift_;
    ContactField& field_;
    TipSearch* search_;
};

}  // namespace
}  // namespace cvtflow::model
