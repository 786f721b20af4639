#pragma once
/// A ring of linear equations, each of an unknown and its two neighbours, which eight lanes eliminate side by side:
/// (own_i - back_i - on_i) x_i - back_i x_{i-1} - on_i x_{i+1} = rhs_i, own_i > 2 (back_i + on_i), none of them negative

#include <algorithm>
#include <type_traits>

#include "model/basis/columns.hpp"
#include "model/basis/lanes.hpp"

namespace cvtflow::model {

namespace {

/// Width of eight numbers of a type, and of one vector of the processor with at most eight.
template <class Real>
inline constexpr int eight_of = std::is_same_v<Real, float> ? singles<8> : 8;
template <class Real>
inline constexpr int square_width = is_native<eight_of<Real>>     ? eight_of<Real>
                                    : std::is_same_v<Real, float> ? singles<native_floats>
                                                                  : native_lanes;

/// Distribution of the equations over lanes: lane L has numbers begin(L) … begin(L + 1) - 1, in the last of its rows; rows before them are
/// absent. A ring of fewer than 8 equations is repeated, which does not change the solution.
struct RingShares {
    static constexpr int lanes = 8;
    int equations, rows;

    /// Number in row 0 of a lane, where that row is absent that of the lane before.
    std::array<int, lanes> first;

    explicit RingShares(int of_ring) noexcept
        : equations(of_ring >= lanes ? of_ring : (lanes + of_ring - 1) / of_ring * of_ring),
          rows(std::max(2, (equations + lanes - 1) / lanes)) {
        for (int lane = 0; lane < lanes; ++lane) first[std::size_t(lane)] = begin(lane + 1) - rows;
    }

    [[nodiscard]] int begin(int lane) const noexcept { return equations * lane / lanes; }
    /// 1 for lanes whose row 0 is absent. No lane lacks more.
    template <int W>
    [[nodiscard]] Lanes<W> absent() const noexcept {
        Lanes<W> all;
        for (std::size_t lane = 0; lane < lanes; ++lane) all.set(lane, NumberOf<W>(first[lane] < begin(static_cast<int>(lane)) ? 1 : 0));
        return all;
    }
    /// Copies numbers into rows, in squares of the processor's vectors. In a ring that is repeated, numbers beyond the last one are copies.
    template <class Real>
    void to_rows(const Real* numbers, Real* to) const noexcept {
        constexpr int W = square_width<Real>, side = lane_count<W>;
        Lanes<W> square[side];
        for (int lane = 0; lane < lanes; lane += side) {
            for (int row = 0; row < rows; row += side) {
                for (int k = 0; k < side; ++k) square[k] = load<W>(numbers + first[std::size_t(lane + k)] + row);
                transpose<W>(square);
                for (int k = 0; k < std::min(side, rows - row); ++k) square[k].copy_to(to + (row + k) * lanes + lane);
            }
        }
    }
    /// Copies rows to numbers, the last rows first: what a square has beyond its lane is overwritten by the lane behind, or lies beyond the
    /// last number.
    template <class Real>
    void from_rows(const Real* from, Real* numbers) const noexcept {
        constexpr int W = square_width<Real>, side = lane_count<W>;
        Lanes<W> square[side];
        for (int lane = 0; lane < lanes; lane += side) {
            for (int row = (rows - 1) / side * side; row >= 0; row -= side) {
                for (int k = 0; k < side; ++k) square[k] = load<W>(from + std::min(row + k, rows - 1) * lanes + lane);
                transpose<W>(square);
                for (int k = 0; k < side; ++k) square[k].copy_to(numbers + first[std::size_t(lane + k)] + row);
            }
        }
    }
};

/// Lane L + by of a vector, around the ring of lanes.
template <int by, int W>
[[nodiscard]] inline Lanes<W> neighbour(const Lanes<W>& lanes) noexcept {
    return lanes_across<(by + RingShares::lanes) % RingShares::lanes, W>(lanes, lanes);
}

/// x_L = free + behind x_{L-by} + ahead x_{L+by}: one unknown per lane.
template <int W>
struct LaneRing {
    using RingLanes = Lanes<W>;
    RingLanes free, behind, ahead;

    /// The ring of lanes at twice the distance.
    template <int by>
    [[nodiscard]] LaneRing halved() const noexcept {
        const RingLanes to = neighbour<-by>(ahead), from = neighbour<by>(behind);
        const RingLanes inverse = 1.0 / (1.0 - behind * to - ahead * from);
        return {(free + behind * neighbour<-by>(free) + ahead * neighbour<by>(free)) * inverse, behind * neighbour<-by>(behind) * inverse,
                ahead * neighbour<by>(ahead) * inverse};
    }
    [[nodiscard]] RingLanes solution() const noexcept {
        const LaneRing opposite = halved<1>().template halved<2>();  // both neighbours are the same lane
        const RingLanes both = opposite.behind + opposite.ahead;
        return (opposite.free + both * neighbour<4>(opposite.free)) / (1.0 - both * neighbour<4>(both));
    }
};

/// Each lane eliminates its unknowns but the last: x_r = free + behind x_{last of the lane before} + ahead x_{r+1}; the remaining ring has
/// one unknown per lane. In an absent row, x is that of the last row of the lane before.
template <class Real>
inline void solve_ring(const RingShares& shares, const RingRows<Real>& ring) noexcept {
    constexpr int W = eight_of<Real>;
    using RingLanes = Lanes<W>;
    const auto read = [](const Real* row, int at) { return RingLanes::load(row + at); };
    const RingLanes none(0.0), one(1.0), absent = shares.absent<W>();
    const auto present = [&](const Real* row) { return select_greater<W>(absent, none, none, read(row, 0)); };
    const int last = (shares.rows - 1) * RingShares::lanes;
    RingLanes free, behind, ahead;
    const auto store = [&](int at) { free.copy_to(ring.solution + at), behind.copy_to(ring.lower + at), ahead.copy_to(ring.upper + at); };
    {
        const RingLanes back = present(ring.back), on = present(ring.on), inverse = 1.0 / (read(ring.own, 0) - back - on);
        free = present(ring.rhs) * inverse;
        behind = select_greater<W>(absent, none, one, back * inverse);
        ahead = on * inverse;
        store(0);
    }
    RingLanes first_free = free, first_behind = select_greater<W>(absent, none, none, behind),
              first_ahead = select_greater<W>(absent, none, one, ahead);  // x of a lane's first row by those of both last ones
    for (int at = RingShares::lanes; at < last; at += RingShares::lanes) {
        const RingLanes back = read(ring.back, at), on = read(ring.on, at);
        const RingLanes inverse = 1.0 / ((read(ring.own, at) - back - on) - back * ahead);  // each row waits for this
        free = (read(ring.rhs, at) + back * free) * inverse;
        behind = back * behind * inverse;
        ahead = on * inverse;
        first_free += first_ahead * free;
        first_behind += first_ahead * behind;
        first_ahead = first_ahead * ahead;
        store(at);
    }
    const RingLanes back = read(ring.back, last), on = read(ring.on, last);
    const RingLanes inverse = 1.0 / (read(ring.own, last) - back * (1.0 + ahead) - on * (1.0 + neighbour<1>(first_behind)));
    const RingLanes sum = read(ring.rhs, last) + back * free + on * neighbour<1>(first_free);
    RingLanes next = LaneRing<W>{sum * inverse, back * behind * inverse, on * neighbour<1>(first_ahead) * inverse}.solution();
    const RingLanes before = neighbour<-1>(next);
    next.copy_to(ring.solution + last);
    for (int at = last - RingShares::lanes; at >= 0; at -= RingShares::lanes) {
        next = read(ring.solution, at) + read(ring.lower, at) * before + read(ring.upper, at) * next;
        next.copy_to(ring.solution + at);
    }
}

}  // namespace
}  // namespace cvtflow::model
