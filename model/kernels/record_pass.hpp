#pragma once
/// Records the contacts of a range of links, and their accelerations by everything but friction, which is all that a step of a leapfrog
/// takes from the chain's forces. Both are floats in the end. So differences between coordinates are taken in doubles, and what is made of
/// them are floats, for twice as many links at once. Nothing large is left in them to drown a stretch or a depth (µm): a plate is a little
/// longer than it was made, and the gap of a joint is that between the arcs' vertices. Tips are in doubles.

#include <algorithm>
#include <array>

#include "model/chain/chain_model.hpp"
#include "model/force/inner.hpp"
#include "model/force/joint.hpp"
#include "model/force/plates.hpp"
#include "model/kernels/lane_tips.hpp"

namespace cvtflow::model {
namespace {

/// @tparam N doubles in a vector of the processor; links in a group are twice as many
template <int N>
class RecordPass {
public:
    static constexpr int W = singles<2 * N>, links_of_group = 2 * N, size = link_layout.link_size(), block = link_layout.link_block();
    using V = Lanes<W>;
    using Exact = std::array<LinkColumns<N>, 2>;  ///< both halves of a group

    RecordPass(const FrictionOperator& friction, const ChainRange& range, const ContactDrift& drift, const ContactRecord& to,
               LinkLoad* loads, TipSearch* search) noexcept
        : c_(friction.chain().coefficients()),
          numbers_(friction.numbers()),
          range_(range),
          links_(range.last - range.first),
          to_(to),
          loads_(loads),
          tips_(friction, range, drift, to, search),
          joint_(between_vertices(c_.joint)) {}

    void run() const noexcept {
        std::array<Exact, 2> columns;  // of this group and the one before, taking turns
        std::array<LinkFrameOf<V>, 2> frames;
        std::array<JointForce<V>, 2> joints;  // of the pins behind their links
        read(-N, columns[1][1]);
        put_frame_before(columns[1][1].frame);
        for (int group = 0; group <= links_; group += links_of_group) {
            const auto now = static_cast<std::size_t>(group / links_of_group % 2), earlier = now ^ 1;
            read(group, columns[now][0]);
            read(group + N, columns[now][1]);
            frames[now] = rounded<LinkFrameOf<V>>(columns[now][0].frame, columns[now][1].frame);
            put_frames(group, frames[now]);
            joints[now] = joints_between(columns[earlier][1], columns[now], group);
            if (group > 0) finish(group - links_of_group, columns[earlier], frames[earlier], joints[earlier], joints[now]);
        }
        const auto last = static_cast<std::size_t>(links_ / links_of_group % 2);
        if (links_ % links_of_group != 0)
            finish(links_ / links_of_group * links_of_group, columns[last], frames[last], joints[last], joints[last]);
    }

private:
    using Rows = GroupRows<W, float>;
    using Joint = ContactComponents::Joint;

    [[nodiscard]] static JointCoefficients between_vertices(JointCoefficients joint) noexcept {
        joint.reach = 0.5 * joint.diameter;
        joint.square_excess = 0.0;
        return joint;
    }

    /// Rows of a struct of lanes, those of both halves side by side. By std::bit_cast the default's step takes 4.5 % more instructions.
    template <class Rounded, class Halves>
    [[nodiscard, gnu::always_inline]] static Rounded rounded(const Halves& low, const Halves& high) noexcept {
        constexpr std::size_t rows = sizeof(Halves) / sizeof(Lanes<N>);
        static_assert(sizeof(Rounded) == rows * sizeof(V));
        const auto *first = reinterpret_cast<const Lanes<N>*>(&low), *second = reinterpret_cast<const Lanes<N>*>(&high);
        Rounded to;
        auto* row = reinterpret_cast<V*>(&to);
        for (std::size_t k = 0; k < rows; ++k) row[k] = narrow<2 * N>(Lanes<2 * N>(first[k], second[k]));
        return to;
    }

    /// Links group … group + N - 1; lanes outside the window repeat its ends.
    void read(int group, LinkColumns<N>& columns) const noexcept { read_links<N>(range_.window, group, links_, columns); }

    /// Rows of the links group, …, and of that many behind the range.
    [[nodiscard]] Rows rows_of(FloatColumns& columns, int group, int behind) const noexcept {
        const int count = range_.room ? links_of_group : std::min(links_of_group, links_ + behind - group);
        return {columns.at(0, range_.first + group + range_.shift), columns.stride(), count};
    }

    /// Writes the frame of the link before the range.
    void put_frame_before(const LinkFrameOf<Lanes<N>>& frame) const noexcept {
        const int column = range_.first - 1 + range_.shift;
        *to_.field.columns.at(ContactComponents::frame_x, column) = static_cast<float>(frame.tx[N - 1]);
        *to_.field.columns.at(ContactComponents::frame_y, column) = static_cast<float>(frame.ty[N - 1]);
        *to_.field.columns.at(ContactComponents::inverse_length, column) = static_cast<float>(frame.inverse_length[N - 1]);
    }
    void put_frames(int group, const LinkFrameOf<V>& frame) const noexcept {
        const Rows to = rows_of(to_.field.columns, group, 1);
        to.put(ContactComponents::frame_x, frame.tx);
        to.put(ContactComponents::frame_y, frame.ty);
        to.put(ContactComponents::inverse_length, frame.inverse_length);
    }

    /// Joints of the pins behind links, in a frame that turns with the mean of both links, so that what slides (mm/s) does not drown in
    /// what turns (m/s); gaps are those between the arcs' vertices.
    struct JointPlace {
        JointFrames<Lanes<N>> frames;
        Difference<Lanes<N>> gap, rate;

        JointPlace(const LinkColumns<N>& earlier, const LinkColumns<N>& here, double to_vertex) noexcept
            : frames(frame_before(earlier.frame, here.frame), here.frame),
              gap(opening(earlier.q(), here.q())),
              rate(opening(earlier.v(), here.v())) {
            const Lanes<N> turning = 0.5 * (frames.before.turning + frames.after.turning);
            frames.before.turning -= turning;
            frames.after.turning -= turning;
            for (int m = 0; m < axis_terms; ++m) {
                rate.x[m] += turning * gap.y[m];
                rate.y[m] -= turning * gap.x[m];
            }
            gap.x[0] -= to_vertex * frames.sx;
            gap.y[0] -= to_vertex * frames.sy;
        }
    };

    [[nodiscard]] JointForce<V> joints_between(const LinkColumns<N>& earlier, const Exact& here, int group) const noexcept {
        const double to_vertex = joint_.reach - joint_.arm;
        const JointPlace low(earlier, here[0], to_vertex), high(here[0], here[1], to_vertex);
        const auto frames = rounded<JointFrames<V>>(low.frames, high.frames);
        const auto gap = rounded<Difference<V>>(low.gap, high.gap), rate = rounded<Difference<V>>(low.rate, high.rate);
        const Rows to = rows_of(to_.field.columns, group, 1);
        to.put(to_.field.components.joint_gap(), rate.z);
        to.put(to_.field.components.joint_gap() + 1, rate.e);
        const auto& points = numbers_.joint_points;
        JointTerms<W> total;
        V worst(0.0);
        const auto pressed = [&](int point) noexcept {
            const AxisPoint<W> at_point(points, point);
            const auto motion = joint_motion<W>(joint_, frames, at_point, gap, rate);
            worst = larger<W>(beyond_clearance<W>(joint_, frames, motion), worst);
            const V normal = normal_force<W>(joint_, V(points.weight[static_cast<std::size_t>(point)]), motion).normal;
            put_point(to, point, motion, normal);
            return rolling_terms<W>(joint_, frames, at_point, motion, normal, Zero{});
        };
        pairwise_sum<W>(points.count, points.width, pressed, total);
        JointForce<V> out;
        out.add(total.data());
        if (!all_at_most<W>(worst, 0.0)) hold(frames, gap, rate, worst, out);
        return out;
    }

    void put_point(const Rows& to, int point, const JointMotion<W>& m, const V& normal) const noexcept {
        const int row = to_.field.components.joint(point);
        to.put(row + Joint::normal_x, m.nx);
        to.put(row + Joint::normal_y, m.ny);
        to.put(row + Joint::lever_before, m.lever_before);
        to.put(row + Joint::lever_after, m.lever_after);
        to.put(row + Joint::friction_limit, joint_.friction.coefficient * normal);
        to.put(to_.field.components.sliding(point), m.slip);
    }

    /// The clearance of plate openings, in joints that exceed it somewhere: where `worst` is above 0.
    [[gnu::noinline]] void hold(const JointFrames<V>& frames, const Difference<V>& gap, const Difference<V>& rate, const V& worst,
                                JointForce<V>& out) const noexcept {
        const auto& points = numbers_.joint_points;
        JointTerms<W> total;
        NoBooks books;
        const auto held = [&](int point) noexcept {
            const AxisPoint<W> at_point(points, point);
            const V weight(points.weight[static_cast<std::size_t>(point)]);
            return clearance_force<W>(joint_, frames, at_point, weight, joint_motion<W>(joint_, frames, at_point, gap, rate), books);
        };
        pairwise_sum<W>(points.count, points.width, held, total);
        for (V& row : total) row = select_greater<W>(worst, V(0.0), row, V(0.0));
        out.add(total.data());
    }

    /// Accelerations of links group … from their states, the joints behind them and those behind the links that follow.
    void finish(int group, const Exact& columns, const LinkFrameOf<V>& frame, const JointForce<V>& rear,
                const JointForce<V>& next) const noexcept {
        const auto state = rounded<std::array<V, 2 * size>>(columns[0].state, columns[1].state);
        const V *q = state.data(), *v = q + size;
        const KindLanes<N> low(c_, range_.first + group, links_ - group), high = kinds_behind(group);
        const auto kind = rounded<KindLanes<W>>(low, high);
        std::array<V, size> f;
        for (V& row : f) row = V(0.0);
        NoBooks books;
        V moment = inner_elasticity(c_, kind, frame, q, v, f.data(), books);
        if (!c_.longer.empty()) add_longer(group, q, f.data());
        plates(group, columns, low.free_length, high.free_length, frame, f.data());
        moment += add_joints<W>(rear, next, f.data());
        add_tips(group, columns, f.data(), moment);
        add_moment(frame, moment, f.data());
        accelerate<W>(numbers_.inverse, frame, f.data());
        const Rows to = rows_of(to_.frictionless, group, 0);
        for (int row = 0; row < size; ++row) to.put(row, f[static_cast<std::size_t>(row)]);
        velocities(group, columns);
    }

    [[nodiscard]] KindLanes<N> kinds_behind(int group) const noexcept {
        const int first = std::min(group + N, links_ - 1);
        return KindLanes<N>(c_, range_.first + first, links_ - first);
    }

    void add_longer(int group, const V* q, V* f) const noexcept {
        const int behind = std::min(group + N, links_ - 1);
        NoBooks books;
        const auto longer = rounded<std::array<V, 2>>(lengths_of<N>(c_, range_.first + group, links_ - group),
                                                      lengths_of<N>(c_, range_.first + behind, links_ - behind));
        add_lengths(c_, longer, q, f, books);
    }

    /// How a pack is stretched, modes along the link and across it: of the mean along it what exceeds its free length.
    struct Stretch {
        V along[axis_terms], across[axis_terms], z, e;

        Stretch(const Difference<V>& d, const LinkFrameOf<V>& frame) noexcept : z(d.z), e(d.e) {
            for (int m = 0; m < axis_terms; ++m) {
                along[m] = d.x[m] * frame.tx + d.y[m] * frame.ty;
                across[m] = d.y[m] * frame.tx - d.x[m] * frame.ty;
            }
        }
    };

    void plates(int group, const Exact& columns, const Lanes<N>& low_length, const Lanes<N>& high_length, const LinkFrameOf<V>& frame,
                V* f) const noexcept {
        const auto apart = [](const Lanes<N>* c) { return Difference<Lanes<N>>(c, End::front, c, End::rear); };
        const Difference<Lanes<N>> low = apart(columns[0].q()), high = apart(columns[1].q());
        const auto longer = [](const Difference<Lanes<N>>& d, const LinkFrameOf<Lanes<N>>& t, const Lanes<N>& free_length) {
            return std::array{d.x[0] * t.tx + d.y[0] * t.ty - free_length, free_length};
        };
        const auto lengths =
            rounded<std::array<V, 2>>(longer(low, columns[0].frame, low_length), longer(high, columns[1].frame, high_length));
        Stretch d(rounded<Difference<V>>(low, high), frame);
        d.along[0] = lengths[0], d.across[0] = V(0.0);
        const Stretch rate(rounded<Difference<V>>(apart(columns[0].v()), apart(columns[1].v())), frame);
        const Rows to = rows_of(to_.field.columns, group, 0);
        to.put(to_.field.components.plate_gap(), rate.z);
        to.put(to_.field.components.plate_gap() + 1, rate.e);
        pull_plates(to, d, rate, lengths[1], frame, f);
    }

    /// Modes of even and of odd order summed apart, so that they serve the plates at ξ and at -ξ.
    struct Halves {
        V even, odd;
        Halves(const V* modes, const AxisPoint<W>& at) noexcept
            : even(modes[0] + at.basis[2] * modes[2]), odd(at.basis[1] * modes[1] + at.basis[3] * modes[3]) {}
        [[nodiscard]] V at(bool mirrored) const noexcept { return mirrored ? even - odd : even + odd; }
    };

    /// Force of a plate on the front half, along the link and across it and along z.
    struct Pull {
        V along, across, z;
    };

    void pull_plates(const Rows& to, const Stretch& d, const Stretch& rate, const V& free_length, const LinkFrameOf<V>& frame,
                     V* f) const noexcept {
        const auto& points = numbers_.plates;
        static_assert(axis_terms == 4);
        V along[axis_terms], across[axis_terms], z(0.0), e(0.0);
        for (int m = 0; m < axis_terms; ++m) along[m] = across[m] = V(0.0);
        const auto spread = [](const AxisPoint<W>& at, const V& sum, const V& difference, V* modes) {
            modes[0] += sum;
            modes[1] += at.basis[1] * difference;
            modes[2] += at.basis[2] * sum;
            modes[3] += at.basis[3] * difference;
        };
        for (int plate = points.count / 2; plate < points.count; ++plate) {
            const int opposite = points.count - 1 - plate;
            const AxisPoint<W> at(points, plate);
            const Halves halves[4] = {{d.along, at}, {d.across, at}, {rate.along, at}, {rate.across, at}};
            const auto pull = [&](int number, bool mirrored) {
                const V tilt = at.xi * d.e, tilting = at.xi * rate.e;
                return pull_of(to, number, free_length, halves[0].at(mirrored), halves[1].at(mirrored), mirrored ? d.z - tilt : d.z + tilt,
                               halves[2].at(mirrored), halves[3].at(mirrored), mirrored ? rate.z - tilting : rate.z + tilting);
            };
            const Pull a = pull(plate, false);
            Pull b{V(0.0), V(0.0), V(0.0)};
            if (opposite != plate) b = pull(opposite, true);
            spread(at, a.along + b.along, a.along - b.along, along);
            spread(at, a.across + b.across, a.across - b.across, across);
            z += a.z + b.z;
            e += at.xi * (a.z - b.z);
        }
        Difference<V> force;
        for (int m = 0; m < axis_terms; ++m) {
            force.x[m] = along[m] * frame.tx - across[m] * frame.ty;
            force.y[m] = along[m] * frame.ty + across[m] * frame.tx;
        }
        force.z = z, force.e = e;
        force.apply(1.0, f, End::front);
        force.apply(-1.0, f, End::rear);
    }

    /// A plate of free length ℓ that is longer by x and across by y and z: |(ℓ + x, y, z)| - ℓ = x + (y² + z²)/(|…| + ℓ + x).
    [[nodiscard, gnu::always_inline]] Pull pull_of(const Rows& to, int plate, const V& free_length, const V& x, const V& y, const V& z,
                                                   const V& vx, const V& vy, const V& vz) const noexcept {
        const auto j = static_cast<std::size_t>(plate);
        const V whole = free_length + x, square = y * y + z * z, length = sqrt(whole * whole + square);
        const Reciprocals<W> inverse(length, length + whole);
        const V stretching = (whole * vx + y * vy + z * vz) * inverse.first;
        const V tension = numbers_.plates.weight[j] * (x + square * inverse.second) + numbers_.plates.damping[j] * stretching;
        to.put(to_.field.components.plate(plate), c_.plate_friction.coefficient * positive_part<W>(tension));
        const V pull = -tension * inverse.first;
        return {pull * whole, pull * y, pull * z};
    }

    void add_tips(int group, const Exact& columns, V* f, V& moment) const noexcept {
        std::array<std::array<Lanes<N>, size + 1>, 2> share{};  // force, moment
        bool any = false;
        for (std::size_t half = 0; half < 2; ++half) {
            const int first = group + static_cast<int>(half) * N;
            if (first < links_)
                any |= model::add_tips<N>(c_, range_, first, links_ - first, tips_, columns[half], share[half].data(), share[half][size],
                                          loads_);
        }
        if (!any) return;
        const auto both = rounded<std::array<V, size + 1>>(share[0], share[1]);
        for (std::size_t k = 0; k < size; ++k) f[k] += both[k];
        moment += both[size];
    }

    /// Velocities at the step's beginning, counted from those passed over.
    void velocities(int group, const Exact& columns) const noexcept {
        constexpr int rows = (size + N - 1) / N * N;  // the last of a block: velocities, and some coordinates before them
        std::array<std::array<Lanes<N>, size>, 2> from_these;
        for (std::size_t half = 0; half < 2; ++half) {
            std::array<const double*, N> from;
            for (int lane = 0; lane < N; ++lane) {
                const int link = std::min(group + static_cast<int>(half) * N + lane, links_ - 1);
                from[static_cast<std::size_t>(lane)] = to_.states + (link + 1) * block - rows;
            }
            std::array<Lanes<N>, rows> begin;
            load_rows<N, rows>(from, begin.data());
            for (std::size_t row = 0; row < size; ++row) from_these[half][row] = begin[rows - size + row] - columns[half].v()[row];
        }
        const auto both = rounded<std::array<V, size>>(from_these[0], from_these[1]);
        const Rows to = rows_of(to_.velocity, group, 0);
        for (int row = 0; row < size; ++row) to.put(row, both[static_cast<std::size_t>(row)]);
    }

    const Coefficients& c_;
    const FrictionNumbers& numbers_;
    const ChainRange& range_;
    int links_;
    const ContactRecord& to_;
    LinkLoad* loads_;
    ContactWriter<N> tips_;
    JointCoefficients joint_;  ///< for gaps between the arcs' vertices
};

}  // namespace
}  // namespace cvtflow::model
