#pragma once
/// One pass over a range of links, W at a time, keeping the states and joints of the links before; tips corner by corner, where links that
/// touch nowhere come along with forces of zero. (model/kernels/link_lanes.hpp)

#include <algorithm>
#include <cstddef>
#include <type_traits>

#include "model/chain/chain_model.hpp"
#include "model/force/inner.hpp"
#include "model/force/joint.hpp"
#include "model/force/plates.hpp"
#include "model/force/tips.hpp"
#include "model/kernels/contact_writer.hpp"
#include "model/kernels/link_lanes.hpp"

namespace cvtflow::model {
namespace {

/// @tparam Rigid whether sheaves only turn and move along z; then only those reactions are written
template <int P, int W, bool Rigid, class Contacts = NoContacts>
class LaneTips {
public:
    using V = Lanes<W>;
    using Columns = LinkColumns<P, W>;
    using Reaction = TipReaction<V>;
    static constexpr int size = link_layout<P>.link_size();

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

    /// Adds forces and moments on the links; reactions of those that touch to loads.
    void add(const Columns& columns, V* f, V& moment, LinkLoad* loads) noexcept {
        const bool searches = contacts_.search() != nullptr;
        if (searches) find_near(columns);
        if (any_ == 0) {
            if (searches) keep_phases();
            if constexpr (Contacts::recorded) contacts_.no_tips(group_, count_);
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
        if (searches) {
            std::copy_n(found_.begin(), count_, words_.begin());  // further lanes belong to others
            keep_phases();
            check_limits(columns, shaft);
        }
        write(rear, front, shaft, loads);
    }

private:
    /// Both tips of a half: adds their forces to share, returns their moments.
    template <End end>
    [[nodiscard]] std::array<V, 2> pair(const Columns& columns, const std::array<SheaveMotionLanes<W>, 2>& sheaves, const V& shaft,
                                        std::array<Reaction, 2>& reaction, std::array<V, size>& share) noexcept {
        const TipAction<V> minus = tip(OneTip<W, end, 0>{}, 2 * static_cast<int>(end), columns, sheaves.data(), shaft, reaction[0]);
        const TipAction<V> plus = tip(OneTip<W, end, 1>{}, 2 * static_cast<int>(end) + 1, columns, sheaves.data(), shaft, reaction[1]);
        load_end<P>(end, minus, plus, share.data());
        return {minus.moment, plus.moment};
    }

    template <class Corner>
    [[nodiscard]] TipAction<V> tip(const Corner& corner, int number, const Columns& columns, const SheaveMotionLanes<W>* sheaves,
                                   [[maybe_unused]] const V& shaft, Reaction& reaction) noexcept {
        const auto sheave = [&] {
            if constexpr (Rigid)
                return rigid_sheaves_at(corner, sheaves);
            else
                return sheaves_at(corner, sheaves);
        }();
        const auto geometry = tip_geometry<P>(c_, corner, columns.frame, columns.q(), sheave);
        const auto motion = tip_motion<P>(c_, corner, columns.frame, columns.v(), sheave, geometry);
        const auto forces = forces_of(number, geometry, motion);
        if constexpr (Contacts::recorded)
            contacts_.tip(group_, count_, number, geometry, motion, forces.normal, sheaves[number % 2], shaft);
        reaction = tip_reaction(geometry, motion, forces);
        return tip_action(c_, columns.frame, geometry, motion, forces);
    }

    /// Without friction where contacts are recorded: it is solved for apart from all else.
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
            return tip_forces<false, W>(c_.tip, geometry, motion, touching(number), phases, nullptr);
        }
    }

    /// 1 where a tip touches, else 0.
    [[nodiscard]] V touching(int number) const noexcept {
        alignas(64) double touching[W];
        for (std::size_t link = 0; link < W; ++link) touching[link] = (words_[link] >> (8 * number) & 0xffu) != 0 ? 1.0 : 0.0;
        return load<W>(touching);
    }

    // Where the record decides which tips touch.

    /// Above 0 where a link is so near its sheaves that its tips may touch; only there they do. A tip is as deep as a pin that is straight
    /// between flanks that are not tilted, give or take what pins and sheaves yield.
    void find_near(const Columns& columns) noexcept {
        constexpr double yielding = 5e-4;  // m
        const V* q = columns.q();
        const V first(c_.centre_distance), middle = q[link_layout<P>.x(End::rear, 0)] + q[link_layout<P>.x(End::front, 0)];
        const auto by_shaft = [&](double one, double other) { return select_greater<W>(first, middle, V(one), V(other)); };
        const SheaveMotion* motions = range_.sheaves;
        const V minus = by_shaft(motions[0].z, motions[2].z), plus = by_shaft(motions[1].z, motions[3].z);
        const V centre = by_shaft(0.0, c_.centre_distance);
        const double touching_radius = c_.tip.touching_radius - c_.tip.radius * c_.tip.sine;
        near_ = V(-1.0);
        for (const End end : {End::rear, End::front}) {
            const V x = q[link_layout<P>.x(end, 0)] - centre, y = q[link_layout<P>.y(end, 0)], z = q[link_layout<P>.z(end)];
            const V radial = c_.tip.sine * (touching_radius - sqrt(x * x + y * y)), length = c_.half_length + q[link_layout<P>.e(end)];
            const V beyond = larger<W>(length - (z - minus), length + (z - plus));
            near_ = larger<W>(radial + c_.tip.cosine * beyond + yielding, near_);
        }
        found_.fill(0);
        any_ = all_at_most<W>(near_, 0.0) ? 0 : 1;
        if (any_ == 0) words_.fill(0);
    }

    /// 1 where a tip touches, by its depth and its phase so far, else 0; notes the new phases.
    [[nodiscard]] V search(int number, const V& depth) noexcept {
        alignas(64) double bound[W], touches[W];
        for (std::size_t link = 0; link < W; ++link)
            bound[link] = (words_[link] >> (8 * number) & 0xffu) != 0 ? -contacts_.search()->release : 0.0;
        const V touching = select_greater<W>(near_, V(0.0), select_greater<W>(depth, load<W>(bound), V(1.0), V(0.0)), V(0.0));
        touching.copy_to(touches);
        for (std::size_t link = 0; link < W; ++link) found_[link] |= static_cast<std::uint32_t>(touches[link] != 0.0) << (8 * number);
        return touching;
    }

    void keep_phases() const noexcept {
        Phase* to = contacts_.search()->phases + tips_per_link * (range_.first + group_);
        for (int link = 0; link < count_; ++link)
            std::memcpy(to + tips_per_link * link, &words_[static_cast<std::size_t>(link)], sizeof words_[0]);
    }

    void check_limits(const Columns& columns, const V& shaft) const noexcept {
        TipSearch& search = *contacts_.search();
        const V* q = columns.q();
        const V x = 0.5 * (q[link_layout<P>.x(End::rear, 0)] + q[link_layout<P>.x(End::front, 0)]) - shaft * c_.centre_distance;
        const V y = 0.5 * (q[link_layout<P>.y(End::rear, 0)] + q[link_layout<P>.y(End::front, 0)]), square = x * x + y * y;
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
    const Phase* phases_;  ///< of the first lane's link
    int group_;            ///< first lane's link, from the range's first
    int count_;
    std::array<std::uint32_t, W> words_{};  ///< phases of each link, 0 beyond the last
    std::uint32_t any_ = 0;
    std::array<std::uint32_t, W> found_{};  ///< phases of each link, by a search
    V near_{0.0}, deepest_{0.0};            ///< find_near(); deepest touching tip of each link [m]
    const Contacts& contacts_;
};

/// `group` counts links from the range's first, and the pins behind them.
/// @tparam Contacts NoContacts, or ContactWriter: then accelerations go there instead of slopes
template <int P, int W, class Contacts = NoContacts>
class LanePass {
public:
    using V = Lanes<W>;
    using Columns = LinkColumns<P, W>;
    using Joints = JointForce<P, V>;
    static constexpr int size = link_layout<P>.link_size();
    static constexpr int block = link_layout<P>.link_block();

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
        columns.frame = link_frame<P>(columns.q(), columns.v());
    }

    /// Joints of the pins behind the links `here`, the first of which is `group`.
    [[nodiscard]] Joints joints_between(const Columns& earlier, const Columns& here, [[maybe_unused]] int group = 0) const noexcept {
        const auto& a = earlier.frame;
        const auto& b = here.frame;
        const JointFrames<V> frames(
            {before(a.tx, b.tx), before(a.ty, b.ty), before(a.inverse_length, b.inverse_length), before(a.turning, b.turning)}, b);
        const Difference<P, V> gap = opening(earlier.q(), here.q()), rate = opening(earlier.v(), here.v());
        const auto& points = c_.joint_points;
        [[maybe_unused]] const auto rows = contacts_.rows(group, std::min(W, links_ - group));
        if constexpr (Contacts::relative) contacts_.gaps(rows, contacts_.components().joint_gap(), rate);
        JointTerms<P, W> total;
        V worst(0.0);
        const auto pressed = [&](int point) noexcept {
            const AxisPoint<P, W> at_point(points, point);
            const V weight(points.weight[static_cast<std::size_t>(point)]);
            const auto motion = joint_motion<P, W>(c_.joint, frames, at_point, gap, rate);
            worst = larger<W>(beyond_clearance<W>(c_.joint, frames, motion), worst);
            if constexpr (Contacts::recorded) {
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
    [[nodiscard]] V inner(int group, int count, const Columns& columns, V* f) const noexcept {
        const V moment = inner_elasticity<P, false>(c_, kinds(group, count), columns.frame, columns.q(), columns.v(), f, nullptr);
        if (!c_.longer.empty()) add_lengths<P, false, V>(c_, lengths(group, count), columns.q(), f, nullptr);
        return moment;
    }

    void tips(int group, int count, const Columns& columns, V* f, V& moment, LinkLoad* loads) const noexcept {
        const int first = range_.first + group;
        if ((c_.layout.pulley_size | static_cast<int>(c_.eccentric)) == 4) {  // an eccentric sheave also moves across its axis
            LaneTips<P, W, true, Contacts>(c_, range_, first, count, contacts_).add(columns, f, moment, loads + group);
        } else {
            LaneTips<P, W, false, Contacts>(c_, range_, first, count, contacts_).add(columns, f, moment, loads + group);
        }
    }

    /// Slopes of links group … from their forces, which are lost.
    void solve(int group, int count, V* f) const noexcept {
        multiply<2 * (P + 1), 2>(model_.inertia().lateral, f);
        multiply<4, 1>(model_.inertia().axial, f + 4 * (P + 1));
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
        V moment = inner(group, count, columns, f.data());
        plates(kinds(group, count), columns, f.data(), group, count);
        if constexpr (Contacts::recorded) contacts_.frame(group, count, columns.frame);
        if constexpr (Contacts::relative) contacts_.velocities(group, count, columns.v());
        rear.on_front.apply(-1.0, f.data(), End::rear);
        add_front(rear, next, f.data());
        moment += rear.after + after(rear.before, next.before);
        tips(group, count, columns, f.data(), moment, loads_);
        add_moment<P>(columns.frame, moment, f.data());
        solve(group, count, f.data());
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

    void plates(const KindLanes<W>& kind, const Columns& columns, V* f, [[maybe_unused]] int group = 0,
                [[maybe_unused]] int count = 0) const noexcept {
        const Difference<P, V> d(columns.q(), End::front, columns.q(), End::rear), rate(columns.v(), End::front, columns.v(), End::rear);
        const auto& points = c_.plates;
        [[maybe_unused]] const auto rows = contacts_.rows(group, count);
        if constexpr (Contacts::relative) contacts_.gaps(rows, contacts_.components().plate_gap(), rate);
        Difference<P, V> pull;
        for (int first = 0; first < points.count; first += points.width) {
            const auto pulled = [&](int plate) noexcept {
                const std::size_t j = static_cast<std::size_t>(first + plate);
                const AxisPoint<P, W> place(points, first + plate);
                const auto stretch = plate_stretch<P, W>(c_, kind.free_length, place, points.weight[j], points.damping[j], d, rate);
                if constexpr (Contacts::recorded) {
                    contacts_.plate(rows, first + plate, stretch.tension);
                    return plate_terms<P, W, false>(place, points.weight[j], points.damping[j], stretch, Zero{});
                } else {
                    return plate_terms<P, W, false>(place, points.weight[j], points.damping[j], stretch, plate_slide(c_, stretch));
                }
            };
            std::array<V, plate_rows<P, false>> total;
            pairwise_sum<W>(std::min(points.width, points.count - first), points.width, pulled, total);
            pull.add(total.data());
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
            d.x[m] = front_minus_rear(link_layout<P>.x(End::front, m), link_layout<P>.x(End::rear, m));
            d.y[m] = front_minus_rear(link_layout<P>.y(End::front, m), link_layout<P>.y(End::rear, m));
        }
        d.z = front_minus_rear(link_layout<P>.z(End::front), link_layout<P>.z(End::rear));
        d.e = front_minus_rear(link_layout<P>.e(End::front), link_layout<P>.e(End::rear));
        return d;
    }

    /// Joints of the front pins: those behind the links that follow.
    static void add_front(const Joints& rear, const Joints& next, V* f) noexcept {
        const auto& a = rear.on_front;
        const auto& b = next.on_front;
        for (int m = 0; m <= P; ++m) {
            f[link_layout<P>.x(End::front, m)] += after(a.x[m], b.x[m]);
            f[link_layout<P>.y(End::front, m)] += after(a.y[m], b.y[m]);
        }
        f[link_layout<P>.z(End::front)] += after(a.z, b.z);
        f[link_layout<P>.e(End::front)] += after(a.e, b.e);
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
