#pragma once
/// Peak performance of this processor.

#include "model/basis/isa.hpp"

namespace cvtflow::bench {

/// Additions and multiplications per second in vectors of an instruction set, measured; 0 if this program was compiled for narrower ones.
[[nodiscard]] double peak_flops(model::Isa isa);

}  // namespace cvtflow::bench
