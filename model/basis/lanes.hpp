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
        alignas(64) double buffer[W];
        lanes.copy_to(buffer, std::experimental::vector_aligned);
        return sum<W / 2>(load<W / 2>(buffer) + load<W / 2>(buffer + W / 2));
    }
}

/// `chosen` where the mask holds, else `otherwise`.
template <int W>
[[nodiscard]] inline Lanes<W> select(const typename Lanes<W>::mask_type& mask, const Lanes<W>& chosen, Lanes<W> otherwise) noexcept {
    std::experimental::where(mask, otherwise) = chosen;
    return otherwise;
}

template <int W>
[[nodiscard]] inline Lanes<W> positive_part(const Lanes<W>& lanes) noexcept {
    return select<W>(lanes > 0.0, lanes, Lanes<W>(0.0));
}

}  // namespace cvtflow::model
