#pragma once
/// Blocks of pins side by side, and how their columns are read and written. (model/EQUATIONS.md section 11)

#include <algorithm>
#include <array>
#include <type_traits>

#include "model/variator/rigid/rigid_vectors.hpp"

namespace cvtflow::model {
namespace {

/// Pins side by side, of which the first `count` are meant: the others, if any, are copies or are in another block as well.
struct PinBlock {
    int first, count;

    /// 1 for pins that are meant.
    [[nodiscard, gnu::always_inline]] PinLanes present() const noexcept { return first_lanes(count); }
};

/// Block of the pins from i = 0, 8, 16 … on.
[[nodiscard]] inline PinBlock aligned_block(const RigidColumns& columns, int i) noexcept {
    return {i, std::min(rigid_lanes, columns.pins() - i)};
}

/// Columns of pins side by side, in blocks of eight.
/// @tparam W width of what is computed from them
template <int W>
class PinBlocks {
public:
    using D = DoublesOf<W>;
    using PlaneD = DoublePlaneOf<W>;
    static constexpr int lanes = lane_count<W>, blocks = lanes / rigid_lanes;
    using Blocks = std::array<PinBlock, blocks>;

    PinBlocks(RigidColumns& columns, const Blocks& own) noexcept : columns_(columns), view_(columns), own_(own) {}

protected:
    /// Entries of a column for all pins, or for those so many before or behind them.
    [[nodiscard, gnu::always_inline]] D read_pins(Column c, int offset = 0) const noexcept {
        if constexpr (blocks == 1) {
            return read(view_, c, own_[0].first + offset);
        } else {
            return {read(view_, c, own_[0].first + offset), read(view_, c, own_[1].first + offset)};
        }
    }
    [[nodiscard, gnu::always_inline]] PlaneD read_plane_of(Column c, int offset = 0) const noexcept {
        return {read_pins(c, offset), read_pins(c + 1, offset)};
    }
    [[gnu::always_inline]] void write_pins(Column c, const D& values) noexcept {
        over_blocks([&](auto block) { write(view_, c, own_[static_cast<std::size_t>(block)].first, piece(values, block)); });
    }
    /// Numbers of the pins of one block.
    [[nodiscard, gnu::always_inline]] static PinLanes piece(const D& values, int block) noexcept {
        if constexpr (blocks == 1) {
            return values;
        } else {
            return half<lanes>(values, block);
        }
    }
    /// Calls visit(block) for each of them, its number known when this is compiled.
    template <class Visit>
    [[gnu::always_inline]] static void over_blocks(const Visit& visit) noexcept {
        visit(std::integral_constant<int, 0>{});
        if constexpr (blocks == 2) visit(std::integral_constant<int, 1>{});
    }
    /// 1 for pins that are meant.
    [[nodiscard, gnu::always_inline]] Lanes<W> present() const noexcept {
        if constexpr (blocks == 1) {
            return own_[0].present();
        } else {
            return as<W>(D{own_[0].present(), own_[1].present()});
        }
    }

    RigidColumns& columns_;
    const RigidView view_;
    Blocks own_;
};

}  // namespace
}  // namespace cvtflow::model
