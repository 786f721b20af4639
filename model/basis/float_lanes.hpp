#pragma once
/// Sixteen floats side by side, for factors of matrices that only have to be good enough to converge with. As with Lanes, every lane is rounded by
/// itself: results do not depend on the instruction set.

#include "model/basis/lanes.hpp"

namespace cvtflow::model {
namespace {

inline constexpr int float_lanes = 16;

/// In vectors of the processor, twice as many floats as doubles each.
struct FloatLanes {
    static constexpr int native = 2 * native_lanes, pieces = float_lanes / native;
    typedef float Vector __attribute__((vector_size(native * sizeof(float))));
    typedef float Half __attribute__((vector_size(native_lanes * sizeof(float))));
    Vector v[pieces];

    FloatLanes() = default;
    FloatLanes(float value) noexcept {
        for (Vector& piece : v) piece = value - Vector{};
    }
    void copy_to(float* to) const noexcept { __builtin_memcpy(to, v, sizeof v); }

    /// Piece by piece.
    template <class Operation>
    [[nodiscard]] static FloatLanes each(const Operation& operation) noexcept {
        FloatLanes result;
        for (int k = 0; k < pieces; ++k) result.v[k] = operation(k);
        return result;
    }
    friend FloatLanes operator+(const FloatLanes& a, const FloatLanes& b) noexcept { return each([&](int k) { return a.v[k] + b.v[k]; }); }
    friend FloatLanes operator-(const FloatLanes& a, const FloatLanes& b) noexcept { return each([&](int k) { return a.v[k] - b.v[k]; }); }
    friend FloatLanes operator*(const FloatLanes& a, const FloatLanes& b) noexcept { return each([&](int k) { return a.v[k] * b.v[k]; }); }
    friend FloatLanes operator/(const FloatLanes& a, const FloatLanes& b) noexcept { return each([&](int k) { return a.v[k] / b.v[k]; }); }
    friend FloatLanes operator-(const FloatLanes& a) noexcept { return each([&](int k) { return -a.v[k]; }); }
};

[[nodiscard]] inline FloatLanes load(const float* from) noexcept {
    FloatLanes lanes;
    __builtin_memcpy(lanes.v, from, sizeof lanes.v);
    return lanes;
}

/// `chosen` where a > b, else `otherwise`; false for NaN.
[[nodiscard]] inline FloatLanes select_greater(const FloatLanes& a, const FloatLanes& b, const FloatLanes& chosen, const FloatLanes& otherwise) noexcept {
    return FloatLanes::each([&](int k) { return a.v[k] > b.v[k] ? chosen.v[k] : otherwise.v[k]; });
}

/// The larger of both; b if a is NaN.
[[nodiscard]] inline FloatLanes larger(const FloatLanes& a, const FloatLanes& b) noexcept { return select_greater(a, b, a, b); }

/// Correctly rounded, as IEEE 754 asks of every processor.
[[nodiscard]] inline FloatLanes sqrt(const FloatLanes& a) noexcept {
    return FloatLanes::each([&](int k) -> FloatLanes::Vector {
#if defined(__AVX512F__)
        return _mm512_maskz_sqrt_ps(0xffff, a.v[k]);
#elif defined(__AVX2__)
        return _mm256_sqrt_ps(a.v[k]);
#elif defined(__x86_64__)
        return _mm_sqrt_ps(a.v[k]);
#else
        FloatLanes::Vector root;
        for (int lane = 0; lane < FloatLanes::native; ++lane) root[lane] = __builtin_sqrtf(a.v[k][lane]);
        return root;
#endif
    });
}

/// The processor's vector number `piece` of wider lanes.
template <int W>
[[nodiscard]] inline Lanes<native_lanes> native_piece(const Lanes<W>& lanes, int piece) noexcept {
    if constexpr (W == native_lanes) {
        return lanes;
    } else {
        constexpr int pieces_of_half = W / 2 / native_lanes;
        return piece < pieces_of_half ? native_piece<W / 2>(lanes.low, piece) : native_piece<W / 2>(lanes.high, piece - pieces_of_half);
    }
}
template <int W>
[[nodiscard]] inline Lanes<W> of_native_pieces(const Lanes<native_lanes>* pieces) noexcept {
    if constexpr (W == native_lanes) {
        return *pieces;
    } else {
        return {of_native_pieces<W / 2>(pieces), of_native_pieces<W / 2>(pieces + W / 2 / native_lanes)};
    }
}

template <int... lane>
[[nodiscard]] inline FloatLanes::Vector joined_floats(FloatLanes::Half low, FloatLanes::Half high, std::integer_sequence<int, lane...>) noexcept {
    return __builtin_shufflevector(low, high, lane...);
}
template <int begin, int... lane>
[[nodiscard]] inline FloatLanes::Half half_of_floats(FloatLanes::Vector v, std::integer_sequence<int, lane...>) noexcept {
    return __builtin_shufflevector(v, v, (begin + lane)...);
}

/// Rounded to the nearest float.
[[nodiscard]] inline FloatLanes narrow(const Lanes<float_lanes>& lanes) noexcept {
    const auto half = [&](int piece) { return __builtin_convertvector(native_piece<float_lanes>(lanes, piece).v, FloatLanes::Half); };
    return FloatLanes::each([&](int k) { return joined_floats(half(2 * k), half(2 * k + 1), std::make_integer_sequence<int, FloatLanes::native>{}); });
}

[[nodiscard]] inline Lanes<float_lanes> widen(const FloatLanes& lanes) noexcept {
    using Vector = Lanes<native_lanes>::Vector;
    constexpr auto all = std::make_integer_sequence<int, native_lanes>{};
    Lanes<native_lanes> pieces[2 * FloatLanes::pieces];
    for (int k = 0; k < FloatLanes::pieces; ++k) {
        pieces[2 * k].v = __builtin_convertvector(half_of_floats<0>(lanes.v[k], all), Vector);
        pieces[2 * k + 1].v = __builtin_convertvector(half_of_floats<native_lanes>(lanes.v[k], all), Vector);
    }
    return of_native_pieces<float_lanes>(pieces);
}

}  // namespace
}  // namespace cvtflow::model
