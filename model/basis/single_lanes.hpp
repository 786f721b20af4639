#pragma once
/// Lanes in single precision, as lanes of widths of their own: what is written over Lanes<W> computes in floats with W = singles<N>, twice
/// as many side by side in a vector of the processor. Every lane is rounded by itself: results do not depend on the instruction set.

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <type_traits>

#include "model/basis/float_lanes.hpp"
#include "model/basis/lanes.hpp"

namespace cvtflow::model {
namespace {

inline constexpr int single_widths = 1 << 16;
/// The width tag of N floats side by side; N a power of two, at least native_floats.
template <int N>
inline constexpr int singles = single_widths + N;
/// Whether a width tag denotes floats.
template <int W>
inline constexpr bool is_single = W > single_widths;
/// Lanes of a width.
template <int W>
inline constexpr int lane_count = is_single<W> ? W - single_widths : W;
/// What a lane of a width holds.
template <int W>
using NumberOf = std::conditional_t<is_single<W>, float, double>;

template <int W>
requires(is_single<W>) struct Lanes<W> {
    static constexpr int count = lane_count<W>;
    Floats<count> floats;

    Lanes() = default;
    Lanes(double value) noexcept : floats(static_cast<float>(value)) {}  // constants are written as numbers in formulas
    Lanes(const Floats<count>& those) noexcept : floats(those) {}
    void copy_to(float* to) const noexcept { floats.copy_to(to); }

    friend Lanes operator+(const Lanes& a, const Lanes& b) noexcept { return a.floats + b.floats; }
    friend Lanes operator-(const Lanes& a, const Lanes& b) noexcept { return a.floats - b.floats; }
    friend Lanes operator*(const Lanes& a, const Lanes& b) noexcept { return a.floats * b.floats; }
    friend Lanes operator/(const Lanes& a, const Lanes& b) noexcept { return a.floats / b.floats; }
    friend Lanes operator-(const Lanes& a) noexcept { return -a.floats; }
    friend Lanes& operator+=(Lanes& a, const Lanes& b) noexcept { return a = a + b; }
    friend Lanes& operator-=(Lanes& a, const Lanes& b) noexcept { return a = a - b; }
    friend Lanes sqrt(const Lanes& a) noexcept { return sqrt(a.floats); }
    friend Lanes abs(const Lanes& a) noexcept { return absolute(a.floats); }
};

/// from [lane_count<W>]
template <int W>
requires(is_single<W>) [[nodiscard]] inline Lanes<W> load(const float* from) noexcept { return load_floats<lane_count<W>>(from); }

template <int W>
requires(is_single<W>) [[nodiscard]] inline Lanes<W> select_greater(const Lanes<W>& a, const Lanes<W>& b, const Lanes<W>& chosen,
                                                                    const Lanes<W>& otherwise) noexcept {
    return chosen_where_greater<lane_count<W>>(a.floats, b.floats, chosen.floats, otherwise.floats);
}
template <int W>
requires(is_single<W>) [[nodiscard]] inline Lanes<W> larger(const Lanes<W>& a, const Lanes<W>& b) noexcept {
    return larger_floats<lane_count<W>>(a.floats, b.floats);
}
template <int W>
requires(is_single<W>) [[nodiscard]] inline Lanes<W> smaller(const Lanes<W>& a, const Lanes<W>& b) noexcept {
    return smaller_floats<lane_count<W>>(a.floats, b.floats);
}
/// limit [unit of the lanes]
template <int W>
requires(is_single<W>) [[nodiscard]] inline bool all_at_most(const Lanes<W>& lanes, double limit) noexcept {
    return floats_at_most<lane_count<W>>(lanes.floats, static_cast<float>(limit));
}

/// The first `count` lanes.
template <int W>
inline void store_first(const Lanes<W>& lanes, NumberOf<W>* to, int count) noexcept {
    if (count >= lane_count<W>) return lanes.copy_to(to);
    alignas(64) NumberOf<W> all[static_cast<std::size_t>(lane_count<W>)];
    lanes.copy_to(all);
    std::copy_n(all, std::max(count, 0), to);
}

/// Doubles rounded to floats. to [W]
template <int W>
inline void store_rounded(const Lanes<W>& lanes, float* to) noexcept {
    if constexpr (W > native_lanes) {
        store_rounded<W / 2>(lanes.low, to);
        store_rounded<W / 2>(lanes.high, to + W / 2);
    } else {
        typedef float Rounded __attribute__((vector_size(W * sizeof(float))));
        const Rounded rounded = __builtin_convertvector(lanes.v, Rounded);
        std::memcpy(to, &rounded, sizeof rounded);
    }
}

}  // namespace
}  // namespace cvtflow::model
