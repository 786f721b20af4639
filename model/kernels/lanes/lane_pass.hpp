#pragma once
/// One pass over a range of links, W at a time, keeping the states and joints of the links before. (model/kernels/lanes/link_lanes.hpp)

#include <algorithm>
#include <cstddef>
#include <type_traits>

#include "model/force/inner.hpp"
#include "model/force/joint.hpp"
#include "model/force/plates.hpp"
#include "model/kernels/lanes/contact_writer.hpp"
#include "model/kernels/lanes/lane_tips.hpp"
#include "model/kernels/lanes/link_lanes.hpp"
#include "model/variator/chain_model.hpp"

namespace cvtflow::model {
namespace {

/// `own` counts links from the range's first, and the pins behind them.
/// @tparam Contacts NoContacts, or ContactWriter: then accelerations go there instead of slopes
template <int P, int W, class Contacts = NoContacts>
class LanePass {
public:
    using V = Lanes<W>;
    using Columns = LinkColumns<P, W>;
    using Joints = JointForce<P, V>;
    static constexpr int size = at<P>.link_size();
    static constexpr int block = at<P>.link_block();

    /// slope [unknowns, per second]
    LanePass(const ChainModel& model, const ChainRange& range, double* slope, LinkLoad* loads) noexcept
        : model_(model),
          c_(model.coefficients()),
          range_(range),
          links_(range.last - range.first),
          slope_(slope),
          loads_(loads),
          contacts_{} {}
    /// With coefficients of its own.
    LanePass(const ChainModel& model, const Coefficients& coefficients, const ChainRange& range, LinkLoad* loads,
             const Contacts& contacts) noexcept
        : model_(model),
          c_(coefficients),
          range_(range),
          links_(range.last - range.first),
          slope_(nullptr),
          loads_(loads),
          contacts_(contacts) {}

    void run() const noexcept {
        std::array<Columns, 2> columns;  // of this group and the one before, taking turns
        std::array<Joints, 2> joints;    // of the pins behind their links
        std::size_t now = 0;
        read(-W, columns[1]);
        for (int own = 0; own <= links_; own += W) {
            read(own, columns[now]);
            joints[now] = joints_between(columns[now ^ 1], columns[now], own);
            if (own > 0) finish(own - W, columns[now ^ 1], joints[now ^ 1], joints[now]);
            now ^= 1;
        }
        const int last = links_ / W * W;
        if (last < links_) finish(last, columns[now ^ 1], joints[now ^ 1], joints[now ^ 1]);
    }

    // The parts, which benches time one by one.

    /// Links own … own + W - 1; lanes outside the window repeat its ends.
    void read(int own, Columns& columns) const noexcept {
        std::array<const double*, W> from;
        for (int lane = 0; lane < W; ++lane)
            from[static_cast<std::size_t>(lane)] = range_.window + std::clamp(own + lane + 1, 0, links_ + 1) * block;
        load_rows<W, block>(from, columns.state.data());
        columns.frame = link_frame<P>(columns.q(), columns.v());
    }

    /// Joints of the pins behind the links `here`, the first of which is `own`.
    [[nodiscard]] Joints joints_between(const Columns& earlier, const Columns& here, [[maybe_unused]] int own = 0) const noexcept {
        const auto& a = earlier.frame;
        const auto& b = here.frame;
        const JointFrames<V> frames(
            {before(a.tx, b.tx), before(a.ty, b.ty), before(a.inverse_length, b.inverse_length), before(a.turning, b.turning)}, b);
        const Difference<P, V> gap = opening(earlier.q(), here.q()), rate = opening(earlier.v(), here.v());
        const auto& points = c_.joint_points;
        [[maybe_unused]] const auto rows = contacts_.rows(own, std::min(W, links_ - own));
        if constexpr (Contacts::relative) contacts_.gaps(rows, contacts_.components().joint_gap(), rate);
        JointTerms<P, W> total;
        V worst(0.0);
        const auto pressed = [&](int point) noexcept {
            const AxisPoint<P, W> at_point(points, point);
            const V weight(points.weight[static_cast<std::size_t>(point)]);
            const auto motion = joint_motion<P, W>(c_.joint, frames, at_point, gap, rate);
            worst = larger<W>(beyond_clearance<W>(c_.joint, frames, motion), worst);
            if constexpr (Contacts::wanted) {
                const V normal = normal_force<W>(c_.joint, weight, motion).normal;
                contacts_.joint(rows, point, motion, normal);
                return rolling_terms<P, W>(c_.joint, frames, at_point, motion, normal, Zero{});
            } else {
                return rolling_contact_force<P, W, false>(c_.joint, frames, at_point, weight, motion, nullptr);
            }
        };
        pairwise_sum<W>(points.count, points.width, pressed, total);
        Joints out;
        out.add(total.data());
        if (all_at_most<W>(worst, 0.0)) return out;
        const auto held = [&](int point) noexcept {
            const AxisPoint<P, W> at_point(points, point);
            const auto motion = joint_motion<P, W>(c_.joint, frames, at_point, gap, rate);
            return clearance_force<P, W, false>(c_.joint, frames, at_point, V(points.weight[static_cast<std::size_t>(point)]), motion,
                                                nullptr);
        };
        pairwise_sum<W>(points.count, points.width, held, total);
        for (V& row : total) row = select_greater<W>(worst, V(0.0), row, V(0.0));  // of joints that exceed it somewhere
        out.add(total.data());
        return out;
    }

    /// Elasticity inside the links. Adds to f; returns moments about z.
    [[nodiscard]] V inner(int own, int count, const Columns& columns, V* f) const noexcept {
        return inner_elasticity<P, false>(c_, kinds(own, count), columns.frame, columns.q(), columns.v(), f, nullptr);
    }

    void tips(int own, int count, const Columns& columns, V* f, V& moment, LinkLoad* loads) const noexcept {
        const int first = range_.first + own;
        if ((c_.layout.pulley_size | static_cast<int>(c_.eccentric)) == 4) {  // an eccentric sheave also moves across its axis
            LaneTips<P, W, true, Contacts>(c_, range_, first, count, contacts_).add(columns, f, moment, loads + own);
        } else {
            LaneTips<P, W, false, Contacts>(c_, range_, first, count, contacts_).add(columns, f, moment, loads + own);
        }
    }

    /// Slopes of links own … from their forces, which are lost.
    void solve(int own, int count, V* f) const noexcept {
        multiply<2 * (P + 1), 2>(model_.inertia().lateral, f);
        multiply<4, 1>(model_.inertia().axial, f + 4 * (P + 1));
        if constexpr (Contacts::wanted) return contacts_.accelerations(own, count, f);
        std::array<double*, W> to;
        for (int lane = 0; lane < count; ++lane) {
            double* slope = slope_ + (own + lane) * block;
            std::memcpy(slope, range_.window + (own + lane + 1) * block + size, size * sizeof(double));
            to[static_cast<std::size_t>(lane)] = slope + size;
        }
        store_rows<W, size>(f, to, count);
    }

    /// Slopes of links own … from their states, the joints behind them and those behind the links that follow.
    void finish(int own, const Columns& columns, const Joints& rear, const Joints& next) const noexcept {
        const int count = std::min(W, links_ - own);
        std::array<V, size> f;
        f.fill(V(0.0));
        V moment = inner(own, count, columns, f.data());
        plates(kinds(own, count), columns, f.data(), own, count);
        if constexpr (Contacts::wanted) contacts_.frame(own, count, columns.frame);
        if constexpr (Contacts::relative) contacts_.velocities(own, count, columns.v());
        rear.on_front.apply(-1.0, f.data(), End::rear);
        add_front(rear, next, f.data());
        moment += rear.after + after(rear.before, next.before);
        tips(own, count, columns, f.data(), moment, loads_);
        add_moment<P>(columns.frame, moment, f.data());
        solve(own, count, f.data());
    }

    [[nodiscard]] KindLanes<W> kinds(int own, int count) const noexcept {
        constexpr int numbers = sizeof(LinkKind) / sizeof(double);
        static_assert(sizeof(KindLanes<W>) == numbers * sizeof(V));
        std::array<const double*, W> from;
        for (int lane = 0; lane < W; ++lane) {
            from[static_cast<std::size_t>(lane)] =
                reinterpret_cast<const double*>(&c_.kind(range_.first + own + std::min(lane, count - 1)));
        }
        std::array<V, numbers> rows;
        load_rows<W, numbers>(from, rows.data());
        KindLanes<W> kinds;
        std::memcpy(static_cast<void*>(&kinds), rows.data(), sizeof kinds);
        return kinds;
    }

    /// @param account LaneAccounts<W>*, or nullptr: not needed
    template <class Book = std::nullptr_t>
    void plates(const KindLanes<W>& kind, const Columns& columns, V* f, [[maybe_unused]] int own = 0, [[maybe_unused]] int count = 0,
                [[maybe_unused]] Book account = {}) const noexcept {
        constexpr bool observe = !std::is_same_v<Book, std::nullptr_t>;
        const Difference<P, V> d(columns.q(), End::front, columns.q(), End::rear), rate(columns.v(), End::front, columns.v(), End::rear);
        const auto& points = c_.plates;
        [[maybe_unused]] const auto rows = contacts_.rows(own, count);
        if constexpr (Contacts::relative) contacts_.gaps(rows, contacts_.components().plate_gap(), rate);
        Difference<P, V> pull;
        for (int first = 0; first < points.count; first += points.width) {
            const auto pulled = [&](int plate) noexcept {
                const std::size_t j = static_cast<std::size_t>(first + plate);
                const AxisPoint<P, W> place(points, first + plate);
                const auto stretch = plate_stretch<P, W>(c_, kind.free_length, place, points.weight[j], points.damping[j], d, rate);
                if constexpr (Contacts::wanted) {
                    contacts_.plate(rows, first + plate, stretch.tension);
                    return plate_terms<P, W, observe>(place, points.weight[j], points.damping[j], stretch, Zero{});
                } else {
                    return plate_terms<P, W, observe>(place, points.weight[j], points.damping[j], stretch, plate_slide(c_, stretch));
                }
            };
            std::array<V, plate_rows<P, observe>> total;
            pairwise_sum<W>(std::min(points.width, points.count - first), points.width, pulled, total);
            pull.add(total.data());
            if constexpr (observe) book_plates(total.data() + 2 * P + 4, account);
        }
        pull.apply(1.0, f, End::front);
        pull.apply(-1.0, f, End::rear);
    }

private:
    /// The lane before each lane.
    [[nodiscard]] static V before(const V& earlier, const V& here) noexcept { return slide<W, W - 1>(earlier, here); }
    /// The lane after each lane.
    [[nodiscard]] static V after(const V& here, const V& later) noexcept { return slide<W, 1>(here, later); }

    [[nodiscard]] static Difference<P, V> opening(const V* earlier, const V* here) noexcept {
        const auto front_minus_rear = [&](int front, int rear) { return before(earlier[front], here[front]) - here[rear]; };
        Difference<P, V> d;
        for (int m = 0; m <= P; ++m) {
            d.x[m] = front_minus_rear(at<P>.x(End::front, m), at<P>.x(End::rear, m));
            d.y[m] = front_minus_rear(at<P>.y(End::front, m), at<P>.y(End::rear, m));
        }
        d.z = front_minus_rear(at<P>.z(End::front), at<P>.z(End::rear));
        d.e = front_minus_rear(at<P>.e(End::front), at<P>.e(End::rear));
        return d;
    }

    /// Joints of the front pins: those behind the links that follow.
    static void add_front(const Joints& rear, const Joints& next, V* f) noexcept {
        const auto& a = rear.on_front;
        const auto& b = next.on_front;
        for (int m = 0; m <= P; ++m) {
            f[at<P>.x(End::front, m)] += after(a.x[m], b.x[m]);
            f[at<P>.y(End::front, m)] += after(a.y[m], b.y[m]);
        }
        f[at<P>.z(End::front)] += after(a.z, b.z);
        f[at<P>.e(End::front)] += after(a.e, b.e);
    }

    const ChainModel& model_;
    const Coefficients& c_;
    const ChainRange& range_;
    int links_;
    double* slope_;  ///< [unknowns, per second]
    LinkLoad* loads_;
    Contacts contacts_;
};

}  // namespace
}  // namespace cvtflow::model
