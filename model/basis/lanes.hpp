#pragma once
/// Vector lanes inside one link: its plates, the points of one of its joints, its four tips. A lane count is a compile-time constant,
/// padding lanes carry weight zero, and sums are taken in one fixed tree: results do not depend on the instruction set.

#include <experimental/simd>

namespace cvtflow::model {

template <int W>
using Lanes = std::experimental::fixed_size_simd<double, W>;

template <int W>
[[nodiscard]] inline Lanes<W> load(const double* from) noexcept {
    return Lanes<W>(from, std::experimental::element_aligned);
}

/// Sum in a fixed order: halves are added to each other until one is left.
template <int W>
[[nodiscard]] inline double sum(const Lanes<W>& lanes) noexcept {
    if constexpr (W == 1) {
        return lanes[0];
    } else {
        alignas(128) double buffer[W];
        lanes.copy_to(buffer, std::experimental::vector_aligned);
        return sum<W / 2>(load<W / 2>(buffer) + load<W / 2>(buffer + W / 2));
    }
}

/// `chosen` where a > b, else `otherwise`; false for NaN.
/// clang 14 compiles `where` of libstdc++'s fixed-size lanes to wrong code (masks of AVX-512 and of AVX2 alike: tests/model/basis/lanes_test.cpp
/// shows it), so there the choice is made by the compiler's own vectors. Same bits either way.
template <int W>
[[nodiscard]] inline Lanes<W> select_greater(const Lanes<W>& a, const Lanes<W>& b, const Lanes<W>& chosen, Lanes<W> otherwise) noexcept {
    if constexpr (W == 1) {
        return a[0] > b[0] ? chosen : otherwise;
    } else {
#if defined(__clang__)
        using Vector = double __attribute__((vector_size(W * sizeof(double))));
        const auto vector = [](const Lanes<W>& lanes) {
            alignas(128) double buffer[W];
            lanes.copy_to(buffer, std::experimental::element_aligned);
            Vector value;
            __builtin_memcpy(&value, buffer, sizeof value);
            return value;
        };
        const Vector result = vector(a) > vector(b) ? vector(chosen) : vector(otherwise);
        alignas(128) double buffer[W];
        __builtin_memcpy(buffer, &result, sizeof result);
        return load<W>(buffer);
#else
        std::experimental::where(a > b, otherwise) = chosen;
        return otherwise;
#endif
    }
}

/// The larger of both; b if a is NaN.
template <int W>
[[nodiscard]] inline Lanes<W> larger(const Lanes<W>& a, const Lanes<W>& b) noexcept {
    return select_greater<W>(a, b, a, b);
}

template <int W>
[[nodiscard]] inline Lanes<W> positive_part(const Lanes<W>& lanes) noexcept {
    return larger<W>(lanes, Lanes<W>(0.0));
}

/// Whether no lane exceeds a limit; false for NaN.
template <int W>
[[nodiscard]] inline bool all_at_most(const Lanes<W>& lanes, double limit) noexcept {
    bool all = true;
    for (int lane = 0; lane < W; ++lane) all = all && lanes[lane] <= limit;
    return all;
}

}  // namespace cvtflow::model
