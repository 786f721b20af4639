#pragma once
/// One pass over a range of links, W at a time, keeping the states and joints of the links before. (model/kernels/link_lanes.hpp)

#include <algorithm>
#include <type_traits>

#include "model/chain/chain_model.hpp"
#include "model/force/inner.hpp"
#include "model/force/joint.hpp"
#include "model/force/plates.hpp"
#include "model/kernels/lane_tips.hpp"

namespace cvtflow::model {
namespace {

/// `group` counts links from the range's first, and the pins behind them.
/// @tparam Contacts NoContacts, ObservationWriter, or ContactWriter: then accelerations go there instead of slopes
template <int W, class Contacts = NoContacts>
class LanePass {
public:
    using V = Lanes<W>;
    using Columns = LinkColumns<W>;
    using Joints = JointForce<V>;
    static constexpr int size = link_layout.link_size();
    static constexpr int block = link_layout.link_block();
    using Books = typename Contacts::Books;
    static constexpr bool observed = Books::observed;

    /// slope [unknowns, per second]
    LanePass(const ChainModel& model, const ChainRange& range, double* slope, LinkLoad* loads, const Contacts& contacts = {}) noexcept
        : LanePass(model, model.coefficients(), range, slope, loads, contacts) {}
    /// Takes other coefficients than the model's.
    LanePass(const ChainModel& model, const Coefficients& c, const ChainRange& range, double* slope, LinkLoad* loads,
             const Contacts& contacts) noexcept
        : model_(model), c_(c), range_(range), links_(range.last - range.first), slope_(slope), loads_(loads), contacts_(contacts) {}

    void run() const noexcept {
        std::array<Columns, 2> columns;  // of this group and the one before, taking turns
        std::array<Joints, 2> joints;    // of the pins behind their links
        std::size_t now = 0;
        read(-W, columns[1]);
        for (int group = 0; group <= links_; group += W) {
            read(group, columns[now]);
            joints[now] = joints_between(columns[now ^ 1], columns[now], group);
            if (group > 0) finish(group - W, columns[now ^ 1], joints[now ^ 1], joints[now]);
            now ^= 1;
        }
        const int last = links_ / W * W;
        if (last < links_) finish(last, columns[now ^ 1], joints[now ^ 1], joints[now ^ 1]);
    }

    // The parts, which benches time one by one.

    /// Links group … group + W - 1; lanes outside the window repeat its ends.
    void read(int group, Columns& columns) const noexcept {
        std::array<const double*, W> from;
        for (int lane = 0; lane < W; ++lane)
            from[static_cast<std::size_t>(lane)] = range_.window + std::clamp(group + lane + 1, 0, links_ + 1) * block;
        load_rows<W, block>(from, columns.state.data());
        columns.frame = link_frame(columns.q(), columns.v());
        contacts_.frames(group, columns.frame);
    }

    /// Joints of the pins behind the links `here`, the first of which is `group`.
    [[nodiscard]] Joints joints_between(const Columns& earlier, const Columns& here, int group = 0) const noexcept {
        const JointPlace pins(earlier, here);
        const auto& points = c_.joint_points;
        const auto rows = contacts_.rows(group, links_ + 1 - group);
        contacts_.gap(rows, AccountPart::joint, pins.rate);
        PointTerms total;
        V worst(0.0);
        Books books;
        typename Contacts::PointBooks of_point;
        const auto pressed = [&](int point) noexcept {
            const AxisPoint<W> at_point(points, point);
            const V weight(points.weight[static_cast<std::size_t>(point)]);
            const auto motion = joint_motion<W>(c_.joint, pins.frames, at_point, pins.gap, pins.rate);
            worst = larger<W>(beyond_clearance<W>(c_.joint, pins.frames, motion), worst);
            if constexpr (Contacts::recorded) {
                const V normal = normal_force<W>(c_.joint, weight, motion).normal;
                contacts_.joint(rows, point, motion, normal);
                return rolling_terms<W>(c_.joint, pins.frames, at_point, motion, normal, Zero{});
            } else {
                return with_books(rolling_contact_force<W>(c_.joint, pins.frames, at_point, weight, motion, of_point), of_point);
            }
        };
        pairwise_sum<W>(points.count, points.width, pressed, total);
        Joints out;
        out.add(total.data());
        contacts_.book_point(total, of_point, books);
        if (!all_at_most<W>(worst, 0.0)) hold(pins, worst, out, books);
        contacts_.book(AccountPart::joint, group, links_ - group, books);
        return out;
    }

    /// Elasticity inside the links. Adds to f; returns moments about z.
    [[nodiscard]] V inner(const KindLanes<W>& kind, int group, int count, const Columns& columns, V* f, Books& books) const noexcept {
        const V moment = inner_elasticity(c_, kind, columns.frame, columns.q(), columns.v(), f, books);
        if (!c_.longer.empty()) add_lengths(c_, lengths(group, count), columns.q(), f, books);
        return moment;
    }

    void tips(int group, int count, const Columns& columns, V* f, V& moment, LinkLoad* loads) const noexcept {
        const int first = range_.first + group;
        // An eccentric sheave also moves across its axis, and where forces are observed, those that nothing yields to are, too.
        if (!observed && (c_.layout.pulley_size | static_cast<int>(c_.eccentric)) == 4) {
            LaneTips<W, true, Contacts>(c_, range_, first, count, contacts_).add(columns, f, moment, loads + group);
        } else {
            LaneTips<W, false, Contacts>(c_, range_, first, count, contacts_).add(columns, f, moment, loads + group);
        }
    }

    /// Slopes of links group … from their forces, which are lost.
    void solve(int group, int count, const Columns& columns, V* f) const noexcept {
        const HeldInverse* held = contacts_.held();
        if (held != nullptr)
            accelerate(*held, columns.frame, f);
        else
            accelerate(model_.inertia(), f);
        if constexpr (Contacts::recorded) return contacts_.accelerations(group, count, f);
        std::array<double*, W> to;
        for (int lane = 0; lane < count; ++lane) {
            double* slope = slope_ + (group + lane) * block;
            std::memcpy(slope, range_.window + (group + lane + 1) * block + size, size * sizeof(double));
            to[static_cast<std::size_t>(lane)] = slope + size;
        }
        store_rows<W, size>(f, to, count);
    }

    /// Slopes of links group … from their states, the joints behind them and those behind the links that follow.
    void finish(int group, const Columns& columns, const Joints& rear, const Joints& next) const noexcept {
        const int count = std::min(W, links_ - group);
        std::array<V, size> f;
        f.fill(V(0.0));
        Books books;
        const KindLanes<W> kind = kinds(group, count);
        V moment = inner(kind, group, count, columns, f.data(), books);
        plates(kind, columns, f.data(), books, group, count);
        contacts_.book(AccountPart::link, group, count, books);
        contacts_.tension(group, count, kind, columns.q());
        contacts_.link(group, count, columns);
        rear.on_front.apply(-1.0, f.data(), End::rear);
        add_front(rear, next, f.data());
        moment += rear.after + after(rear.before, next.before);
        tips(group, count, columns, f.data(), moment, loads_);
        add_moment(columns.frame, moment, f.data());
        solve(group, count, columns, f.data());
    }

    [[nodiscard]] KindLanes<W> kinds(int group, int count) const noexcept {
        constexpr int numbers = sizeof(LinkKind) / sizeof(double);
        static_assert(sizeof(KindLanes<W>) == numbers * sizeof(V));
        std::array<const double*, W> from;
        for (int lane = 0; lane < W; ++lane) {
            from[static_cast<std::size_t>(lane)] =
                reinterpret_cast<const double*>(&c_.kind(range_.first + group + std::min(lane, count - 1)));
        }
        std::array<V, numbers> rows;
        load_rows<W, numbers>(from, rows.data());
        KindLanes<W> kinds;
        std::memcpy(static_cast<void*>(&kinds), rows.data(), sizeof kinds);
        return kinds;
    }

    [[nodiscard]] std::array<V, 2> lengths(int group, int count) const noexcept {
        alignas(64) double longer[2][W];
        for (int lane = 0; lane < W; ++lane) {
            const std::array<double, 2> of_link = lengths_at(c_, range_.first + group + std::min(lane, count - 1));
            for (std::size_t end = 0; end < 2; ++end) longer[end][lane] = of_link[end];
        }
        return {load<W>(longer[0]), load<W>(longer[1])};
    }

    void plates(const KindLanes<W>& kind, const Columns& columns, V* f, Books& books, int group = 0, int count = 0) const noexcept {
        const Difference<V> d(columns.q(), End::front, columns.q(), End::rear), rate(columns.v(), End::front, columns.v(), End::rear);
        const auto& points = c_.plates;
        const auto rows = contacts_.rows(group, count);
        contacts_.gap(rows, AccountPart::link, rate);
        Difference<V> pull;
        for (int first = 0; first < points.count; first += points.width) {
            const auto pulled = [&](int plate) noexcept {
                const std::size_t j = static_cast<std::size_t>(first + plate);
                const AxisPoint<W> place(points, first + plate);
                const auto stretch = plate_stretch<W>(c_, kind.free_length, place, points.weight[j], points.damping[j], d, rate);
                if constexpr (Contacts::recorded) {
                    contacts_.plate(rows, first + plate, stretch.tension);
                    return plate_terms<W, Books>(place, points.weight[j], points.damping[j], stretch, Zero{});
                } else {
                    return plate_terms<W, Books>(place, points.weight[j], points.damping[j], stretch, plate_slide(c_, stretch));
                }
            };
            std::array<V, plate_rows<Books>> total;
            pairwise_sum<W>(std::min(points.width, points.count - first), points.width, pulled, total);
            pull.add(total.data());
            contacts_.book_plates(total, books);
        }
        pull.apply(1.0, f, End::front);
        pull.apply(-1.0, f, End::rear);
    }

private:
    /// Terms of a joint's point, with its energy and losses behind them where observed.
    using PointTerms = std::array<V, Joints::rows + Contacts::PointBooks::numbers>;

    [[nodiscard, gnu::always_inline]] static PointTerms with_books(const JointTerms<W>& terms,
                                                                   const typename Contacts::PointBooks& books) noexcept {
        if constexpr (!observed) {
            return terms;
        } else {
            PointTerms all;
            std::copy_n(books.rows.begin(), books.rows.size(), std::copy(terms.begin(), terms.end(), all.begin()));
            return all;
        }
    }

    /// The links that meet in joints side by side, and how the front halves lie and move against the rear halves.
    struct JointPlace {
        JointFrames<V> frames;
        Difference<V> gap, rate;

        JointPlace(const Columns& earlier, const Columns& here) noexcept
            : frames({before(earlier.frame.tx, here.frame.tx), before(earlier.frame.ty, here.frame.ty),
                      before(earlier.frame.inverse_length, here.frame.inverse_length), before(earlier.frame.turning, here.frame.turning)},
                     here.frame),
              gap(opening(earlier.q(), here.q())),
              rate(opening(earlier.v(), here.v())) {}
    };

    /// The clearance of plate openings, in joints that exceed it somewhere: where `worst` is above 0.
    void hold(const JointPlace& pins, const V& worst, Joints& out, Books& books) const noexcept {
        const auto& points = c_.joint_points;
        PointTerms total;
        typename Contacts::PointBooks of_point;
        const auto held = [&](int point) noexcept {
            const AxisPoint<W> at_point(points, point);
            const auto motion = joint_motion<W>(c_.joint, pins.frames, at_point, pins.gap, pins.rate);
            const V weight(points.weight[static_cast<std::size_t>(point)]);
            return with_books(clearance_force<W>(c_.joint, pins.frames, at_point, weight, motion, of_point), of_point);
        };
        pairwise_sum<W>(points.count, points.width, held, total);
        for (V& row : total) row = select_greater<W>(worst, V(0.0), row, V(0.0));
        out.add(total.data());
        contacts_.book_point(total, of_point, books);
    }

    /// The lane before each lane.
    [[nodiscard]] static V before(const V& earlier, const V& here) noexcept { return slide<W, W - 1>(earlier, here); }
    /// The lane after each lane.
    [[nodiscard]] static V after(const V& here, const V& later) noexcept { return slide<W, 1>(here, later); }

    [[nodiscard]] static Difference<V> opening(const V* earlier, const V* here) noexcept {
        const auto front_minus_rear = [&](int front, int rear) { return before(earlier[front], here[front]) - here[rear]; };
        Difference<V> d;
        for (int m = 0; m < axis_terms; ++m) {
            d.x[m] = front_minus_rear(link_layout.x(End::front, m), link_layout.x(End::rear, m));
            d.y[m] = front_minus_rear(link_layout.y(End::front, m), link_layout.y(End::rear, m));
        }
        d.z = front_minus_rear(link_layout.z(End::front), link_layout.z(End::rear));
        d.e = front_minus_rear(link_layout.e(End::front), link_layout.e(End::rear));
        return d;
    }

    /// Joints of the front pins: those behind the links that follow.
    static void add_front(const Joints& rear, const Joints& next, V* f) noexcept {
        const auto& a = rear.on_front;
        const auto& b = next.on_front;
        for (int m = 0; m < axis_terms; ++m) {
            f[link_layout.x(End::front, m)] += after(a.x[m], b.x[m]);
            f[link_layout.y(End::front, m)] += after(a.y[m], b.y[m]);
        }
        f[link_layout.z(End::front)] += after(a.z, b.z);
        f[link_layout.e(End::front)] += after(a.e, b.e);
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
