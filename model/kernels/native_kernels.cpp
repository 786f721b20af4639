#include "model/kernels/native_kernels.hpp"

namespace cvtflow::model {

template <>
Kernels native_kernels<compiled_isa>() noexcept {
    return {chain_kernels<compiled_isa>(), friction_kernels<compiled_isa>()};
}

}  // namespace cvtflow::model
