#pragma once
/// Number of doubles in a vector of the processor, by the compiler's flags. bench/one_lane replaces this header.

#include "model/basis/isa.hpp"

namespace cvtflow::model {
namespace {

/// Doubles in a vector.
#if defined(__AVX512F__)
inline constexpr int native_lanes = 8;
inline constexpr Isa compiled_isa = Isa::avx512;
#elif defined(__AVX2__)
inline constexpr int native_lanes = 4;
inline constexpr Isa compiled_isa = Isa::avx2;
#else  // SSE2, NEON and the like
inline constexpr int native_lanes = 2;
inline constexpr Isa compiled_isa = Isa::baseline;
#endif

inline constexpr bool slopes_alone = false;  ///< chain kernels have nothing but slopes without accounts (bench/one_lane)

}  // namespace
}  // namespace cvtflow::model
