#pragma once
/// Whether the kernels were compiled with fused multiply-adds (CMake option CVTFLOW_FMA).

namespace cvtflow::model {

/// True: a product and a sum are rounded once, so that results depend on the instruction set and on the assembly. They still do not depend
/// on threads, segments or executors.
[[nodiscard]] bool fuses_multiply_add() noexcept;

}  // namespace cvtflow::model
