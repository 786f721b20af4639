#pragma once
/// Writes a contact field while forces are computed, links side by side in lanes: what LanePass hands over on its way.

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
    static constexpr const HeldInverse* held() noexcept { return nullptr; }
    [[nodiscard]] static int rows(int, int) noexcept { return 0; }
    static void frames(int, const auto& /*frame*/) noexcept {}
    static void link(int, int, const auto& /*columns*/) noexcept {}
    static void gap(int, AccountPart, const auto& /*rate*/) noexcept {}
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

/// Destination of the numbers of W links in rows of columns, of doubles or of floats; lanes first … last - 1 represent links.
template <int W, class Number>
struct GroupRows {
    Number* to;  ///< row 0, lane 0
    std::ptrdiff_t stride;
    int first, last;

    [[gnu::always_inline]] void put(int row, const Lanes<W>& lanes) const noexcept {
        Number* const place = to + row * stride;
        if (last - first == W)
            store(lanes, place);
        else
            put_some(place, lanes);
    }

private:
    [[gnu::noinline]] void put_some(Number* place, const Lanes<W>& lanes) const noexcept {
        alignas(64) Number buffer[W];
        store(lanes, buffer);
        if (first < last) std::copy_n(buffer + first, last - first, place + first);
    }
    static void store(const Lanes<W>& lanes, float* place) noexcept { store_rounded<W>(lanes, place); }
    static void store(const Lanes<W>& lanes, double* place) noexcept { lanes.copy_to(place); }
};

/// Groups of W links; `group` counts from the range's first, `count` of the lanes represent links. Further lanes are left out.
template <int W>
class ContactWriter : public NoContacts {
public:
    using V = Lanes<W>;
    using Joint = ContactComponents::Joint;
    using Tip = ContactComponents::Tip;
    using Rows = GroupRows<W, float>;
    static constexpr bool recorded = true;

    /// @param search nullptr: tips touch as the range's phases state
    ContactWriter(const FrictionOperator& friction, const ChainRange& range, const ContactDrift& drift, const ContactRecord& to,
                  TipSearch* search) noexcept
        : c_(friction.chain().coefficients()),
          held_(friction.held()),
          range_(range),
          drift_(drift),
          by_phase_(friction.by_phase()),
          field_(to.field),
          to_(to),
          search_(search) {}

    [[nodiscard]] TipSearch* search() const noexcept { return search_; }
    [[nodiscard]] const HeldInverse* held() const noexcept { return held_; }

    /// Rows of the field for the links group, …
    [[nodiscard]] Rows rows(int group, int count) const noexcept { return rows_of(field_.columns, group, count); }

    /// The links' frames, also of one link on each side of the range.
    void frames(int group, const LinkFrameOf<V>& frame) const noexcept {
        const Rows to = rows(group, range_.last - range_.first + 1 - group);
        to.put(ContactComponents::frame_x, frame.tx);
        to.put(ContactComponents::frame_y, frame.ty);
        to.put(ContactComponents::inverse_length, frame.inverse_length);
    }

    /// The links' velocities.
    void link(int group, int count, const LinkColumns<W>& columns) const noexcept { velocities(group, count, columns.v()); }

    /// @param to rows() of the links, and of the one behind the range
    void joint(const Rows& to, int point, const JointMotion<W>& m, const V& normal) const noexcept {
        const int row = field_.components.joint(point);
        to.put(row + Joint::normal_x, m.nx);
        to.put(row + Joint::normal_y, m.ny);
        to.put(row + Joint::lever_before, m.lever_before);
        to.put(row + Joint::lever_after, m.lever_after);
        to.put(row + Joint::friction_limit, c_.joint.friction.coefficient * normal);
        to.put(field_.components.sliding(point), m.slip);
    }

    /// Rates at which the gap of a joint opens, or that between the pins of a link.
    void gap(const Rows& to, AccountPart part, const Difference<V>& rate) const noexcept {
        const int row = part == AccountPart::joint ? field_.components.joint_gap() : field_.components.plate_gap();
        to.put(row, rate.z);
        to.put(row + 1, rate.e);
    }

    void plate(const Rows& to, int plate, const V& tension) const noexcept {
        to.put(field_.components.plate(plate), c_.plate_friction.coefficient * positive_part<W>(tension));
    }

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
        if (by_phase_) branches(group, count, corner);
    }

    /// Accelerations of a group, rows of the coordinates.
    void accelerations(int group, int count, const V* rows) const noexcept {
        const Rows to = rows_of(to_.frictionless, group, count);
        for (int row = 0; row < link_layout.link_size(); ++row) to.put(row, rows[row]);
    }

private:
    /// Velocities at the step's beginning, counted from those passed over. @param v of these, rows of the coordinates
    void velocities(int group, int count, const V* v) const noexcept {
        constexpr int size = link_layout.link_size(), block = 2 * size;
        constexpr int rows = (size + W - 1) / W * W;  // the last of a block: velocities, and some coordinates before them
        std::array<const double*, W> from;
        for (int lane = 0; lane < W; ++lane)
            from[static_cast<std::size_t>(lane)] = to_.states + (group + std::min(lane, count - 1) + 1) * block - rows;
        std::array<V, rows> begin;
        load_rows<W, rows>(from, begin.data());
        const Rows to = rows_of(to_.velocity, group, count);
        for (int row = 0; row < size; ++row) to.put(row, begin[static_cast<std::size_t>(rows - size + row)] - v[row]);
    }

    template <class Any>
    [[nodiscard]] GroupRows<W, Any> rows_of(ColumnsOf<Any>& columns, int group, int count) const noexcept {
        return {columns.at(0, range_.first + group + range_.shift), columns.stride(), std::max(0, -1 - group), std::min(count, W)};
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

    /// Speeds between which the branch of the law of a tip's phase has its kink.
    void branches(int group, int count, int corner) const noexcept {
        const int row = field_.components.tip(corner);
        const double v0 = c_.tip.friction.saturation_speed;
        const Rows to = rows(group, count);
        for (int lane = to.first; lane < to.last; ++lane) {
            const int link = range_.first + group + lane;
            const Phase phase = range_.phases[tips_per_link * link + corner];
            *field_.columns.at(row + Tip::least, link + range_.shift) = static_cast<float>(phase == Phase::slip ? slowest_single : v0);
            *field_.columns.at(row + Tip::most, link + range_.shift) =
                phase == Phase::stick ? static_cast<float>(v0) : std::numeric_limits<float>::max();
        }
    }

    const Coefficients& c_;  ///< friction included
    const HeldInverse* held_;
    const ChainRange& range_;
    const ContactDrift& drift_;
    bool by_phase_;
    ContactField& field_;
    const ContactRecord& to_;
    TipSearch* search_;
};

}  // namespace
}  // namespace cvtflow::model
