#pragma once
/// The kernels' entry points: one set of functions per instruction set, chosen once per model.

#include <vector>

#include "model/basis/isa.hpp"
#include "model/chain/chain_model.hpp"
#include "model/contact/friction_operator.hpp"

namespace cvtflow::model {

template <class Real>
struct RigidKernels;  // kernels of rigid pins

/// Each is specialised in the source of its name, which is compiled once per instruction set.
template <Isa isa>
ChainKernels chain_kernels() noexcept;
template <Isa isa>
FrictionKernels friction_kernels() noexcept;
template <Isa isa, class Real>
RigidKernels<Real> rigid_kernels() noexcept;

/// Functions of one instruction set.
struct CompiledKernels {
    Isa isa;
    ChainKernels (*chain)() noexcept;
    FrictionKernels (*friction)() noexcept;
    RigidKernels<double> (*rigid)() noexcept;
    RigidKernels<float> (*rigid_step)() noexcept;
};
/// Whatever this program contains, ascending. The build writes this list (compiled_kernels.cpp.in).
[[nodiscard]] std::vector<CompiledKernels> compiled_kernels();
/// @throws std::invalid_argument if not compiled in
[[nodiscard]] CompiledKernels kernels_of(Isa isa);

}  // namespace cvtflow::model
