#include "model/kernels/kernels.hpp"

#include <stdexcept>
#include <string>

namespace cvtflow::model {

CompiledKernels kernels_of(Isa isa) {
    for (const CompiledKernels& kernels : compiled_kernels()) {
        if (kernels.isa == isa) return kernels;
    }
    throw std::invalid_argument("instruction set \"" + std::string(name_of(isa)) + "\" is not compiled in");
}

}  // namespace cvtflow::model
