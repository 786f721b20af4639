#pragma once
/// The kernels' entry points: one set of functions per instruction set, chosen once per model.

#include <vector>

#include "model/basis/isa.hpp"
#include "model/chain/chain_model.hpp"
#include "model/contact/friction_operator.hpp"

namespace cvtflow::model {

/// Defined in chain_kernels.cpp, which is compiled once per instruction set. @param order p, 0 … 3
template <Isa isa>
ChainKernels chain_kernels(int order) noexcept;
template <>
ChainKernels chain_kernels<Isa::baseline>(int order) noexcept;
template <>
ChainKernels chain_kernels<Isa::avx2>(int order) noexcept;
template <>
ChainKernels chain_kernels<Isa::avx512>(int order) noexcept;

/// Defined in friction_kernels.cpp, likewise.
template <Isa isa>
FrictionKernels friction_kernels(int order) noexcept;
template <>
FrictionKernels friction_kernels<Isa::baseline>(int order) noexcept;
template <>
FrictionKernels friction_kernels<Isa::avx2>(int order) noexcept;
template <>
FrictionKernels friction_kernels<Isa::avx512>(int order) noexcept;

/// Defined in single_kernels.cpp, likewise: friction in single precision.
template <Isa isa>
SingleFrictionKernels single_kernels(int order) noexcept;
template <>
SingleFrictionKernels single_kernels<Isa::baseline>(int order) noexcept;
template <>
SingleFrictionKernels single_kernels<Isa::avx2>(int order) noexcept;
template <>
SingleFrictionKernels single_kernels<Isa::avx512>(int order) noexcept;

struct CompiledKernels {
    Isa isa;
    ChainKernels (*chain)(int order) noexcept;
    FrictionKernels (*friction)(int order) noexcept;
    SingleFrictionKernels (*single)(int order) noexcept;
};
/// Whatever this program contains, ascending. The build writes this list (compiled_kernels.cpp.in).
[[nodiscard]] std::vector<CompiledKernels> compiled_kernels();
/// @throws std::invalid_argument if not compiled in
[[nodiscard]] CompiledKernels kernels_of(Isa isa);

}  // namespace cvtflow::model
