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
#include <cstdint>
#include <cstring>

#include "model/chain/chain_model.hpp"
#include "model/force/inner.hpp"
#include "model/force/joint.hpp"
#include "model/force/plates.hpp"
#include "model/force/tips.hpp"
#include "model/kernels/link_lanes.hpp"
#include "model/kernels/link_sinks.hpp"

namespace cvtflow::model {
namespace {

/// Tips of links side by side, corner by corner: links that touch nowhere come along with forces of zero. @tparam Rigid whether sheaves
/// only turn and move along z; then only those reactions are written
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
