#pragma once
/// Sinks of LinkPass: SlopeWriter, with which nothing is observed, and RecordWriter, which records the contacts of links and their
/// accelerations by everything but friction, all that a step of a leapfrog takes from the chain's forces. (link_pass.hpp)

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "model/basis/lanes.hpp"
#include "model/chain/chain_model.hpp"
#include "model/contact/friction_operator.hpp"
#include "model/force/joint.hpp"
#include "model/force/plates.hpp"
#include "model/force/tips.hpp"
#include "model/kernels/link_lanes.hpp"

namespace cvtflow::model {
namespace {

/// Links of a group whose tips are computed.
template <int W>
struct TipLinks {
    int group, count;                             ///< first, from the range's first link; lanes that represent links
    const std::array<std::uint32_t, W>& touches;  ///< phases of each link, 0: it touches nowhere
};

/// No observation: slopes of links.
template <int W>
struct SlopeWriter {
    using V = Lanes<W>;
    using Books = NoBooks;
    using PointBooks = NoBooks;
    static constexpr int width = W, doubles = W, size = link_layout.link_size();
    static constexpr bool recorded = false;

    const ChainModel& model;
    const ChainRange& range;
    double* slope;    ///< [unknowns, per second] of the range's first link on; nullptr: none
    LinkLoad* loads;  ///< of the range's first link on

    [[nodiscard]] const Coefficients& coefficients() const noexcept { return model.coefficients(); }
    [[nodiscard]] const auto& joint_points() const noexcept { return coefficients().joint_points; }
    [[nodiscard]] const auto& plates() const noexcept { return coefficients().plates; }
    [[nodiscard]] const auto& tips() const noexcept { return *this; }

    static void frame_before(const auto&...) noexcept {}
    static void frames(int, const auto&...) noexcept {}
    [[nodiscard]] static Zero joints(int) noexcept { return {}; }
    [[nodiscard]] static Zero links(int) noexcept { return {}; }
    static void joint(Zero, const auto&...) noexcept {}
    static void pack(Zero, const auto&...) noexcept {}
    /// Friction of a joint's point per speed [N·s/m].
    [[nodiscard]] V rolling(Zero, int, const JointMotion<W>& motion, const V& normal, auto& books) const noexcept {
        return rolling_friction<W>(coefficients().joint, motion, normal, books);
    }
    /// Friction of a plate per speed [N·s/m].
    [[nodiscard]] V sliding(Zero, int, const PlateStretch<W>& stretch, const V& speed, const auto& /*books*/) const noexcept {
        return plate_slide(coefficients(), stretch, speed);
    }

    static constexpr TipSearch* search() noexcept { return nullptr; }
    static void tip(const auto& /*links*/, int, const auto&...) noexcept {}
    static void no_tips(int, int) noexcept {}
    static void book(AccountPart, int, int, const auto& /*books*/) noexcept {}
    static void book_point(const auto& /*total*/, const auto& /*of_point*/, auto& /*books*/) noexcept {}
    static void book_tips(int, int, const auto& /*of_tips*/) noexcept {}

    /// Slopes of links group … from the forces on them, which are lost.
    void finish(int group, const auto& /*columns*/, const LinkFrameOf<V>& frame, const V& moment, std::array<V, size>& f) const noexcept {
        if (slope == nullptr) return;
        const int count = std::min(W, range.last - range.first - group);
        add_moment(frame, moment, f.data());
        accelerate(model.inertia(), f.data());
        std::array<double*, W> to;
        for (int lane = 0; lane < count; ++lane) {
            double* of_link = slope + (group + lane) * 2 * size;
            std::memcpy(of_link, range.window + (group + lane + 1) * 2 * size + size, size * sizeof(double));
            to[static_cast<std::size_t>(lane)] = of_link + size;
        }
        store_rows<W, size>(f.data(), to, count);
    }
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
class TipWriter {
public:
    using V = Lanes<W>;
    using Tip = ContactComponents::Tip;
    using Rows = GroupRows<W, float>;
    using Books = NoBooks;
    using PointBooks = NoBooks;
    static constexpr bool recorded = true;

    /// @param search nullptr: tips touch as the range's phases state
    TipWriter(const FrictionOperator& friction, const ChainRange& range, const ContactDrift& drift, const ContactRecord& to,
              TipSearch* search) noexcept
        : c_(friction.chain().coefficients()), range_(range), drift_(drift), field_(to.field), search_(search) {}

    [[nodiscard]] TipSearch* search() const noexcept { return search_; }
    static void book_tips(int, int, const auto& /*of_tips*/) noexcept {}

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

/// Writes the contacts of groups of links, and their accelerations without friction. @tparam N doubles in a vector of the processor; links
/// in a group are twice as many
template <int N>
class RecordWriter {
public:
    static constexpr int width = singles<2 * N>, doubles = N, size = link_layout.link_size();
    using V = Lanes<width>;
    using Rows = GroupRows<width, float>;
    using Books = NoBooks;
    using PointBooks = NoBooks;

    const ChainRange& range;
    LinkLoad* loads;  ///< of the range's first link on

    RecordWriter(const FrictionOperator& friction, const ChainRange& links, const ContactDrift& drift, const ContactRecord& to,
                 LinkLoad* loads_of_links, TipSearch* search) noexcept
        : range(links),
          loads(loads_of_links),
          c_(friction.chain().coefficients()),
          numbers_(friction.numbers()),
          to_(to),
          tips_(friction, links, drift, to, search) {}

    [[nodiscard]] const Coefficients& coefficients() const noexcept { return c_; }
    [[nodiscard]] const auto& joint_points() const noexcept { return numbers_.joint_points; }
    [[nodiscard]] const auto& plates() const noexcept { return numbers_.plates; }
    [[nodiscard]] const TipWriter<N>& tips() const noexcept { return tips_; }

    /// The frame of the link before the range.
    void frame_before(const LinkFrameOf<Lanes<N>>& frame) const noexcept {
        const auto put = [&](int row, const Lanes<N>& lanes) {
            *to_.field.columns.at(row, range.first - 1 + range.shift) = static_cast<float>(lanes[N - 1]);
        };
        put(ContactComponents::frame_x, frame.tx);
        put(ContactComponents::frame_y, frame.ty);
        put(ContactComponents::inverse_length, frame.inverse_length);
    }
    /// Rows of the contacts of links group, …, and of joints, one more.
    [[nodiscard]] Rows links(int group) const noexcept { return rows_of(to_.field.columns, group, 0); }
    [[nodiscard]] Rows joints(int group) const noexcept { return rows_of(to_.field.columns, group, 1); }

    void frames(int group, const LinkFrameOf<V>& frame) const noexcept {
        const Rows to = joints(group);
        to.put(ContactComponents::frame_x, frame.tx);
        to.put(ContactComponents::frame_y, frame.ty);
        to.put(ContactComponents::inverse_length, frame.inverse_length);
        to.put(ContactComponents::outward, frame.turning * frame.turning / frame.inverse_length);
    }
    void joint(const Rows& to, const Difference<V>& rate) const noexcept {
        to.put(to_.field.components.joint_gap(), rate.z);
        to.put(to_.field.components.joint_gap() + 1, rate.e);
    }
    [[nodiscard, gnu::always_inline]] Zero rolling(const Rows& to, int point, const JointMotion<width>& m, const V& normal,
                                                   const NoBooks&) const noexcept {
        using Joint = ContactComponents::Joint;
        const int row = to_.field.components.joint(point);
        to.put(row + Joint::normal_x, m.nx);
        to.put(row + Joint::normal_y, m.ny);
        to.put(row + Joint::lever_before, m.lever_before);
        to.put(row + Joint::lever_after, m.lever_after);
        to.put(row + Joint::friction_limit, c_.joint.friction.coefficient * normal);
        to.put(to_.field.components.sliding(point), m.slip);
        return {};
    }
    void pack(const Rows& to, const PackOpening<V>& rate) const noexcept {
        to.put(to_.field.components.plate_gap(), rate.z);
        to.put(to_.field.components.plate_gap() + 1, rate.e);
    }
    [[nodiscard, gnu::always_inline]] Zero sliding(const Rows& to, int plate, const PlateStretch<width>& stretch, const V& /*speed*/,
                                                   const NoBooks&) const noexcept {
        to.put(to_.field.components.plate(plate), plate_limit(c_, stretch));
        return {};
    }
    static void book(AccountPart, int, int, const NoBooks&) noexcept {}
    static void book_point(const auto& /*total*/, const NoBooks&, const NoBooks&) noexcept {}

    /// Accelerations from forces, and the velocities at the step's beginning, counted from those passed over.
    void finish(int group, const std::array<LinkColumns<N>, 2>& columns, const LinkFrameOf<V>& frame, const V& moment,
                std::array<V, size>& f) const noexcept {
        add_moment(frame, moment, f.data());
        accelerate<width>(numbers_.inverse, frame, f.data());
        put_all(rows_of(to_.frictionless, group, 0), f);
        put_all(rows_of(to_.velocity, group, 0), rounded(velocities(group, columns[0]), velocities(group + N, columns[1])));
    }

private:
    /// Rows of the links group, …, and of that many behind the range.
    [[nodiscard, gnu::always_inline]] Rows rows_of(FloatColumns& columns, int group, int behind) const noexcept {
        const int count = range.room ? 2 * N : std::min(2 * N, range.last - range.first + behind - group);
        return {columns.at(0, range.first + group + range.shift), columns.stride(), count};
    }
    static void put_all(const Rows& to, const std::array<V, size>& rows) noexcept {
        for (int row = 0; row < size; ++row) to.put(row, rows[static_cast<std::size_t>(row)]);
    }

    [[nodiscard, gnu::always_inline]] std::array<Lanes<N>, size> velocities(int first, const LinkColumns<N>& columns) const noexcept {
        constexpr int rows = (size + N - 1) / N * N;  // the last of a block: velocities, and some coordinates before them
        std::array<const double*, N> from;
        for (int lane = 0; lane < N; ++lane) {
            const int link = std::min(first + lane, range.last - range.first - 1);
            from[static_cast<std::size_t>(lane)] = to_.states + (link + 1) * 2 * size - rows;
        }
        std::array<Lanes<N>, rows> begin;
        load_rows<N, rows>(from, begin.data());
        std::array<Lanes<N>, size> from_these;
        for (std::size_t row = 0; row < size; ++row) from_these[row] = begin[rows - size + row] - columns.v()[row];
        return from_these;
    }

    const Coefficients& c_;
    const FrictionNumbers& numbers_;
    const ContactRecord& to_;
    TipWriter<N> tips_;
};

}  // namespace
}  // namespace cvtflow::model
