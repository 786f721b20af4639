#pragma once
/// The kernels' entry points: one set of functions per instruction set, chosen once per model.

#include <vector>

#include "model/basis/isa.hpp"
#include "model/chain/chain_model.hpp"
#include "model/contact/friction_operator.hpp"

namespace cvtflow::model {

/// Functions of one instruction set.
struct Kernels {
    ChainKernels chain;
    FrictionKernels friction;
};
struct RigidKernels;  // of rigid pins

/// Specialised in native_kernels.cpp, which is compiled once per instruction set.
template <Isa isa>
Kernels native_kernels() noexcept;
/// Specialised in rigid_kernels.cpp, likewise.
template <Isa isa>
RigidKernels rigid_kernels() noexcept;

struct CompiledKernels {
    Isa isa;
    Kernels (*halves)() noexcept;
    RigidKernels (*rigid)() noexcept;
};
/// Whatever this program contains, ascending. The build writes this list (compiled_kernels.cpp.in).
[[nodiscard]] std::vector<CompiledKernels> compiled_kernels();
/// @throws std::invalid_argument if not compiled in
[[nodiscard]] CompiledKernels kernels_of(Isa isa);

}  // namespace cvtflow::model
