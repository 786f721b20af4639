#pragma once
/// Parts of the kernels of the instruction set that a source is compiled for.

#include "model/basis/native_lanes.hpp"
#include "model/kernels/kernels.hpp"

namespace cvtflow::model {

/// Each is specialised in the source of its name.
template <Isa isa>
ChainKernels chain_kernels() noexcept;
template <Isa isa>
FrictionKernels friction_kernels() noexcept;

template <>
ChainKernels chain_kernels<compiled_isa>() noexcept;
template <>
FrictionKernels friction_kernels<compiled_isa>() noexcept;

}  // namespace cvtflow::model
