#pragma once
/// Variants of the kernels: instruction sets, of which one runs. Results are bitwise the same for all of them.

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

}  // namespace cvtflow::model
