#pragma once
/// Vector lanes: the plates of one link, the points of one of its joints, its tips; or links side by side
/// (model/kernels/link_lanes.hpp). A lane count is a compile-time constant, padding lanes carry weight zero, and sums are taken in
/// one fixed tree: results do not depend on the instruction set.
///
/// Everything here and in the headers of kernels lies in unnamed namespaces: each translation unit has a copy of its own, compiled for its
/// own instruction set, and no linker can put the AVX-512 copy of a function where the baseline's is meant.

#include <array>
#include <cstddef>
#include <utility>

#include "model/basis/native_lanes.hpp"

namespace cvtflow::model {
namespace {

/// W numbers of one unit [any], W a power of two. Wider than the processor's vectors: two halves.
template <int W>
struct Lanes {
    Lanes<W / 2> low, high;

    Lanes() = default;
    Lanes(double value) noexcept : low(value), high(value) {}
    Lanes(const Lanes<W / 2>& first, const Lanes<W / 2>& second) noexcept : low(first), high(second) {}

    [[nodiscard]] double operator[](std::size_t lane) const noexcept { return lane < W / 2 ? low[lane] : high[lane - W / 2]; }
    void set(std::size_t lane, double value) noexcept { lane < W / 2 ? low.set(lane, value) : high.set(lane - W / 2, value); }
    void copy_to(double* to) const noexcept { low.copy_to(to), high.copy_to(to + W / 2); }

    friend Lanes operator+(const Lanes& a, const Lanes& b) noexcept { return {a.low + b.low, a.high + b.high}; }
    friend Lanes operator-(const Lanes& a, const Lanes& b) noexcept { return {a.low - b.low, a.high - b.high}; }
    friend Lanes operator*(const Lanes& a, const Lanes& b) noexcept { return {a.low * b.low, a.high * b.high}; }
    friend Lanes operator/(const Lanes& a, const Lanes& b) noexcept { return {a.low / b.low, a.high / b.high}; }
    friend Lanes operator-(const Lanes& a) noexcept { return {-a.low, -a.high}; }
    friend Lanes& operator+=(Lanes& a, const Lanes& b) noexcept { return a = a + b; }
    friend Lanes& operator-=(Lanes& a, const Lanes& b) noexcept { return a = a - b; }
    friend Lanes sqrt(const Lanes& a) noexcept { return {sqrt(a.low), sqrt(a.high)}; }
    friend Lanes abs(const Lanes& a) noexcept { return {abs(a.low), abs(a.high)}; }
};

/// One vector of the processor [any unit].
template <int W>
requires(W > 0 && W <= native_lanes) struct Lanes<W> {
    using Vector = typename NativeVector<W>::Type;
    Vector v;

    Lanes() = default;
    Lanes(double value) noexcept : v(value - Vector{}) {}
    Lanes(Vector vector) noexcept requires(W > 1) : v(vector) {}

    [[nodiscard]] double operator[](std::size_t lane) const noexcept {
        if constexpr (W == 1) {
            return v;
        } else {
            return v[lane];
        }
    }
    void set(std::size_t lane, double value) noexcept {
        if constexpr (W == 1) {
            v = value;
        } else {
            v[lane] = value;
        }
    }
    void copy_to(double* to) const noexcept { __builtin_memcpy(to, &v, sizeof v); }

    friend Lanes operator+(const Lanes& a, const Lanes& b) noexcept { return a.v + b.v; }
    friend Lanes operator-(const Lanes& a, const Lanes& b) noexcept { return a.v - b.v; }
    friend Lanes operator*(const Lanes& a, const Lanes& b) noexcept { return a.v * b.v; }
    friend Lanes operator/(const Lanes& a, const Lanes& b) noexcept { return a.v / b.v; }
    friend Lanes operator-(const Lanes& a) noexcept { return -a.v; }
    friend Lanes& operator+=(Lanes& a, const Lanes& b) noexcept { return a = a + b; }
    friend Lanes& operator-=(Lanes& a, const Lanes& b) noexcept { return a = a - b; }
    friend Lanes sqrt(const Lanes& a) noexcept { return native_sqrt<W>(a.v); }
    friend Lanes abs(const Lanes& a) noexcept { return native_abs<W>(a.v); }
};

/// from [W]
template <int W>
[[nodiscard]] inline Lanes<W> load(const double* from) noexcept {
    if constexpr (W <= native_lanes) {
        Lanes<W> lanes;
        __builtin_memcpy(&lanes.v, from, sizeof lanes.v);
        return lanes;
    } else {
        return {load<W / 2>(from), load<W / 2>(from + W / 2)};
    }
}

/// The lanes of both, those of `low` first.
template <int W>
[[nodiscard]] inline Lanes<2 * W> join(const Lanes<W>& low, const Lanes<W>& high) noexcept {
    if constexpr (2 * W <= native_lanes) {
        return native_join<W>(low.v, high.v);
    } else {
        return {low, high};
    }
}

/// Lanes [0, W/2) or [W/2, W).
template <int W>
[[nodiscard]] inline Lanes<W / 2> half(const Lanes<W>& lanes, int which) noexcept {
    if constexpr (W <= native_lanes) {
        return native_half<W>(lanes.v, which);
    } else {
        return which == 0 ? lanes.low : lanes.high;
    }
}

/// Its two halves added.
template <int W>
[[nodiscard]] inline Lanes<W / 2> folded(const Lanes<W>& lanes) noexcept {
    return half<W>(lanes, 0) + half<W>(lanes, 1);
}

/// Lanes [by, by + W) of both, those of `low` first. One vector of the processor, 0 ≤ by ≤ W.
template <int W, int by>
requires(W <= native_lanes) [[nodiscard]] inline Lanes<W> slide(const Lanes<W>& low, const Lanes<W>& high) noexcept {
    if constexpr (by == 0 || by == W) {
        return by == 0 ? low : high;
    } else {
        return native_slide<W, by>(low.v, high.v, std::make_integer_sequence<int, W>{});
    }
}

/// Lane k of row j to lane j of row k.
/// @param rows [W]
template <int W, int half = W / 2>
requires(W <= native_lanes) inline void transpose(Lanes<W>* rows) noexcept {
    if constexpr (half >= 1) {
        for (int row = 0; row < W; ++row) {
            if ((row & half) == 0) native_exchange<W, half>(rows[row].v, rows[row + half].v, std::make_integer_sequence<int, W>{});
        }
        transpose<W, half / 2>(rows);
    }
}

/// `chosen` where a > b, else `otherwise`; false for NaN.
template <int W>
[[nodiscard]] inline Lanes<W> select_greater(const Lanes<W>& a, const Lanes<W>& b, const Lanes<W>& chosen,
                                             const Lanes<W>& otherwise) noexcept {
    if constexpr (W <= native_lanes) {
        return a.v > b.v ? chosen.v : otherwise.v;
    } else {
        return {select_greater<W / 2>(a.low, b.low, chosen.low, otherwise.low),
                select_greater<W / 2>(a.high, b.high, chosen.high, otherwise.high)};
    }
}

/// One lane of `from` to the same lane of `to`.
template <int W>
inline void take(const Lanes<W>& from, std::size_t lane, Lanes<W>& to) noexcept {
    to.set(lane, from[lane]);
}

/// The larger of both; b if a is NaN.
template <int W>
[[nodiscard]] inline Lanes<W> larger(const Lanes<W>& a, const Lanes<W>& b) noexcept {
    if constexpr (W <= native_lanes) {
        return native_larger<W>(a.v, b.v);
    } else {
        return {larger<W / 2>(a.low, b.low), larger<W / 2>(a.high, b.high)};
    }
}

/// The smaller of both; b if a is NaN.
template <int W>
[[nodiscard]] inline Lanes<W> smaller(const Lanes<W>& a, const Lanes<W>& b) noexcept {
    if constexpr (W <= native_lanes) {
        return native_smaller<W>(a.v, b.v);
    } else {
        return {smaller<W / 2>(a.low, b.low), smaller<W / 2>(a.high, b.high)};
    }
}

template <int W>
[[nodiscard]] inline Lanes<W> positive_part(const Lanes<W>& lanes) noexcept {
    return larger<W>(lanes, Lanes<W>(0.0));
}

/// Whether no lane exceeds a limit; false for NaN. limit [unit of the lanes]
template <int W>
[[nodiscard]] inline bool all_at_most(const Lanes<W>& lanes, double limit) noexcept {
    if constexpr (W <= native_lanes) {
        return native_all_at_most<W>(lanes.v, limit);
    } else {
        return all_at_most<W / 2>(lanes.low, limit) && all_at_most<W / 2>(lanes.high, limit);
    }
}

/// 1/a and 1/b by one division. Neither product nor quotient may overflow: lengths in metres and speeds in metres per second do not.
template <int W>
struct Reciprocals {
    Lanes<W> first, second;
    Reciprocals(const Lanes<W>& a, const Lanes<W>& b) noexcept {
        const Lanes<W> both = 1.0 / (a * b);
        first = both * b;
        second = both * a;
    }
};

/// Sum in a fixed order: halves are added to each other until one is left.
template <int W>
[[nodiscard]] inline double sum(const Lanes<W>& lanes) noexcept {
    if constexpr (W == 1) {
        return lanes.v;
    } else {
        return sum<W / 2>(folded<W>(lanes));
    }
}

/// Sums of several, in the same tree and therefore the same bits as sum(), side by side: vectors are folded into each other, which takes
/// about one addition per value instead of log2 W.
/// @param totals [count] sums[k] = sum(terms[k])
template <int W, std::size_t count>
inline void sums(const std::array<Lanes<W>, count>& terms, double* totals) noexcept {
    if constexpr (count == 1 || (W <= 2 && count < W) || W == 1) {
        for (std::size_t k = 0; k < count; ++k) totals[k] = sum<W>(terms[k]);
    } else if constexpr (W > native_lanes || count < W) {
        std::array<Lanes<W / 2>, count> halves;
        for (std::size_t k = 0; k < count; ++k) halves[k] = folded<W>(terms[k]);
        sums<W / 2, count>(halves, totals);
    } else {
        std::array<typename NativeVector<W>::Type, W> block;
        for (std::size_t k = 0; k < W; ++k) block[k] = terms[k].v;
        Lanes<W>(native_transposed_sum<W, W>(block)).copy_to(totals);
        if constexpr (count > W) {
            std::array<Lanes<W>, count - W> rest;
            for (std::size_t k = W; k < count; ++k) rest[k - W] = terms[k];
            sums<W, count - W>(rest, totals + W);
        }
    }
}

}  // namespace
}  // namespace cvtflow::model
