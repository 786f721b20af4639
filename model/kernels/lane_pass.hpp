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
/// @tparam Contacts NoContacts or ObservationWriter
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

    /// slope [unknowns, per second]; nullptr where forces are observed: none
    LanePass(const ChainModel& model, const ChainRange& range, double* slope, LinkLoad* loads, const Contacts& contacts = {}) noexcept
        : model_(model),
          c_(model.coefficients()),
          range_(range),
          links_(range.last - range.first),
          slope_(slope),
          loads_(loads),
          contacts_(contacts) {}

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
    void read(int group, Columns& columns) const noexcept { read_links<W>(range_.window, group, links_, columns); }

    /// Joints of the pins behind the links `here`, the first of which is `group`.
    [[nodiscard]] Joints joints_between(const Columns& earlier, const Columns& here, int group = 0) const noexcept {
        const JointPlace pins(earlier, here);
        const auto& points = c_.joint_points;
        PointTerms total;
        V worst(0.0);
        Books books;
        typename Contacts::PointBooks of_point;
        const auto pressed = [&](int point) noexcept {
            const AxisPoint<W> at_point(points, point);
            const V weight(points.weight[static_cast<std::size_t>(point)]);
            const auto motion = joint_motion<W>(c_.joint, pins.frames, at_point, pins.gap, pins.rate);
            worst = larger<W>(beyond_clearance<W>(c_.joint, pins.frames, motion), worst);
            return with_books(rolling_contact_force<W>(c_.joint, pins.frames, at_point, weight, motion, of_point), of_point);
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
        if (!c_.longer.empty()) add_lengths(c_, lengths_of<W>(c_, range_.first + group, count), columns.q(), f, books);
        return moment;
    }

    void tips(int group, int count, const Columns& columns, V* f, V& moment, LinkLoad* loads) const noexcept {
        add_tips<W>(c_, range_, group, count, contacts_, columns, f, moment, loads);
    }

    /// Slopes of links group … from their forces, which are lost.
    void solve(int group, int count, V* f) const noexcept {
        accelerate(model_.inertia(), f);
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
        const KindLanes<W> kind(c_, range_.first + group, count);
        V moment = inner(kind, group, count, columns, f.data(), books);
        plates(kind, columns, f.data(), books);
        contacts_.book(AccountPart::link, group, count, books);
        contacts_.tension(group, count, kind, columns.q());
        moment += add_joints<W>(rear, next, f.data());
        tips(group, count, columns, f.data(), moment, loads_);
        if (observed && slope_ == nullptr) return;
        add_moment(columns.frame, moment, f.data());
        solve(group, count, f.data());
    }

    void plates(const KindLanes<W>& kind, const Columns& columns, V* f, Books& books) const noexcept {
        const Difference<V> d(columns.q(), End::front, columns.q(), End::rear), rate(columns.v(), End::front, columns.v(), End::rear);
        const auto& points = c_.plates;
        Difference<V> pull;
        for (int first = 0; first < points.count; first += points.width) {
            const auto pulled = [&](int plate) noexcept {
                const auto j = static_cast<std::size_t>(first) + static_cast<std::size_t>(plate);
                const AxisPoint<W> place(points, first + plate);
                const auto stretch = plate_stretch<W>(c_, kind.free_length, place, points.weight[j], points.damping[j], d, rate);
                return plate_terms<W, Books>(place, points.weight[j], points.damping[j], stretch, plate_slide(c_, stretch));
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
            : frames(frame_before(earlier.frame, here.frame), here.frame),
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
