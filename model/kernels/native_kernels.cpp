#include "model/kernels/native_kernels.hpp"

namespace cvtflow::model {

template <>
Kernels native_kernels<compiled_isa>(int order) noexcept {
    return {chain_kernels<compiled_isa>(order), friction_kernels<compiled_isa>(order)};
}

}  // namespace cvtflow::model
