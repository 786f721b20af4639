#pragma once
/// Links side by side: lanes run over as many links as the processor's vectors hold. Every lane does the same in the same order (sums over
/// points and tips in fixed trees, over plates in pairs), so that it gives the same bits whatever its neighbours are.

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "model/basis/lanes.hpp"
#include "model/force/inner.hpp"
#include "model/force/joint.hpp"
#include "model/force/link_frame.hpp"
#include "model/force/plates.hpp"
#include "model/force/sheave_motion.hpp"
#include "model/machine/coefficients.hpp"
#include "model/machine/held_links.hpp"
#include "model/machine/link_inertia.hpp"

namespace cvtflow::model {
namespace {

/// Rows of numbers of W links: number j of link k comes from from[k][j] and goes to lane k of rows[j]. `count` is a multiple of W.
template <int W, int count>
inline void load_rows(const std::array<const double*, W>& from, Lanes<W>* rows) noexcept {
    static_assert(count % W == 0);
    for (int begin = 0; begin < count; begin += W) {
        for (int lane = 0; lane < W; ++lane) rows[begin + lane] = load<W>(from[static_cast<std::size_t>(lane)] + begin);
        transpose<W>(rows + begin);
    }
}

/// Rows begin … begin + height - 1 of store_rows(), height at most W. Loops over constants are written as packs: GCC 12 does not unroll
/// them.
template <int W, int begin, int height>
inline void store_block(const Lanes<W>* rows, const std::array<double*, W>& to, int links) noexcept {
    std::array<Lanes<W>, W> block;
    [&]<std::size_t... row>(std::index_sequence<row...>) {
        ((block[row] = row < height ? rows[begin + std::min<std::size_t>(row, height - 1)] : Lanes<W>(0.0)), ...);
    }
    (std::make_index_sequence<W>());
    transpose<W>(block.data());
    if constexpr (height == W) {
        if (links == W) {  // from registers
            [&]<std::size_t... link>(std::index_sequence<link...>) { (block[link].copy_to(to[link] + begin), ...); }
            (std::make_index_sequence<W>());
            return;
        }
    }
    constexpr std::size_t most = height == W ? W - 1 : W;
    for (std::size_t link = 0; link < most && link < static_cast<std::size_t>(links); ++link)
        std::memcpy(to[link] + begin, &block[link], height * sizeof(double));
}

/// The other way round, to the first `links` of `to`, at most W.
template <int W, int count>
inline void store_rows(const Lanes<W>* rows, const std::array<double*, W>& to, int links) noexcept {
    [&]<std::size_t... part>(std::index_sequence<part...>) {
        (store_block<W, static_cast<int>(part) * W, std::min(W, count - static_cast<int>(part) * W)>(rows, to, links), ...);
    }
    (std::make_index_sequence<(count + W - 1) / W>());
}

/// Sum of terms_at(0) … terms_at(count - 1) in the tree of sums() over `width` lanes: pairs that lie width/2 apart first. A pair is added
/// up in registers; what is finished beside it waits in memory, a branch per level. Missing terms count as -0, which changes no bit.
/// @param width a power of two ≥ count, at most 16
template <int W, std::size_t rows, class Body>
[[gnu::always_inline]] inline void pairwise_sum(int count, int width, const Body& terms_at, std::array<Lanes<W>, rows>& total) noexcept {
    std::array<std::array<Lanes<W>, rows>, 3> finished;
    const int pairs = std::max(width / 2, 1);
    for (int pair = 0, point = 0; pair < pairs; ++pair) {
        std::array<Lanes<W>, rows> sum;
        for (Lanes<W>& row : sum) row = Lanes<W>(-0.0);
        for (int each = point; each < count; each += pairs) {
            const auto terms = terms_at(each);
            for (std::size_t row = 0; row < rows; ++row) sum[row] += terms[row];
        }
        std::size_t level = 0;
        for (; (pair >> level & 1) != 0; ++level) {
            for (std::size_t row = 0; row < rows; ++row) sum[row] = finished[level][row] + sum[row];
        }
        std::array<Lanes<W>, rows>& to = pair + 1 == pairs ? total : finished[level];
        for (std::size_t row = 0; row < rows; ++row) to[row] = sum[row];
        int bit = pairs / 2;  // next in the order of reversed bits
        for (; (point & bit) != 0; bit /= 2) point -= bit;
        point += bit;
    }
}

/// States of W links.
template <int W>
struct LinkColumns {
    static constexpr int size = link_layout.link_size();
    std::array<Lanes<W>, 2 * size> state;  ///< [q | v]
    LinkFrameOf<Lanes<W>> frame;

    [[nodiscard]] const Lanes<W>* q() const noexcept { return state.data(); }
    [[nodiscard]] const Lanes<W>* v() const noexcept { return state.data() + size; }
};

/// Links group … group + W - 1 of a range; lanes outside the window repeat its ends.   @param window as of ChainRange   @param links of the
/// range
template <int W>
inline void read_links(const double* window, int group, int links, LinkColumns<W>& columns) noexcept {
    constexpr int block = link_layout.link_block();
    std::array<const double*, W> from;
    for (int lane = 0; lane < W; ++lane) from[static_cast<std::size_t>(lane)] = window + std::clamp(group + lane + 1, 0, links + 1) * block;
    load_rows<W, block>(from, columns.state.data());
    columns.frame = link_frame(columns.q(), columns.v());
}

/// Numbers that differ between links, in the order of LinkKind.
template <int W>
struct KindLanes {
    struct SpringLanes {
        Lanes<W> stiffness, damping;
    };
    Lanes<W> free_length, inverse_length;
    SpringLanes bending, shear, torsion;

    KindLanes() = default;
    /// @param first of W links, `count` of them different
    KindLanes(const Coefficients& c, int first, int count) noexcept {
        constexpr int numbers = sizeof(LinkKind) / sizeof(double);
        std::array<const double*, W> from;
        for (int lane = 0; lane < W; ++lane)
            from[static_cast<std::size_t>(lane)] = reinterpret_cast<const double*>(&c.kind(first + std::min(lane, count - 1)));
        std::array<Lanes<W>, numbers> rows;
        static_assert(sizeof *this == sizeof rows);
        load_rows<W, numbers>(from, rows.data());
        std::memcpy(static_cast<void*>(this), rows.data(), sizeof rows);
    }
};

// Numbers of two groups of links, rounded to floats side by side.

template <int N>
[[nodiscard, gnu::always_inline]] inline Lanes<singles<2 * N>> rounded(const Lanes<N>& low, const Lanes<N>& high) noexcept {
    return narrow<2 * N>(Lanes<2 * N>(low, high));
}
template <int N, std::size_t count>
[[nodiscard, gnu::always_inline]] inline std::array<Lanes<singles<2 * N>>, count> rounded(
    const std::array<Lanes<N>, count>& low, const std::array<Lanes<N>, count>& high) noexcept {
    std::array<Lanes<singles<2 * N>>, count> to;
    for (std::size_t k = 0; k < count; ++k) to[k] = rounded(low[k], high[k]);
    return to;
}
template <int N>
[[nodiscard, gnu::always_inline]] inline KindLanes<singles<2 * N>> rounded(const KindLanes<N>& low, const KindLanes<N>& high) noexcept {
    const auto spring = [&](auto member) {
        return typename KindLanes<singles<2 * N>>::SpringLanes{rounded((low.*member).stiffness, (high.*member).stiffness),
                                                               rounded((low.*member).damping, (high.*member).damping)};
    };
    KindLanes<singles<2 * N>> to;
    to.free_length = rounded(low.free_length, high.free_length), to.inverse_length = rounded(low.inverse_length, high.inverse_length);
    to.bending = spring(&KindLanes<N>::bending), to.shear = spring(&KindLanes<N>::shear), to.torsion = spring(&KindLanes<N>::torsion);
    return to;
}
template <int N>
[[nodiscard, gnu::always_inline]] inline LinkFrameOf<Lanes<singles<2 * N>>> rounded(const LinkFrameOf<Lanes<N>>& low,
                                                                                    const LinkFrameOf<Lanes<N>>& high) noexcept {
    return {rounded(low.tx, high.tx), rounded(low.ty, high.ty), rounded(low.inverse_length, high.inverse_length),
            rounded(low.turning, high.turning)};
}
template <int N>
[[nodiscard, gnu::always_inline]] inline Difference<Lanes<singles<2 * N>>> rounded(const Difference<Lanes<N>>& low,
                                                                                   const Difference<Lanes<N>>& high) noexcept {
    Difference<Lanes<singles<2 * N>>> to;
    for (int m = 0; m < axis_terms; ++m) to.x[m] = rounded(low.x[m], high.x[m]), to.y[m] = rounded(low.y[m], high.y[m]);
    to.z = rounded(low.z, high.z), to.e = rounded(low.e, high.e);
    return to;
}
template <int N>
[[nodiscard, gnu::always_inline]] inline JointPlace<Lanes<singles<2 * N>>> rounded(const JointPlace<Lanes<N>>& low,
                                                                                   const JointPlace<Lanes<N>>& high) noexcept {
    const JointFrames<Lanes<N>>&a = low.frames, &b = high.frames;
    JointPlace<Lanes<singles<2 * N>>> to;
    to.frames.before = rounded(a.before, b.before), to.frames.after = rounded(a.after, b.after);
    to.frames.sx = rounded(a.sx, b.sx), to.frames.sy = rounded(a.sy, b.sy);
    to.frames.cx = rounded(a.cx, b.cx), to.frames.cy = rounded(a.cy, b.cy);
    to.gap = rounded(low.gap, high.gap), to.rate = rounded(low.rate, high.rate);
    return to;
}
template <int N>
[[nodiscard, gnu::always_inline]] inline PackPlace<Lanes<singles<2 * N>>> rounded(const PackPlace<Lanes<N>>& low,
                                                                                  const PackPlace<Lanes<N>>& high) noexcept {
    return {rounded(low.apart, high.apart), rounded(low.longer, high.longer), rounded(low.free_length, high.free_length)};
}

/// The lane before each lane; the first one's is the last of `earlier`.
template <int W>
[[nodiscard]] inline Lanes<W> before(const Lanes<W>& earlier, const Lanes<W>& here) noexcept {
    return slide<W, lane_count<W> - 1>(earlier, here);
}
/// The lane after each lane; the last one's is the first of `later`.
template <int W>
[[nodiscard]] inline Lanes<W> after(const Lanes<W>& here, const Lanes<W>& later) noexcept {
    return slide<W, 1>(here, later);
}

/// Frames of the links before.
template <int W>
[[nodiscard]] inline LinkFrameOf<Lanes<W>> frame_before(const LinkFrameOf<Lanes<W>>& earlier, const LinkFrameOf<Lanes<W>>& here) noexcept {
    return {before<W>(earlier.tx, here.tx), before<W>(earlier.ty, here.ty), before<W>(earlier.inverse_length, here.inverse_length),
            before<W>(earlier.turning, here.turning)};
}

/// Front halves of the links before, less the rear halves of links. @param earlier, here coordinates or velocities of groups
template <int W>
[[nodiscard]] inline Difference<Lanes<W>> opening(const Lanes<W>* earlier, const Lanes<W>* here) noexcept {
    const auto front_minus_rear = [&](int front, int rear) { return before<W>(earlier[front], here[front]) - here[rear]; };
    Difference<Lanes<W>> d;
    for (int m = 0; m < axis_terms; ++m) {
        d.x[m] = front_minus_rear(link_layout.x(End::front, m), link_layout.x(End::rear, m));
        d.y[m] = front_minus_rear(link_layout.y(End::front, m), link_layout.y(End::rear, m));
    }
    d.z = front_minus_rear(link_layout.z(End::front), link_layout.z(End::rear));
    d.e = front_minus_rear(link_layout.e(End::front), link_layout.e(End::rear));
    return d;
}

/// Adds the forces of the joints of the rear pins of links, and of those that follow; returns their moments on the links.
/// @param next joints of the next group
template <int W>
[[nodiscard]] inline Lanes<W> add_joints(const JointForce<Lanes<W>>& rear, const JointForce<Lanes<W>>& next, Lanes<W>* f) noexcept {
    rear.on_front.apply(-1.0, f, End::rear);
    const Difference<Lanes<W>>&a = rear.on_front, &b = next.on_front;
    for (int m = 0; m < axis_terms; ++m) {
        f[link_layout.x(End::front, m)] += after<W>(a.x[m], b.x[m]);
        f[link_layout.y(End::front, m)] += after<W>(a.y[m], b.y[m]);
    }
    f[link_layout.z(End::front)] += after<W>(a.z, b.z);
    f[link_layout.e(End::front)] += after<W>(a.e, b.e);
    return rear.after + after<W>(rear.before, next.before);
}

/// λ of both pins of links, W of them, `count` different.
template <int W>
[[nodiscard]] inline std::array<Lanes<W>, 2> lengths_of(const Coefficients& c, int first, int count) noexcept {
    alignas(64) double longer[2][W];
    for (int lane = 0; lane < W; ++lane) {
        const std::array<double, 2> of_link = lengths_at(c, first + std::min(lane, count - 1));
        for (std::size_t end = 0; end < 2; ++end) longer[end][lane] = of_link[end];
    }
    return {load<W>(longer[0]), load<W>(longer[1])};
}

/// One of the two sheaves of each link's pulley, in the order of SheaveMotion.
template <int W>
struct SheaveMotionLanes {
    Lanes<W> x, y, z, tilt_x, tilt_y, vx, vy, vz, spin_x, spin_y, spin_z;
};

/// The two sheaves of every link's pulley; returns the shafts' numbers. @param motions of all four
template <int W>
[[nodiscard]] inline Lanes<W> pulleys_of(const Coefficients& c, const SheaveMotion* motions, const LinkColumns<W>& columns,
                                         std::array<SheaveMotionLanes<W>, 2>& sheaves) noexcept {
    using V = Lanes<W>;
    const V middle = columns.state[static_cast<std::size_t>(link_layout.x(End::rear, 0))] +
                     columns.state[static_cast<std::size_t>(link_layout.x(End::front, 0))];
    const auto by_shaft = [&](double first, double second) { return select_greater<W>(V(c.centre_distance), middle, V(first), V(second)); };
    constexpr std::size_t numbers = sizeof(SheaveMotion) / sizeof(double);
    for (std::size_t side = 0; side < 2; ++side) {
        std::array<double, numbers> first, second;
        std::memcpy(first.data(), &motions[side], sizeof first);
        std::memcpy(second.data(), &motions[2 + side], sizeof second);
        std::array<V, numbers> rows;
        static_assert(sizeof rows == sizeof sheaves[side]);
        for (std::size_t k = 0; k < numbers; ++k) rows[k] = by_shaft(first[k], second[k]);
        std::memcpy(static_cast<void*>(&sheaves[side]), rows.data(), sizeof rows);
    }
    return by_shaft(0.0, 1.0);
}

/// Product of the inverse with `blocks` vectors of N numbers, N apart, in place; sums in the order of the columns.
template <int N, int blocks, int W>
inline void multiply(const SmallInverse& inverse, Lanes<W>* f) noexcept {
    constexpr std::size_t size = N, stride = padded(N);
    std::array<Lanes<W>, blocks * size> product;
    for (std::size_t row = 0; row < size; ++row) {
        for (std::size_t block = 0; block < blocks; ++block) {
            Lanes<W> total = f[block * size] * inverse.column[row];
            for (std::size_t k = 1; k < size; ++k) total += f[block * size + k] * inverse.column[k * stride + row];
            product[block * size + row] = total;
        }
    }
    std::memcpy(static_cast<void*>(f), product.data(), sizeof product);
}

/// Accelerations of links from their generalized forces, in place. f [in: N, N·m; out: m/s², rad/s²]
template <int W>
inline void accelerate(const LinkInertia& inertia, Lanes<W>* f) noexcept {
    multiply<2 * axis_terms, 2>(inertia.lateral, f);
    multiply<4, 1>(inertia.axial, f + 4 * axis_terms);
}

/// Accelerations of held links likewise: the plates' stretch is accelerated by t·a + |d| θ'².
template <int W>
inline void accelerate(const HeldNumbers<NumberOf<W>>& inverse, const LinkFrameOf<Lanes<W>>& frame, Lanes<W>* f) noexcept {
    const Lanes<W> outward = frame.turning * frame.turning / frame.inverse_length;
    for (int m = 0; m < axis_terms; m += 2) {
        const Lanes<W> pull = inverse.turning[static_cast<std::size_t>(m)] * outward, x = pull * frame.tx, y = pull * frame.ty;
        f[link_layout.x(End::rear, m)] += x;
        f[link_layout.y(End::rear, m)] += y;
        f[link_layout.x(End::front, m)] -= x;
        f[link_layout.y(End::front, m)] -= y;
    }
    multiply_turned(inverse.along, inverse.across, frame.tx, frame.ty, f, f);
    multiply_ends<2>(inverse.axial, f + 4 * axis_terms, f + 4 * axis_terms);
}

}  // namespace
}  // namespace cvtflow::model
