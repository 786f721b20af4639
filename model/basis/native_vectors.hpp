#pragma once
/// The processor's own vectors, of doubles and of floats: W is a width tag, which states number type and count. The compilers' vector types
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
/// Whether one vector of the processor holds them.
template <int W>
inline constexpr bool is_native = W > 0 && lane_count<W> <= (is_single<W> ? native_floats : native_lanes);

/// Numbers side by side, and integers of the same width.
template <int W>
struct NativeVector {
    using Integer = std::conditional_t<is_single<W>, int, long long>;
    typedef NumberOf<W> Type __attribute__((vector_size(lane_count<W> * sizeof(NumberOf<W>))));
    typedef Integer Bits __attribute__((vector_size(lane_count<W> * sizeof(NumberOf<W>))));
};
template <>
struct NativeVector<1> {
    using Type = double;
};
template <int W>
using Native = typename NativeVector<W>::Type;

template <int W>
[[nodiscard]] inline NumberOf<W> lane_of(const Native<W>& v, std::size_t lane) noexcept {
    if constexpr (W == 1) {
        return v;
    } else {
        return v[lane];
    }
}
template <int W>
inline void set_lane(Native<W>& v, std::size_t lane, NumberOf<W> value) noexcept {
    if constexpr (W == 1) {
        v = value;
    } else {
        v[lane] = value;
    }
}

/// Correctly rounded, as IEEE 754 requires. (The unmasked ones of AVX-512 begin with an undefined register, which gcc 12 warns of.)
template <int W>
[[nodiscard]] inline Native<W> native_sqrt(Native<W> v) noexcept {
#if defined(__AVX512F__)
    if constexpr (W == 8) return _mm512_maskz_sqrt_pd(0xff, v);
    if constexpr (W == singles<16>) return _mm512_maskz_sqrt_ps(0xffff, v);
#endif
#if defined(__AVX2__)
    if constexpr (W == 4) return _mm256_sqrt_pd(v);
    if constexpr (W == singles<8>) return _mm256_sqrt_ps(v);
#endif
#if defined(__x86_64__)
    if constexpr (W == 2) return _mm_sqrt_pd(v);
    if constexpr (W == singles<4>) return _mm_sqrt_ps(v);
#endif
    for (std::size_t lane = 0; lane < lane_count<W>; ++lane) {
        if constexpr (is_single<W>) {
            set_lane<W>(v, lane, __builtin_sqrtf(lane_of<W>(v, lane)));
        } else {
            set_lane<W>(v, lane, __builtin_sqrt(lane_of<W>(v, lane)));
        }
    }
    return v;
}

template <int W>
[[nodiscard]] inline Native<W> native_abs(Native<W> v) noexcept {
    if constexpr (W == 1) {
        return __builtin_fabs(v);
    } else {
        using Integer = typename NativeVector<W>::Integer;
        return (Native<W>)((typename NativeVector<W>::Bits)v & std::numeric_limits<Integer>::max());
    }
}

/// a > b ? a : b, as one instruction where the processor has it (compilers find it in some places only).
template <int W>
[[nodiscard]] inline Native<W> native_larger(Native<W> a, Native<W> b) noexcept {
#if defined(__AVX512F__)
    if constexpr (W == 8) return _mm512_maskz_max_pd(0xff, a, b);
    if constexpr (W == singles<16>) return _mm512_maskz_max_ps(0xffff, a, b);
#endif
#if defined(__AVX2__)
    if constexpr (W == 4) return _mm256_max_pd(a, b);
    if constexpr (W == singles<8>) return _mm256_max_ps(a, b);
#endif
#if defined(__x86_64__)
    if constexpr (W == 2) return _mm_max_pd(a, b);
    if constexpr (W == singles<4>) return _mm_max_ps(a, b);
#endif
    return a > b ? a : b;
}

/// a < b ? a : b.
template <int W>
[[nodiscard]] inline Native<W> native_smaller(Native<W> a, Native<W> b) noexcept {
#if defined(__AVX512F__)
    if constexpr (W == 8) return _mm512_maskz_min_pd(0xff, a, b);
    if constexpr (W == singles<16>) return _mm512_maskz_min_ps(0xffff, a, b);
#endif
#if defined(__AVX2__)
    if constexpr (W == 4) return _mm256_min_pd(a, b);
    if constexpr (W == singles<8>) return _mm256_min_ps(a, b);
#endif
#if defined(__x86_64__)
    if constexpr (W == 2) return _mm_min_pd(a, b);
    if constexpr (W == singles<4>) return _mm_min_ps(a, b);
#endif
    return a < b ? a : b;
}

/// Whether no lane exceeds a limit; false for NaN. limit [unit of the lanes]
template <int W>
[[nodiscard]] inline bool native_all_at_most(Native<W> v, NumberOf<W> limit) noexcept {
#if defined(__AVX512F__)
    if constexpr (W == 8) return _mm512_cmp_pd_mask(v, _mm512_set1_pd(limit), _CMP_LE_OQ) == 0xff;
    if constexpr (W == singles<16>) return _mm512_cmp_ps_mask(v, _mm512_set1_ps(limit), _CMP_LE_OQ) == 0xffff;
#endif
#if defined(__AVX2__)
    if constexpr (W == 4) return _mm256_movemask_pd(_mm256_cmp_pd(v, _mm256_set1_pd(limit), _CMP_LE_OQ)) == 0xf;
    if constexpr (W == singles<8>) return _mm256_movemask_ps(_mm256_cmp_ps(v, _mm256_set1_ps(limit), _CMP_LE_OQ)) == 0xff;
#endif
#if defined(__x86_64__)
    if constexpr (W == 2) return _mm_movemask_pd(_mm_cmple_pd(v, _mm_set1_pd(limit))) == 0x3;
    if constexpr (W == singles<4>) return _mm_movemask_ps(_mm_cmple_ps(v, _mm_set1_ps(limit))) == 0xf;
#endif
    bool all = true;
    for (std::size_t lane = 0; lane < lane_count<W>; ++lane) all = all && lane_of<W>(v, lane) <= limit;
    return all;
}

/// Lanes [0, W/2) or [W/2, W).
template <int W>
[[nodiscard]] inline Native<W / 2> native_half(Native<W> v, int half) noexcept {
    if constexpr (W == 2) {
        return v[half];
    } else if constexpr (W == 4) {
        return half == 0 ? __builtin_shufflevector(v, v, 0, 1) : __builtin_shufflevector(v, v, 2, 3);
    } else {
        return half == 0 ? __builtin_shufflevector(v, v, 0, 1, 2, 3) : __builtin_shufflevector(v, v, 4, 5, 6, 7);
    }
}

/// The lanes of both, those of `low` first.
template <int W>
[[nodiscard]] inline Native<2 * W> native_join(Native<W> low, Native<W> high) noexcept {
    if constexpr (W == 1) {
        return Native<2>{low, high};
    } else if constexpr (W == 2) {
        return __builtin_shufflevector(low, high, 0, 1, 2, 3);
    } else {
        return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
    }
}

/// Lanes [by, by + W) of both, those of `low` first.
template <int W, int by, int... lane>
[[nodiscard]] inline Native<W> native_slide(Native<W> low, Native<W> high, std::integer_sequence<int, lane...>) noexcept {
    return __builtin_shufflevector(low, high, (lane + by)...);
}

/// Rows a and b of a matrix of blocks of half × half lanes: the blocks beside the diagonal change places.
template <int W, int half, int... lane>
inline void native_exchange(Native<W>& a, Native<W>& b, std::integer_sequence<int, lane...>) noexcept {
    const Native<W> upper = __builtin_shufflevector(a, b, (lane / half % 2 == 0 ? lane : lane - half + W)...);
    b = __builtin_shufflevector(a, b, (lane / half % 2 == 0 ? lane + half : lane + W)...);
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

/// Two vectors of doubles rounded to the nearest floats. (Of __builtin_convertvector and __builtin_shufflevector gcc 12 makes several
/// instructions each, some of them by way of memory.)
template <int N>
[[nodiscard]] inline Native<singles<N>> native_narrow(Native<N / 2> low, Native<N / 2> high) noexcept {
#if defined(__AVX512DQ__)
    if constexpr (N == 16) {
        const __m512 first = _mm512_castps256_ps512(_mm512_maskz_cvtpd_ps(0xff, low));
        return _mm512_insertf32x8(first, _mm512_maskz_cvtpd_ps(0xff, high), 1);
    }
#endif
#if defined(__AVX2__)
    if constexpr (N == 8) return _mm256_set_m128(_mm256_cvtpd_ps(high), _mm256_cvtpd_ps(low));
#endif
#if defined(__x86_64__)
    if constexpr (N == 4) return _mm_movelh_ps(_mm_cvtpd_ps(low), _mm_cvtpd_ps(high));
#endif
    Native<singles<N>> floats;
    for (int lane = 0; lane < N; ++lane)
        floats[lane] = static_cast<float>(lane_of<N / 2>(lane < N / 2 ? low : high, static_cast<std::size_t>(lane % (N / 2))));
    return floats;
}

/// The first half of the floats, or the second.
template <int N, bool second>
[[nodiscard]] inline Native<N / 2> native_widen(Native<singles<N>> v) noexcept {
#if defined(__AVX512DQ__)
    if constexpr (N == 16) return _mm512_maskz_cvtps_pd(0xff, second ? _mm512_extractf32x8_ps(v, 1) : _mm512_castps512_ps256(v));
#endif
#if defined(__AVX2__)
    if constexpr (N == 8) return _mm256_cvtps_pd(second ? _mm256_extractf128_ps(v, 1) : _mm256_castps256_ps128(v));
#endif
#if defined(__x86_64__)
    if constexpr (N == 4) return _mm_cvtps_pd(second ? _mm_movehl_ps(v, v) : v);
#endif
    Native<N / 2> doubles;
    for (int lane = 0; lane < N / 2; ++lane) set_lane<N / 2>(doubles, static_cast<std::size_t>(lane), v[second ? N / 2 + lane : lane]);
    return doubles;
}

}  // namespace
}  // namespace cvtflow::model
