#pragma once
/// Vector lanes: links side by side (model/kernels/link_lanes.hpp). A lane count is a compile-time constant, and sums are taken in one
/// fixed tree: results do not depend on the instruction set.
///
/// Everything here and in the headers of kernels lies in unnamed namespaces: each translation unit has a copy for its instruction set, so
/// that no linker can replace the baseline's copy of a function by that of AVX-512.

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "model/basis/native_vectors.hpp"

namespace cvtflow::model {
namespace {

/// Numbers side by side, by their width tag (model/basis/native_vectors.hpp): doubles, or floats where less accuracy suffices. Wider than
/// the processor's vectors: two halves.
template <int W>
struct Lanes {
    using Half = Lanes<half_width<W>>;
    static constexpr std::size_t half = lane_count<W> / 2;
    Half low, high;

    Lanes() = default;
    Lanes(double value) noexcept : low(value), high(value) {}  // constants are written as doubles in formulas
    Lanes(const Half& first, const Half& second) noexcept : low(first), high(second) {}

    [[nodiscard]] NumberOf<W> operator[](std::size_t lane) const noexcept { return lane < half ? low[lane] : high[lane - half]; }
    void set(std::size_t lane, NumberOf<W> value) noexcept { lane < half ? low.set(lane, value) : high.set(lane - half, value); }
    void copy_to(NumberOf<W>* to) const noexcept { low.copy_to(to), high.copy_to(to + half); }
    [[nodiscard]] const Half& part(int which) const noexcept { return which == 0 ? low : high; }
    [[nodiscard]] bool at_most(double limit) const noexcept { return low.at_most(limit) && high.at_most(limit); }

    static Lanes load(const NumberOf<W>* from) noexcept { return {Half::load(from), Half::load(from + half)}; }
    static Lanes larger(const Lanes& a, const Lanes& b) noexcept { return {Half::larger(a.low, b.low), Half::larger(a.high, b.high)}; }
    static Lanes smaller(const Lanes& a, const Lanes& b) noexcept { return {Half::smaller(a.low, b.low), Half::smaller(a.high, b.high)}; }
    static Lanes select_greater(const Lanes& a, const Lanes& b, const Lanes& chosen, const Lanes& otherwise) noexcept {
        return {Half::select_greater(a.low, b.low, chosen.low, otherwise.low),
                Half::select_greater(a.high, b.high, chosen.high, otherwise.high)};
    }

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

/// One vector of the processor.
template <int W>
requires(is_native<W>) struct Lanes<W> {
    using Vector = Native<W>;
    Vector v;

    Lanes() = default;
    Lanes(double value) noexcept : v(static_cast<NumberOf<W>>(value) - Vector{}) {}
    Lanes(Vector vector) noexcept requires(W > 1) : v(vector) {}
    Lanes(const Lanes<half_width<W>>& first, const Lanes<half_width<W>>& second) noexcept requires(W > 1)
        : v(native_join(first.v, second.v, std::make_integer_sequence<int, lane_count<W>>{})) {}

    [[nodiscard]] NumberOf<W> operator[](std::size_t lane) const noexcept { return lane_of(v, lane); }
    void set(std::size_t lane, NumberOf<W> value) noexcept { set_lane(v, lane, value); }
    [[nodiscard]] Lanes<half_width<W>> part(int which) const noexcept {
        return native_half(v, which, std::make_integer_sequence<int, lane_count<W> / 2>{});
    }
    [[nodiscard]] bool at_most(double limit) const noexcept { return native_at_most(v, static_cast<NumberOf<W>>(limit)); }

    static Lanes load(const NumberOf<W>* from) noexcept {
        Lanes lanes;
        __builtin_memcpy(&lanes.v, from, sizeof lanes.v);
        return lanes;
    }
    static Lanes larger(const Lanes& a, const Lanes& b) noexcept { return native_larger(a.v, b.v); }
    static Lanes smaller(const Lanes& a, const Lanes& b) noexcept { return native_smaller(a.v, b.v); }
    static Lanes select_greater(const Lanes& a, const Lanes& b, const Lanes& chosen, const Lanes& otherwise) noexcept {
        return a.v > b.v ? chosen.v : otherwise.v;
    }
    /// Copies numbers: a copy of bytes might change any object, and the compiler would read pointers and strides again after it.
    void copy_to(NumberOf<W>* to) const noexcept {
        typedef Vector Unaligned __attribute__((aligned(alignof(NumberOf<W>))));
        *reinterpret_cast<Unaligned*>(to) = v;
    }

    friend Lanes operator+(const Lanes& a, const Lanes& b) noexcept { return a.v + b.v; }
    friend Lanes operator-(const Lanes& a, const Lanes& b) noexcept { return a.v - b.v; }
    friend Lanes operator*(const Lanes& a, const Lanes& b) noexcept { return a.v * b.v; }
    friend Lanes operator/(const Lanes& a, const Lanes& b) noexcept { return a.v / b.v; }
    friend Lanes operator-(const Lanes& a) noexcept { return -a.v; }
    friend Lanes& operator+=(Lanes& a, const Lanes& b) noexcept { return a = a + b; }
    friend Lanes& operator-=(Lanes& a, const Lanes& b) noexcept { return a = a - b; }
    friend Lanes sqrt(const Lanes& a) noexcept { return native_sqrt(a.v); }
    friend Lanes abs(const Lanes& a) noexcept { return native_abs(a.v); }
};

/// Loads lanes. from [lane_count<W>]
template <int W>
[[nodiscard]] inline Lanes<W> load(const NumberOf<W>* from) noexcept {
    return Lanes<W>::load(from);
}

/// Stores the first `count` lanes.
template <int W>
inline void store_first(const Lanes<W>& lanes, NumberOf<W>* to, int count) noexcept {
    if (count >= lane_count<W>) return lanes.copy_to(to);
    alignas(64) NumberOf<W> all[static_cast<std::size_t>(lane_count<W>)];
    lanes.copy_to(all);
    std::copy_n(all, std::max(count, 0), to);
}

/// The lanes of both, those of `low` first.
template <int W>
[[nodiscard]] inline Lanes<double_width<W>> join(const Lanes<W>& low, const Lanes<W>& high) noexcept {
    return {low, high};
}

/// The first half of the lanes, or the second.
template <int W>
[[nodiscard]] inline Lanes<half_width<W>> half(const Lanes<W>& lanes, int which) noexcept {
    return lanes.part(which);
}

/// Sum of both halves.
template <int W>
[[nodiscard]] inline Lanes<W / 2> folded(const Lanes<W>& lanes) noexcept {
    return half<W>(lanes, 0) + half<W>(lanes, 1);
}

/// Lanes from `by` on of both, those of `low` first. One vector of the processor, 0 ≤ by ≤ its lanes.
template <int W, int by>
requires(is_native<W>) [[nodiscard]] inline Lanes<W> slide(const Lanes<W>& low, const Lanes<W>& high) noexcept {
    if constexpr (by == 0 || by == lane_count<W>) {
        return by == 0 ? low : high;
    } else {
        return native_slide<W, by>(low.v, high.v, std::make_integer_sequence<int, lane_count<W>>{});
    }
}

/// Lanes from, from + 1, … of two vectors behind each other, 0 ≤ from < W.
template <int from, int W>
[[nodiscard, gnu::always_inline]] inline Lanes<W> lanes_across(const Lanes<W>& first, const Lanes<W>& second) noexcept {
    if constexpr (is_native<W>) {
        return slide<W, from>(first, second);
    } else {
        constexpr int each = lane_count<W> / 2, within = from % each;
        constexpr bool begins_low = from < each;
        const auto &a = begins_low ? first.low : first.high, &b = begins_low ? first.high : second.low,
                   &c = begins_low ? second.low : second.high;
        return {lanes_across<within, half_width<W>>(a, b), lanes_across<within, half_width<W>>(b, c)};
    }
}

/// Lane k of row j to lane j of row k.
/// @param rows [lanes]
template <int W, int half = lane_count<W> / 2>
requires(is_native<W>) inline void transpose(Lanes<W>* rows) noexcept {
    if constexpr (half >= 1) {
        constexpr auto lanes = std::make_integer_sequence<int, lane_count<W>>{};
        for (int row = 0; row < lane_count<W>; ++row) {
            if ((row & half) == 0) native_exchange<W, half>(rows[row].v, rows[row + half].v, lanes);
        }
        transpose<W, half / 2>(rows);
    }
}

/// `chosen` where a > b, else `otherwise`; false for NaN.
template <int W>
[[nodiscard]] inline Lanes<W> select_greater(const Lanes<W>& a, const Lanes<W>& b, const Lanes<W>& chosen,
                                             const Lanes<W>& otherwise) noexcept {
    return Lanes<W>::select_greater(a, b, chosen, otherwise);
}

/// Copies one lane of `from` to the same lane of `to`.
template <int W>
inline void take(const Lanes<W>& from, std::size_t lane, Lanes<W>& to) noexcept {
    to.set(lane, from[lane]);
}

/// The larger of both; b if a is NaN.
template <int W>
[[nodiscard]] inline Lanes<W> larger(const Lanes<W>& a, const Lanes<W>& b) noexcept {
    return Lanes<W>::larger(a, b);
}

/// The smaller of both; b if a is NaN.
template <int W>
[[nodiscard]] inline Lanes<W> smaller(const Lanes<W>& a, const Lanes<W>& b) noexcept {
    return Lanes<W>::smaller(a, b);
}

template <int W>
[[nodiscard]] inline Lanes<W> positive_part(const Lanes<W>& lanes) noexcept {
    return larger<W>(lanes, Lanes<W>(0.0));
}

/// Whether no lane exceeds a limit; false for NaN. limit [unit of the lanes]
template <int W>
[[nodiscard]] inline bool all_at_most(const Lanes<W>& lanes, double limit) noexcept {
    return lanes.at_most(limit);
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
        std::array<Native<W>, W> block;
        for (std::size_t k = 0; k < W; ++k) block[k] = terms[k].v;
        Lanes<W>(native_transposed_sum<W, W>(block)).copy_to(totals);
        if constexpr (count > W) {
            std::array<Lanes<W>, count - W> rest;
            for (std::size_t k = W; k < count; ++k) rest[k - W] = terms[k];
            sums<W, count - W>(rest, totals + W);
        }
    }
}

/// Doubles rounded to the nearest floats.
template <int N>
[[nodiscard]] inline Lanes<singles<N>> narrow(const Lanes<N>& lanes) noexcept {
    if constexpr (N == native_floats) {
        return native_narrow(lanes.low.v, lanes.high.v);
    } else if constexpr (is_native<N>) {
        return native_convert<singles<N>>(lanes.v);
    } else {
        return {narrow<N / 2>(lanes.low), narrow<N / 2>(lanes.high)};
    }
}

template <int N>
[[nodiscard]] inline Lanes<N> widen(const Lanes<singles<N>>& floats) noexcept {
    if constexpr (N == native_floats) {
        return {Lanes<N / 2>(native_widen(floats.v, false)), Lanes<N / 2>(native_widen(floats.v, true))};
    } else if constexpr (is_native<N>) {
        return native_convert<N>(floats.v);
    } else {
        return {widen<N / 2>(floats.low), widen<N / 2>(floats.high)};
    }
}

/// Doubles rounded to floats. to [W]
template <int W>
inline void store_rounded(const Lanes<W>& lanes, float* to) noexcept {
    if constexpr (W > native_lanes) {
        store_rounded<W / 2>(lanes.low, to);
        store_rounded<W / 2>(lanes.high, to + W / 2);
    } else {
        typedef float Rounded __attribute__((vector_size(W * sizeof(float))));
        typedef Rounded Unaligned __attribute__((aligned(alignof(float))));
        *reinterpret_cast<Unaligned*>(to) = __builtin_convertvector(lanes.v, Rounded);  // as numbers, like Lanes::copy_to
    }
}

}  // namespace
}  // namespace cvtflow::model
