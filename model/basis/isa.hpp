#pragma once
/// Variants of the kernels: instruction sets, of which one runs, and polynomial orders of a pin's bending. Results are bitwise
/// the same for all instruction sets.

#include <array>
#include <cstddef>
#include <string_view>

namespace cvtflow::model {

/// Ascending: a later one needs a newer processor. Other architectures than x86-64 have the baseline only (NEON on ARM).
enum class Isa { baseline, avx2, avx512 };

/// Number of doubles in a vector of the set, which is the number of links side by side.
[[nodiscard]] constexpr int lanes_of(Isa isa) noexcept { return isa == Isa::avx512 ? 8 : isa == Isa::avx2 ? 4 : 2; }
inline constexpr std::array<std::string_view, 3> isa_names{"baseline", "avx2", "avx512"};
[[nodiscard]] constexpr std::string_view name_of(Isa isa) noexcept { return isa_names[static_cast<std::size_t>(isa)]; }

inline constexpr int max_order = 3;

/// Result of make.operator()<P>() for P = order.
/// @param order 0 … max_order [1]
template <class Make>
constexpr auto of_order(int order, Make make) noexcept {
    static_assert(max_order == 3);
    switch (order) {
        case 0: return make.template operator()<0>();
        case 1: return make.template operator()<1>();
        case 2: return make.template operator()<2>();
        default: return make.template operator()<3>();
    }
}

}  // namespace cvtflow::model
