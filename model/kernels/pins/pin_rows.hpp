#pragma once
/// Numbers of pins side by side, row by row, while forces on some of them are computed. A column stands for a pin, or for the link behind
/// which it lies. (model/EQUATIONS.md section 10)

#include <algorithm>
#include <array>

#include "model/basis/single_lanes.hpp"
#include "model/force/link_frame.hpp"
#include "model/kernels/pins/rolling.hpp"
#include "model/machine/link_inertia.hpp"

namespace cvtflow::model {
namespace {

/// Offsets inside a whole pin's coordinates for order P, as constants.
template <int P>
inline constexpr ChainLayout pin_at{P, 84, 36, false, false, true};

/// Pins whose forces are computed together, neighbours on each side, and columns of a row: a vector may begin at the last one.
inline constexpr int max_pins = 44, pin_halo = pin_at<0>.halo(), pin_columns = 64;
static_assert(max_pins + 2 * pin_halo + 8 <= pin_columns);

/// Calls body(first column) for vectors of W that cover columns [first, last). Where there are W of them, the last one is moved back to end
/// with them: its columns get the same numbers twice.
template <int W, class Body>
inline void over_columns(int first, int last, const Body& body) noexcept {
    int at = first;
    for (; at + W <= last; at += W) body(at);
    if (at < last) body(std::max(first, last - W));
}

/// `count` rows.
template <int count>
class PinRows {
public:
    template <int W>
    [[nodiscard]] Lanes<W> get(int row, int column) const noexcept {
        return load<W>(numbers_ + row * pin_columns + column);
    }
    template <int W>
    [[nodiscard]] Plane<Lanes<W>> plane(int row, int column) const noexcept {
        return {get<W>(row, column), get<W>(row + 1, column)};
    }
    template <int W>
    void put(int row, int column, const Lanes<W>& value) noexcept {
        value.copy_to(numbers_ + row * pin_columns + column);
    }
    template <int W>
    void put(int row, int column, const Plane<Lanes<W>>& value) noexcept {
        put(row, column, value.x);
        put(row + 1, column, value.y);
    }
    [[nodiscard]] double& number(int row, int column) noexcept { return numbers_[row * pin_columns + column]; }

private:
    alignas(64) double numbers_[count * pin_columns];
};

/// Accelerations from the generalized forces of pins side by side, in place. Modes of even and of odd order do not couple.
/// @param lateral, axial SmallInverse, or the same in another precision
template <int P, int W, class Inverse>
inline void accelerate_pins(const Inverse& lateral, const Inverse& axial, Lanes<W>* f) noexcept {
    using V = Lanes<W>;
    const auto multiply = [](const Inverse& inverse, int size, V* at) {
        const int stride = padded(size);
        std::array<V, max_lateral> product;
        for (int row = 0; row < size; ++row) {
            const auto entry = [&](int k) { return inverse.column[static_cast<std::size_t>(k * stride + row)]; };
            V total = entry(row % 2) * at[row % 2];
            for (int k = row % 2 + 2; k < size; k += 2) total += entry(k) * at[k];
            product[static_cast<std::size_t>(row)] = total;
        }
        for (int row = 0; row < size; ++row) at[row] = product[static_cast<std::size_t>(row)];
    };
    multiply(lateral, P + 1, f);
    multiply(lateral, P + 1, f + P + 1);
    multiply(axial, 2, f + 2 * (P + 1));
}

}  // namespace
}  // namespace cvtflow::model
