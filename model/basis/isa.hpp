#pragma once
/// What the kernels are compiled for: instruction sets, of which one runs, and polynomial orders of a pin's bending. Results are bitwise
/// the same for all instruction sets.

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

inline constexpr int max_order = 3;

/// What make.operator()<P>() gives for P = order.
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

/// True: a product and a sum are rounded once, so that results depend on the instruction set and on the assembly. They still do not depend
/// on threads, segments or executors.
[[nodiscard]] bool fuses_multiply_add() noexcept;

}  // namespace cvtflow::model
