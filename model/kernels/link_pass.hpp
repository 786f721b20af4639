#pragma once
/// One pass over a range of links, a group side by side at a time, keeping the states and joints of the group before. (link_lanes.hpp)
/// A sink decides what the pass is for, and gets what it finds:
///
///     sink               numbers    pass
///     SlopeWriter        doubles    evaluates: slopes of links, by all forces
///     ObservationWriter  doubles    observes: energies, losses and contacts as well
///     RecordWriter       floats     records: contacts for the sweeps of the default's step, accelerations by all forces but friction
///
/// The forces are those of model/force, the same for every sink. In floats a group is twice as many links. Differences between coordinates,
/// frames and tips are then computed in doubles, in two parts, and rounded:
///
///     states (doubles)         link_frame(), joint_place(), pack_place()        forces (floats)
///     part 0: links 0 … N-1    ─┐  what is left are stretches and gaps (µm),
///     part 1: links N … 2N-1   ─┴─ which floats resolve to 1e-7 of them     ─>  links 0 … 2N-1

#include <algorithm>
#include <array>

#include "model/chain/chain_model.hpp"
#include "model/force/inner.hpp"
#include "model/force/joint.hpp"
#include "model/force/plates.hpp"
#include "model/kernels/lane_tips.hpp"

namespace cvtflow::model {
namespace {

/// `group` counts links from the range's first, and the pins behind them.
template <class Sink>
class LinkPass {
public:
    static constexpr int W = Sink::width, N = Sink::doubles, parts = lane_count<W> / N, size = link_layout.link_size();
    using V = Lanes<W>;
    using Columns = std::array<LinkColumns<N>, parts>;
    using Books = typename Sink::Books;
    using PointBooks = typename Sink::PointBooks;

    explicit LinkPass(const Sink& sink) noexcept
        : sink_(sink), c_(sink.coefficients()), range_(sink.range), links_(range_.last - range_.first) {}

    void run() const noexcept {
        constexpr int step = lane_count<W>;
        std::array<Columns, 2> columns;  // of this group and the one before, taking turns
        std::array<LinkFrameOf<V>, 2> frames;
        std::array<JointForce<V>, 2> joints;  // of the pins behind their links
        std::size_t now = 0;
        read(-N, columns[1].back());
        sink_.frame_before(columns[1].back().frame);
        for (int group = 0; group <= links_; group += step, now ^= 1) {
            for (int part = 0; part < parts; ++part) read(group + part * N, columns[now][static_cast<std::size_t>(part)]);
            frames[now] = of_parts([&](std::size_t part) { return columns[now][part].frame; });
            sink_.frames(group, frames[now]);
            joints[now] = joints_between(columns[now ^ 1].back(), columns[now], group);
            if (group > 0) finish(group - step, columns[now ^ 1], frames[now ^ 1], joints[now ^ 1], joints[now]);
        }
        const int last = links_ / step * step;
        if (last < links_) finish(last, columns[now ^ 1], frames[now ^ 1], joints[now ^ 1], joints[now ^ 1]);
    }

private:
    /// Terms of a joint's point, with its energy and losses behind them where observed.
    using PointTerms = std::array<V, JointForce<>::rows + PointBooks::numbers>;

    /// Links group … group + N - 1; lanes outside the window repeat its ends.
    void read(int group, LinkColumns<N>& columns) const noexcept { read_links<N>(range_.window, group, links_, columns); }

    /// What make(0) returns, with that of make(1) beside it in floats.
    template <class Make>
    [[gnu::always_inline]] static decltype(auto) of_parts(const Make& make) noexcept {
        if constexpr (parts == 1)
            return make(0);
        else
            return rounded(make(0), make(1));
    }

    /// Joints of the pins behind the links `here`. @param earlier the part before them
    [[nodiscard]] JointForce<V> joints_between(const LinkColumns<N>& earlier, const Columns& here, int group) const noexcept {
        const JointPlace<V> pins = of_parts([&](std::size_t part) {
            const LinkColumns<N>&before = part == 0 ? earlier : here[part - 1], &after = here[part];
            return joint_place(c_.joint, frame_before(before.frame, after.frame), after.frame, opening(before.q(), after.q()),
                               opening(before.v(), after.v()));
        });
        const auto to = sink_.joints(group);
        sink_.joint(to, pins.rate);
        const auto& points = sink_.joint_points();
        PointTerms total;
        V worst(0.0);
        Books books;
        PointBooks of_point;
        const auto pressed = [&](int point) noexcept {
            const AxisPoint<W> at_point(points, point);
            const V weight(points.weight[static_cast<std::size_t>(point)]);
            const auto motion = joint_motion<W>(c_.joint, pins, at_point);
            worst = larger<W>(beyond_clearance<W>(c_.joint, pins.frames, motion), worst);
            const auto friction = [&](const V& normal) { return sink_.rolling(to, point, motion, normal, of_point); };
            return with_books(rolling_contact_force<W>(c_.joint, pins.frames, at_point, weight, motion, of_point, friction), of_point);
        };
        pairwise_sum<W>(points.count, points.width, pressed, total);
        JointForce<V> out;
        out.add(total.data());
        sink_.book_point(total, of_point, books);
        if (!all_at_most<W>(worst, 0.0)) hold(pins, worst, out, books);
        sink_.book(AccountPart::joint, group, links_ - group, books);
        return out;
    }

    /// The clearance of plate openings, in joints that exceed it somewhere: where `worst` is above 0.
    [[gnu::noinline]] void hold(const JointPlace<V>& pins, const V& worst, JointForce<V>& out, Books& books) const noexcept {
        const auto& points = sink_.joint_points();
        PointTerms total;
        PointBooks of_point;
        const auto held = [&](int point) noexcept {
            const AxisPoint<W> at_point(points, point);
            const auto motion = joint_motion<W>(c_.joint, pins, at_point);
            const V weight(points.weight[static_cast<std::size_t>(point)]);
            return with_books(clearance_force<W>(c_.joint, pins.frames, at_point, weight, motion, of_point), of_point);
        };
        pairwise_sum<W>(points.count, points.width, held, total);
        for (V& row : total) row = select_greater<W>(worst, V(0.0), row, V(0.0));
        out.add(total.data());
        sink_.book_point(total, of_point, books);
    }

    [[nodiscard, gnu::always_inline]] static PointTerms with_books(const JointTerms<W>& terms, const PointBooks& books) noexcept {
        if constexpr (PointBooks::numbers == 0) {
            return terms;
        } else {
            PointTerms all;
            std::copy_n(books.rows.begin(), books.rows.size(), std::copy(terms.begin(), terms.end(), all.begin()));
            return all;
        }
    }

    /// All forces on links group …, from their states, the joints behind them and those behind the links that follow.
    void finish(int group, const Columns& columns, const LinkFrameOf<V>& frame, const JointForce<V>& rear,
                const JointForce<V>& next) const noexcept {
        const int count = std::min(lane_count<W>, links_ - group);
        const auto& state = of_parts([&](std::size_t part) -> const auto& { return columns[part].state; });
        const V *q = state.data(), *v = q + size;
        std::array<V, size> f;
        f.fill(V(0.0));
        Books books;
        const std::array<KindLanes<N>, parts> kinds = kinds_of(group);
        V moment = inner_elasticity(c_, of_parts([&](std::size_t part) { return kinds[part]; }), frame, q, v, f.data(), books);
        if (!c_.longer.empty()) add_longer(group, q, f.data(), books);
        plates(group, columns, kinds, frame, f.data(), books);
        sink_.book(AccountPart::link, group, count, books);
        moment += add_joints<W>(rear, next, f.data());
        add_tips(group, columns, f.data(), moment);
        sink_.finish(group, columns, frame, moment, f);
    }

    /// First of the links of a part; the last one of the range where it has none.
    [[nodiscard]] int first_of(int group, std::size_t part) const noexcept {
        return std::min(group + static_cast<int>(part) * N, links_ - 1);
    }

    [[nodiscard]] std::array<KindLanes<N>, parts> kinds_of(int group) const noexcept {
        std::array<KindLanes<N>, parts> kinds;
        for (std::size_t part = 0; part < parts; ++part)
            kinds[part] = KindLanes<N>(c_, range_.first + first_of(group, part), links_ - first_of(group, part));
        return kinds;
    }

    void add_longer(int group, const V* q, V* f, Books& books) const noexcept {
        const auto longer = of_parts(
            [&](std::size_t part) { return lengths_of<N>(c_, range_.first + first_of(group, part), links_ - first_of(group, part)); });
        add_lengths(c_, longer, q, f, books);
    }

    void plates(int group, const Columns& columns, const std::array<KindLanes<N>, parts>& kinds, const LinkFrameOf<V>& frame, V* f,
                Books& books) const noexcept {
        const PackPlace<V> place =
            of_parts([&](std::size_t part) { return pack_place(columns[part].q(), columns[part].frame, kinds[part].free_length); });
        const PackOpening<V> rate(of_parts([&](std::size_t part) {
                                      const Lanes<N>* v = columns[part].v();
                                      return Difference<Lanes<N>>(v, End::front, v, End::rear);
                                  }),
                                  frame);
        const auto to = sink_.links(group);
        sink_.pack(to, rate);
        const auto slide = [&](int plate, const PlateStretch<W>& stretch, const V& sliding) {
            return sink_.sliding(to, plate, stretch, sliding, books);
        };
        const Difference<V> force = pack_force<W>(sink_.plates(), place, rate, frame, books, slide);
        force.apply(1.0, f, End::front);
        force.apply(-1.0, f, End::rear);
    }

    void add_tips(int group, const Columns& columns, V* f, V& moment) const noexcept {
        std::array<std::array<Lanes<N>, size + 1>, parts> share{};  // force, moment
        bool any = false;
        for (std::size_t part = 0; part < parts; ++part) {
            const int first = group + static_cast<int>(part) * N;
            if (first < links_)
                any |= model::add_tips<N>(c_, range_, first, links_ - first, sink_.tips(), columns[part], share[part].data(),
                                          share[part][size], sink_.loads);
        }
        if (!any) return;
        const auto& all = of_parts([&](std::size_t part) -> const auto& { return share[part]; });
        for (std::size_t k = 0; k < size; ++k) f[k] += all[k];
        moment += all[size];
    }

    const Sink& sink_;
    const Coefficients& c_;
    const ChainRange& range_;
    int links_;
};

}  // namespace
}  // namespace cvtflow::model
