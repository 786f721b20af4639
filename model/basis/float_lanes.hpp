#pragma once
/// Sixteen floats side by side, for factors of matrices that only have to be good enough to converge with. As with Lanes, every lane is
/// rounded by itself: results do not depend on the instruction set.

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "model/basis/lanes.hpp"

namespace cvtflow::model {
namespace {

inline constexpr int float_lanes = 16;
/// In a vector of the processor there are twice as many floats as doubles.
inline constexpr int native_floats = 2 * native_lanes;

/// One vector of W floats. (Kernels that are compiled for comparison without vectors have fewer than any processor.)
template <int W>
struct FloatVector {
    typedef float Type __attribute__((vector_size(W * sizeof(float))));
};

/// Correctly rounded, as IEEE 754 asks of every processor.
template <int W>
[[nodiscard]] inline typename FloatVector<W>::Type float_sqrt(typename FloatVector<W>::Type v) noexcept {
#if defined(__AVX512F__)
    if constexpr (W == 16) return _mm512_maskz_sqrt_ps(0xffff, v);
#endif
#if defined(__AVX2__)
    if constexpr (W == 8) return _mm256_sqrt_ps(v);
#endif
#if defined(__x86_64__)
    if constexpr (W == 4) return _mm_sqrt_ps(v);
#endif
    typename FloatVector<W>::Type root;
    for (int lane = 0; lane < W; ++lane) root[lane] = __builtin_sqrtf(v[lane]);
    return root;
}

/// a > b ? a : b, as one instruction where the processor has it.
template <int W>
[[nodiscard]] inline typename FloatVector<W>::Type float_larger(typename FloatVector<W>::Type a, typename FloatVector<W>::Type b) noexcept {
#if defined(__AVX512F__)
    if constexpr (W == 16) return _mm512_maskz_max_ps(0xffff, a, b);
#endif
#if defined(__AVX2__)
    if constexpr (W == 8) return _mm256_max_ps(a, b);
#endif
#if defined(__x86_64__)
    if constexpr (W == 4) return _mm_max_ps(a, b);
#endif
    return a > b ? a : b;
}

/// a < b ? a : b.
template <int W>
[[nodiscard]] inline typename FloatVector<W>::Type float_smaller(typename FloatVector<W>::Type a,
                                                                 typename FloatVector<W>::Type b) noexcept {
#if defined(__AVX512F__)
    if constexpr (W == 16) return _mm512_maskz_min_ps(0xffff, a, b);
#endif
#if defined(__AVX2__)
    if constexpr (W == 8) return _mm256_min_ps(a, b);
#endif
#if defined(__x86_64__)
    if constexpr (W == 4) return _mm_min_ps(a, b);
#endif
    return a < b ? a : b;
}

/// Whether no lane exceeds a limit; false for NaN. limit [unit of the floats]
template <int W>
[[nodiscard]] inline bool float_all_at_most(typename FloatVector<W>::Type v, float limit) noexcept {
#if defined(__AVX512F__)
    if constexpr (W == 16) return _mm512_cmp_ps_mask(v, _mm512_set1_ps(limit), _CMP_LE_OQ) == 0xffff;
#endif
#if defined(__AVX2__)
    if constexpr (W == 8) return _mm256_movemask_ps(_mm256_cmp_ps(v, _mm256_set1_ps(limit), _CMP_LE_OQ)) == 0xff;
#endif
#if defined(__x86_64__)
    if constexpr (W == 4) return _mm_movemask_ps(_mm_cmple_ps(v, _mm_set1_ps(limit))) == 0xf;
#endif
    bool all = true;
    for (int lane = 0; lane < W; ++lane) all = all && v[lane] <= limit;
    return all;
}

/// W floats, W a power of two. Wider than the processor's vectors: two halves.
template <int W>
struct Floats {
    Floats<W / 2> low, high;

    Floats() = default;
    Floats(float value) noexcept : low(value), high(value) {}
    Floats(const Floats<W / 2>& first, const Floats<W / 2>& second) noexcept : low(first), high(second) {}
    void copy_to(float* to) const noexcept { low.copy_to(to), high.copy_to(to + W / 2); }

    friend Floats operator+(const Floats& a, const Floats& b) noexcept { return {a.low + b.low, a.high + b.high}; }
    friend Floats operator-(const Floats& a, const Floats& b) noexcept { return {a.low - b.low, a.high - b.high}; }
    friend Floats operator*(const Floats& a, const Floats& b) noexcept { return {a.low * b.low, a.high * b.high}; }
    friend Floats operator/(const Floats& a, const Floats& b) noexcept { return {a.low / b.low, a.high / b.high}; }
    friend Floats operator-(const Floats& a) noexcept { return {-a.low, -a.high}; }
    friend Floats sqrt(const Floats& a) noexcept { return {sqrt(a.low), sqrt(a.high)}; }
};

/// One vector of the processor.
template <>
struct Floats<native_floats> {
    using Vector = FloatVector<native_floats>::Type;
    Vector v;

    Floats() = default;
    Floats(float value) noexcept : v(value - Vector{}) {}
    Floats(Vector vector) noexcept : v(vector) {}
    void copy_to(float* to) const noexcept { __builtin_memcpy(to, &v, sizeof v); }

    friend Floats operator+(const Floats& a, const Floats& b) noexcept { return a.v + b.v; }
    friend Floats operator-(const Floats& a, const Floats& b) noexcept { return a.v - b.v; }
    friend Floats operator*(const Floats& a, const Floats& b) noexcept { return a.v * b.v; }
    friend Floats operator/(const Floats& a, const Floats& b) noexcept { return a.v / b.v; }
    friend Floats operator-(const Floats& a) noexcept { return -a.v; }
    friend Floats sqrt(const Floats& a) noexcept { return float_sqrt<native_floats>(a.v); }
};

using FloatLanes = Floats<float_lanes>;

template <int W>
[[nodiscard]] inline Floats<W> load_floats(const float* from) noexcept {
    if constexpr (W == native_floats) {
        Floats<W> floats;
        __builtin_memcpy(&floats.v, from, sizeof floats.v);
        return floats;
    } else {
        return {load_floats<W / 2>(from), load_floats<W / 2>(from + W / 2)};
    }
}
[[nodiscard]] inline FloatLanes load(const float* from) noexcept { return load_floats<float_lanes>(from); }

/// `chosen` where a > b, else `otherwise`; false for NaN.
template <int W>
[[nodiscard]] inline Floats<W> chosen_where_greater(const Floats<W>& a, const Floats<W>& b, const Floats<W>& chosen,
                                                    const Floats<W>& otherwise) noexcept {
    if constexpr (W == native_floats) {
        return a.v > b.v ? chosen.v : otherwise.v;
    } else {
        return {chosen_where_greater<W / 2>(a.low, b.low, chosen.low, otherwise.low),
                chosen_where_greater<W / 2>(a.high, b.high, chosen.high, otherwise.high)};
    }
}
[[nodiscard]] inline FloatLanes select_greater(const FloatLanes& a, const FloatLanes& b, const FloatLanes& chosen,
                                               const FloatLanes& otherwise) noexcept {
    return chosen_where_greater<float_lanes>(a, b, chosen, otherwise);
}

/// a > b ? a : b.
template <int W>
[[nodiscard]] inline Floats<W> larger_floats(const Floats<W>& a, const Floats<W>& b) noexcept {
    if constexpr (W == native_floats) {
        return float_larger<W>(a.v, b.v);
    } else {
        return {larger_floats<W / 2>(a.low, b.low), larger_floats<W / 2>(a.high, b.high)};
    }
}
/// a < b ? a : b.
template <int W>
[[nodiscard]] inline Floats<W> smaller_floats(const Floats<W>& a, const Floats<W>& b) noexcept {
    if constexpr (W == native_floats) {
        return float_smaller<W>(a.v, b.v);
    } else {
        return {smaller_floats<W / 2>(a.low, b.low), smaller_floats<W / 2>(a.high, b.high)};
    }
}
/// Whether no lane exceeds a limit; false for NaN. limit [unit of the floats]
template <int W>
[[nodiscard]] inline bool floats_at_most(const Floats<W>& a, float limit) noexcept {
    if constexpr (W == native_floats) {
        return float_all_at_most<W>(a.v, limit);
    } else {
        return floats_at_most<W / 2>(a.low, limit) && floats_at_most<W / 2>(a.high, limit);
    }
}
template <int W>
[[nodiscard]] inline Floats<W> absolute(const Floats<W>& a) noexcept {
    if constexpr (W == native_floats) {
        typedef int Bits __attribute__((vector_size(W * sizeof(int))));
        return (typename Floats<W>::Vector)((Bits)a.v & 0x7fffffff);
    } else {
        return {absolute<W / 2>(a.low), absolute<W / 2>(a.high)};
    }
}

/// The larger of both; b if a is NaN.
[[nodiscard]] inline FloatLanes larger(const FloatLanes& a, const FloatLanes& b) noexcept { return larger_floats<float_lanes>(a, b); }

/// Two vectors of doubles rounded to the nearest floats. (Of __builtin_convertvector and __builtin_shufflevector gcc 12 makes several
/// instructions each, some of them by way of memory.)
template <int W, class Doubles = typename NativeVector<W / 2>::Type>
[[nodiscard]] inline typename FloatVector<W>::Type float_narrow(Doubles low, Doubles high) noexcept {
#if defined(__AVX512DQ__)
    if constexpr (W == 16) {
        const __m512 first = _mm512_castps256_ps512(_mm512_maskz_cvtpd_ps(0xff, low));
        return _mm512_insertf32x8(first, _mm512_maskz_cvtpd_ps(0xff, high), 1);
    }
#endif
#if defined(__AVX2__)
    if constexpr (W == 8) return _mm256_set_m128(_mm256_cvtpd_ps(high), _mm256_cvtpd_ps(low));
#endif
#if defined(__x86_64__)
    if constexpr (W == 4) return _mm_movelh_ps(_mm_cvtpd_ps(low), _mm_cvtpd_ps(high));
#endif
    const Lanes<W / 2> first(low), second(high);
    typename FloatVector<W>::Type floats;
    for (int lane = 0; lane < W; ++lane) {
        const std::size_t of_half = static_cast<std::size_t>(lane % (W / 2));
        floats[lane] = static_cast<float>(lane < W / 2 ? first[of_half] : second[of_half]);
    }
    return floats;
}

/// The first half of the floats, or the second.
template <int W, bool second>
[[nodiscard]] inline Lanes<W / 2> float_widen(typename FloatVector<W>::Type v) noexcept {
#if defined(__AVX512DQ__)
    if constexpr (W == 16)
        return Lanes<W / 2>(_mm512_maskz_cvtps_pd(0xff, second ? _mm512_extractf32x8_ps(v, 1) : _mm512_castps512_ps256(v)));
#endif
#if defined(__AVX2__)
    if constexpr (W == 8) return Lanes<W / 2>(_mm256_cvtps_pd(second ? _mm256_extractf128_ps(v, 1) : _mm256_castps256_ps128(v)));
#endif
#if defined(__x86_64__)
    if constexpr (W == 4) return Lanes<W / 2>(_mm_cvtps_pd(second ? _mm_movehl_ps(v, v) : v));
#endif
    Lanes<W / 2> doubles;
    for (int lane = 0; lane < W / 2; ++lane) doubles.set(static_cast<std::size_t>(lane), v[second ? W / 2 + lane : lane]);
    return doubles;
}

/// Rounded to the nearest float.
template <int W>
[[nodiscard]] inline Floats<W> narrow(const Lanes<W>& lanes) noexcept {
    if constexpr (W == native_floats) {
        return float_narrow<W>(lanes.low.v, lanes.high.v);
    } else {
        return {narrow<W / 2>(lanes.low), narrow<W / 2>(lanes.high)};
    }
}

template <int W>
[[nodiscard]] inline Lanes<W> widen(const Floats<W>& floats) noexcept {
    if constexpr (W == native_floats) {
        return {float_widen<W, false>(floats.v), float_widen<W, true>(floats.v)};
    } else {
        return {widen<W / 2>(floats.low), widen<W / 2>(floats.high)};
    }
}

}  // namespace
}  // namespace cvtflow::model
