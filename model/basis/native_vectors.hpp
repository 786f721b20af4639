#pragma once
/// Vectors of the processor, of doubles and of floats: W is a width tag, which states number type and count. The compilers' vector types
/// (gcc and clang alike) give arithmetic, comparison and shuffles on every architecture; only square roots and a few others have to be
/// requested by name. Every lane is rounded by itself: results do not depend on the instruction set.

#include <array>
#include <cstddef>
#include <limits>
#include <type_traits>
#include <utility>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "model/basis/native_lanes.hpp"

namespace cvtflow::model {
namespace {

/// Floats per vector of the processor: twice as many as doubles.
inline constexpr int native_floats = 2 * native_lanes;

inline constexpr int single_widths = 1 << 16;
/// The width tag of N floats side by side; N a power of two, at least native_floats. That of N doubles is N.
template <int N>
inline constexpr int singles = single_widths + N;
/// Whether a width tag denotes floats.
template <int W>
inline constexpr bool is_single = W > single_widths;
/// Lanes of a width.
template <int W>
inline constexpr int lane_count = is_single<W> ? W - single_widths : W;
/// Type of a lane of a width.
template <int W>
using NumberOf = std::conditional_t<is_single<W>, float, double>;
/// The tag of half as many lanes.
template <int W>
inline constexpr int half_width = is_single<W> ? singles<lane_count<W> / 2> : W / 2;
/// The tag of twice as many lanes.
template <int W>
inline constexpr int double_width = is_single<W> ? W + lane_count<W> : 2 * W;
/// Whether one vector of the processor holds them.
template <int W>
inline constexpr bool is_native = W > 0 && lane_count<W> <= (is_single<W> ? native_floats : native_lanes);

/// Numbers side by side.
template <int W>
struct NativeVector {
    typedef NumberOf<W> Type __attribute__((vector_size(lane_count<W> * sizeof(NumberOf<W>))));
};
template <>
struct NativeVector<1> {
    using Type = double;
};
template <int W>
using Native = typename NativeVector<W>::Type;

// Operations on one vector: first for every processor, then overloads for what the compilers do not find for an instruction set.

inline double lane_of(double v, std::size_t) noexcept { return v; }
inline void set_lane(double& v, std::size_t, double value) noexcept { v = value; }
template <class Vector>
inline auto lane_of(const Vector& v, std::size_t lane) noexcept {
    return v[lane];
}
template <class Vector, class Number>
inline void set_lane(Vector& v, std::size_t lane, Number value) noexcept {
    v[lane] = value;
}

/// Correctly rounded, as IEEE 754 requires.
inline float native_sqrt(float v) noexcept { return __builtin_sqrtf(v); }
inline double native_sqrt(double v) noexcept { return __builtin_sqrt(v); }
template <class Vector>
inline Vector native_sqrt(Vector v) noexcept {
    for (std::size_t lane = 0; lane < sizeof v / sizeof v[0]; ++lane) v[lane] = native_sqrt(lane_of(v, lane));
    return v;
}
/// a > b ? a : b, as one instruction where the processor has it (compilers find it in some places only).
template <class Vector>
inline Vector native_larger(Vector a, Vector b) noexcept {
    return a > b ? a : b;
}
/// a < b ? a : b.
template <class Vector>
inline Vector native_smaller(Vector a, Vector b) noexcept {
    return a < b ? a : b;
}
/// Whether no lane exceeds a limit; false for NaN. limit [unit of the lanes]
template <class Vector, class Number>
inline bool native_at_most(Vector v, Number limit) noexcept {
    bool all = true;
    for (std::size_t lane = 0; lane < sizeof v / sizeof limit; ++lane) all = all && lane_of(v, lane) <= limit;
    return all;
}
/// Two vectors of doubles rounded to the nearest floats. (Of __builtin_convertvector and __builtin_shufflevector gcc 12 makes several
/// instructions each, some of them by way of memory.)
template <class Doubles>
inline Native<singles<native_floats>> native_narrow(Doubles low, Doubles high) noexcept {
    Native<singles<native_floats>> floats;
    for (std::size_t lane = 0; lane < native_lanes; ++lane) {
        floats[lane] = static_cast<float>(lane_of(low, lane));
        floats[native_lanes + lane] = static_cast<float>(lane_of(high, lane));
    }
    return floats;
}
/// The first half of the floats, or the second.
template <class Floats>
inline Native<native_lanes> native_widen(Floats v, bool second) noexcept {
    Native<native_lanes> doubles;
    for (std::size_t lane = 0; lane < native_lanes; ++lane) set_lane(doubles, lane, double(v[second ? native_lanes + lane : lane]));
    return doubles;
}

/// A vector of doubles as one of floats, or back, where both are one of the processor's.
template <int W, class Vector>
inline Native<W> native_convert(Vector v) noexcept {
    return __builtin_convertvector(v, Native<W>);
}

#if defined(__x86_64__)
using Doubles2 = Native<2>;
using Floats4 = Native<singles<4>>;
inline Doubles2 native_sqrt(Doubles2 v) noexcept { return _mm_sqrt_pd(v); }
inline Floats4 native_sqrt(Floats4 v) noexcept { return _mm_sqrt_ps(v); }
inline Doubles2 native_larger(Doubles2 a, Doubles2 b) noexcept { return _mm_max_pd(a, b); }
inline Floats4 native_larger(Floats4 a, Floats4 b) noexcept { return _mm_max_ps(a, b); }
inline Doubles2 native_smaller(Doubles2 a, Doubles2 b) noexcept { return _mm_min_pd(a, b); }
inline Floats4 native_smaller(Floats4 a, Floats4 b) noexcept { return _mm_min_ps(a, b); }
inline bool native_at_most(Doubles2 v, double limit) noexcept { return _mm_movemask_pd(_mm_cmple_pd(v, _mm_set1_pd(limit))) == 0x3; }
inline bool native_at_most(Floats4 v, float limit) noexcept { return _mm_movemask_ps(_mm_cmple_ps(v, _mm_set1_ps(limit))) == 0xf; }
inline Floats4 native_narrow(Doubles2 low, Doubles2 high) noexcept { return _mm_movelh_ps(_mm_cvtpd_ps(low), _mm_cvtpd_ps(high)); }
inline Doubles2 native_widen(Floats4 v, bool second) noexcept { return _mm_cvtps_pd(second ? _mm_movehl_ps(v, v) : v); }
#endif
#if defined(__AVX2__)
using Doubles4 = Native<4>;
using Floats8 = Native<singles<8>>;
inline Doubles4 native_sqrt(Doubles4 v) noexcept { return _mm256_sqrt_pd(v); }
inline Floats8 native_sqrt(Floats8 v) noexcept { return _mm256_sqrt_ps(v); }
inline Doubles4 native_larger(Doubles4 a, Doubles4 b) noexcept { return _mm256_max_pd(a, b); }
inline Floats8 native_larger(Floats8 a, Floats8 b) noexcept { return _mm256_max_ps(a, b); }
inline Doubles4 native_smaller(Doubles4 a, Doubles4 b) noexcept { return _mm256_min_pd(a, b); }
inline Floats8 native_smaller(Floats8 a, Floats8 b) noexcept { return _mm256_min_ps(a, b); }
inline bool native_at_most(Doubles4 v, double limit) noexcept {
    return _mm256_movemask_pd(_mm256_cmp_pd(v, _mm256_set1_pd(limit), _CMP_LE_OQ)) == 0xf;
}
inline bool native_at_most(Floats8 v, float limit) noexcept {
    return _mm256_movemask_ps(_mm256_cmp_ps(v, _mm256_set1_ps(limit), _CMP_LE_OQ)) == 0xff;
}
inline Floats8 native_narrow(Doubles4 low, Doubles4 high) noexcept { return _mm256_set_m128(_mm256_cvtpd_ps(high), _mm256_cvtpd_ps(low)); }
inline Doubles4 native_widen(Floats8 v, bool second) noexcept {
    return _mm256_cvtps_pd(second ? _mm256_extractf128_ps(v, 1) : _mm256_castps256_ps128(v));
}
#endif
#if defined(__AVX512F__) && defined(__AVX512DQ__)
// Operations without a mask begin with an undefined register, which gcc 12 warns of.
using Doubles8 = Native<8>;
using Floats16 = Native<singles<16>>;
inline Doubles8 native_sqrt(Doubles8 v) noexcept { return _mm512_maskz_sqrt_pd(0xff, v); }
inline Floats16 native_sqrt(Floats16 v) noexcept { return _mm512_maskz_sqrt_ps(0xffff, v); }
inline Doubles8 native_larger(Doubles8 a, Doubles8 b) noexcept { return _mm512_maskz_max_pd(0xff, a, b); }
inline Floats16 native_larger(Floats16 a, Floats16 b) noexcept { return _mm512_maskz_max_ps(0xffff, a, b); }
inline Doubles8 native_smaller(Doubles8 a, Doubles8 b) noexcept { return _mm512_maskz_min_pd(0xff, a, b); }
inline Floats16 native_smaller(Floats16 a, Floats16 b) noexcept { return _mm512_maskz_min_ps(0xffff, a, b); }
inline bool native_at_most(Doubles8 v, double limit) noexcept { return _mm512_cmp_pd_mask(v, _mm512_set1_pd(limit), _CMP_LE_OQ) == 0xff; }
inline bool native_at_most(Floats16 v, float limit) noexcept { return _mm512_cmp_ps_mask(v, _mm512_set1_ps(limit), _CMP_LE_OQ) == 0xffff; }
inline Floats16 native_narrow(Doubles8 low, Doubles8 high) noexcept {
    const __m512 first = _mm512_castps256_ps512(_mm512_maskz_cvtpd_ps(0xff, low));
    return _mm512_insertf32x8(first, _mm512_maskz_cvtpd_ps(0xff, high), 1);
}
inline Doubles8 native_widen(Floats16 v, bool second) noexcept {
    return _mm512_maskz_cvtps_pd(0xff, second ? _mm512_extractf32x8_ps(v, 1) : _mm512_castps512_ps256(v));
}
#endif

inline double native_abs(double v) noexcept { return __builtin_fabs(v); }
template <class Vector>
inline Vector native_abs(Vector v) noexcept {
    using Bits = decltype(v > Vector{});  // integers of the same width
    return (Vector)((Bits)v & std::numeric_limits<std::remove_cvref_t<decltype(Bits{}[0])>>::max());
}

/// The first half of the lanes, or the second. @param lane 0 … W/2 - 1
inline double native_half(Native<2> v, int half, std::integer_sequence<int, 0>) noexcept { return v[half]; }
template <class Vector, int... lane>
[[nodiscard]] inline auto native_half(Vector v, int half, std::integer_sequence<int, lane...>) noexcept {
    return half == 0 ? __builtin_shufflevector(v, v, lane...) : __builtin_shufflevector(v, v, (lane + int(sizeof...(lane)))...);
}

/// The lanes of both, those of `low` first. @param lane 0 … 2 W - 1
inline Native<2> native_join(double low, double high, std::integer_sequence<int, 0, 1>) noexcept { return Native<2>{low, high}; }
template <class Vector, int... lane>
[[nodiscard]] inline auto native_join(Vector low, Vector high, std::integer_sequence<int, lane...>) noexcept {
    return __builtin_shufflevector(low, high, lane...);
}

/// Lanes [by, by + W) of both, those of `low` first.
template <int W, int by, int... lane>
[[nodiscard]] inline Native<W> native_slide(Native<W> low, Native<W> high, std::integer_sequence<int, lane...>) noexcept {
    return __builtin_shufflevector(low, high, (lane + by)...);
}

/// Rows a and b of a matrix of blocks of half × half lanes: the blocks beside the diagonal change places.
template <int W, int half, int... lane>
inline void native_exchange(Native<W>& a, Native<W>& b, std::integer_sequence<int, lane...>) noexcept {
    const Native<W> upper = __builtin_shufflevector(a, b, (lane / half % 2 == 0 ? lane : lane - half + lane_count<W>)...);
    b = __builtin_shufflevector(a, b, (lane / half % 2 == 0 ? lane + half : lane + lane_count<W>)...);
    a = upper;
}

/// Both vectors consist of groups of `group` lanes; every group is folded to half its length, those of a before those of b.
template <int W, int group, int... lane>
[[nodiscard]] inline Native<W> native_fold(Native<W> a, Native<W> b, std::integer_sequence<int, lane...>) noexcept {
    constexpr int half = group / 2;
    return __builtin_shufflevector(a, b, (lane / half * group + lane % half)...) +
           __builtin_shufflevector(a, b, (lane / half * group + lane % half + half)...);
}

/// Lane k of the result is the sum over the lanes of v[k].
template <int W, int group>
[[nodiscard]] inline Native<W> native_transposed_sum(const std::array<Native<W>, group>& v) noexcept {
    if constexpr (group == 1) {
        return v[0];
    } else {
        std::array<Native<W>, group / 2> folded;
        for (std::size_t k = 0; k < group / 2; ++k)
            folded[k] = native_fold<W, group>(v[2 * k], v[2 * k + 1], std::make_integer_sequence<int, W>{});
        return native_transposed_sum<W, group / 2>(folded);
    }
}

}  // namespace
}  // namespace cvtflow::model
