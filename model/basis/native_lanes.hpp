#pragma once
/// The processor's own vectors of doubles, as the compiler's flags give them: 8 lanes (AVX-512), 4 (AVX) or 2 (SSE2, NEON and the like).
/// The compilers' vector types (gcc and clang alike) give arithmetic, comparison and shuffles on every architecture; only the square root
/// has to be requested by name.

#include <array>
#include <cstddef>
#include <utility>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "model/basis/isa.hpp"

namespace cvtflow::model {
namespace {

#if defined(__AVX512F__)
inline constexpr int native_lanes = 8;
inline constexpr Isa compiled_isa = Isa::avx512;
#elif defined(__AVX2__)
inline constexpr int native_lanes = 4;
inline constexpr Isa compiled_isa = Isa::avx2;
#else
inline constexpr int native_lanes = 2;
inline constexpr Isa compiled_isa = Isa::baseline;
#endif

inline constexpr bool slopes_alone = false;  ///< chain kernels have nothing but slopes without accounts (bench/one_lane)

/// W ≤ native_lanes doubles side by side, and integers of the same width.
template <int W>
struct NativeVector {
    typedef double Type __attribute__((vector_size(W * sizeof(double))));
    typedef long long Bits __attribute__((vector_size(W * sizeof(double))));
};
template <>
struct NativeVector<1> {
    using Type = double;
};

/// Correctly rounded, as IEEE 754 asks of every processor.
template <int W>
[[nodiscard]] inline typename NativeVector<W>::Type native_sqrt(typename NativeVector<W>::Type v) noexcept {
    if constexpr (W == 1) return __builtin_sqrt(v);
#if defined(__AVX512F__)
    else if constexpr (W == 8)
        return _mm512_maskz_sqrt_pd(0xff, v);  // the unmasked one begins with an undefined register, which gcc 12 warns of
#endif
#if defined(__AVX2__)
    else if constexpr (W == 4)
        return _mm256_sqrt_pd(v);
#endif
#if defined(__x86_64__)
    else if constexpr (W == 2)
        return _mm_sqrt_pd(v);
#endif
    else {
        for (int lane = 0; lane < W; ++lane) v[lane] = __builtin_sqrt(v[lane]);
        return v;
    }
}

template <int W>
[[nodiscard]] inline typename NativeVector<W>::Type native_abs(typename NativeVector<W>::Type v) noexcept {
    if constexpr (W == 1) {
        return __builtin_fabs(v);
    } else {
        using Vector = NativeVector<W>;
        return (typename Vector::Type)((typename Vector::Bits)v & 0x7fffffffffffffffLL);
    }
}

/// a > b ? a : b, as one instruction where the processor has it (compilers see it in some places only).
template <int W>
[[nodiscard]] inline typename NativeVector<W>::Type native_larger(typename NativeVector<W>::Type a,
                                                                  typename NativeVector<W>::Type b) noexcept {
#if defined(__AVX512F__)
    if constexpr (W == 8) return _mm512_maskz_max_pd(0xff, a, b);
#endif
#if defined(__AVX2__)
    if constexpr (W == 4) return _mm256_max_pd(a, b);
#endif
#if defined(__x86_64__)
    if constexpr (W == 2) return _mm_max_pd(a, b);
#endif
    return a > b ? a : b;
}

/// a < b ? a : b.
template <int W>
[[nodiscard]] inline typename NativeVector<W>::Type native_smaller(typename NativeVector<W>::Type a,
                                                                   typename NativeVector<W>::Type b) noexcept {
#if defined(__AVX512F__)
    if constexpr (W == 8) return _mm512_maskz_min_pd(0xff, a, b);
#endif
#if defined(__AVX2__)
    if constexpr (W == 4) return _mm256_min_pd(a, b);
#endif
#if defined(__x86_64__)
    if constexpr (W == 2) return _mm_min_pd(a, b);
#endif
    return a < b ? a : b;
}

/// limit [unit of the lanes]
template <int W>
[[nodiscard]] inline bool native_all_at_most(typename NativeVector<W>::Type v, double limit) noexcept {
    if constexpr (W == 1) {
        return v <= limit;
    }
#if defined(__AVX512F__)
    else if constexpr (W == 8)
        return _mm512_cmp_pd_mask(v, _mm512_set1_pd(limit), _CMP_LE_OQ) == 0xff;
#endif
#if defined(__AVX2__)
    else if constexpr (W == 4)
        return _mm256_movemask_pd(_mm256_cmp_pd(v, _mm256_set1_pd(limit), _CMP_LE_OQ)) == 0xf;
#endif
#if defined(__x86_64__)
    else if constexpr (W == 2)
        return _mm_movemask_pd(_mm_cmple_pd(v, _mm_set1_pd(limit))) == 0x3;
#endif
    else {
        const auto within = v <= limit - typename NativeVector<W>::Type{};
        bool all = true;
        for (int lane = 0; lane < W; ++lane) all = all && within[lane] != 0;
        return all;
    }
}

/// Lanes [0, W/2) or [W/2, W).
template <int W>
[[nodiscard]] inline typename NativeVector<W / 2>::Type native_half(typename NativeVector<W>::Type v, int half) noexcept {
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
[[nodiscard]] inline typename NativeVector<2 * W>::Type native_join(typename NativeVector<W>::Type low,
                                                                    typename NativeVector<W>::Type high) noexcept {
    if constexpr (W == 1) {
        return typename NativeVector<2>::Type{low, high};
    } else if constexpr (W == 2) {
        return __builtin_shufflevector(low, high, 0, 1, 2, 3);
    } else {
        return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
    }
}

/// Lanes [by, by + W) of both, those of `low` first.
template <int W, int by, int... lane>
[[nodiscard]] inline typename NativeVector<W>::Type native_slide(typename NativeVector<W>::Type low, typename NativeVector<W>::Type high,
                                                                 std::integer_sequence<int, lane...>) noexcept {
    return __builtin_shufflevector(low, high, (lane + by)...);
}

/// Rows a and b of a matrix of blocks of half × half lanes: the blocks beside the diagonal change places.
template <int W, int half, int... lane>
inline void native_exchange(typename NativeVector<W>::Type& a, typename NativeVector<W>::Type& b,
                            std::integer_sequence<int, lane...>) noexcept {
    const typename NativeVector<W>::Type upper = __builtin_shufflevector(a, b, (lane / half % 2 == 0 ? lane : lane - half + W)...);
    b = __builtin_shufflevector(a, b, (lane / half % 2 == 0 ? lane + half : lane + W)...);
    a = upper;
}

/// Both vectors consist of groups of `group` lanes; every group is folded to half its length, those of a before those of b.
template <int W, int group, int... lane>
[[nodiscard]] inline typename NativeVector<W>::Type native_fold(typename NativeVector<W>::Type a, typename NativeVector<W>::Type b,
                                                                std::integer_sequence<int, lane...>) noexcept {
    constexpr int half = group / 2;
    return __builtin_shufflevector(a, b, (lane / half * group + lane % half)...) +
           __builtin_shufflevector(a, b, (lane / half * group + lane % half + half)...);
}

/// Lane k of the result is the sum over the lanes of v[k].
template <int W, int group>
[[nodiscard]] inline typename NativeVector<W>::Type native_transposed_sum(
    const std::array<typename NativeVector<W>::Type, group>& v) noexcept {
    if constexpr (group == 1) {
        return v[0];
    } else {
        std::array<typename NativeVector<W>::Type, group / 2> folded;
        for (std::size_t k = 0; k < group / 2; ++k)
            folded[k] = native_fold<W, group>(v[2 * k], v[2 * k + 1], std::make_integer_sequence<int, W>{});
        return native_transposed_sum<W, group / 2>(folded);
    }
}

}  // namespace
}  // namespace cvtflow::model
