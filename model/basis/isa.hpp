#pragma once
/// Instruction sets that the kernels are compiled for, and which of them runs. Results are bitwise the same for all.

#include <string_view>
#include <vector>

namespace cvtflow::model {

/// Ascending: a later one needs a newer processor. Other architectures than x86-64 have the baseline only (NEON on ARM).
enum class Isa { baseline, avx2, avx512 };

/// Doubles in one of its vectors: so many links side by side.
[[nodiscard]] constexpr int lanes_of(Isa isa) noexcept { return isa == Isa::avx512 ? 8 : isa == Isa::avx2 ? 4 : 2; }
/// "baseline", "avx2", "avx512".
[[nodiscard]] std::string_view name_of(Isa isa) noexcept;
/// Those that this program contains and this processor runs, ascending; never empty.
[[nodiscard]] std::vector<Isa> usable_isas();
/// What the environment's CVTFLOW_ISA names, else the last usable one.
/// @throws std::invalid_argument if CVTFLOW_ISA names none, or one that is not usable
[[nodiscard]] Isa chosen_isa();
/// The one named, "auto" for chosen_isa().
/// @throws std::invalid_argument
[[nodiscard]] Isa isa_named(std::string_view name);

}  // namespace cvtflow::model
