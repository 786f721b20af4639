#pragma once
/// Replaces model/basis/native_lanes.hpp where the kernels are compiled for comparison as plain scalar code: vectors of one lane.

#include "model/basis/isa.hpp"

namespace cvtflow::model {
namespace {

inline constexpr int native_lanes = 1;
#ifdef CVTFLOW_ONE_LANE  // a program with these kernels, as its baseline
inline constexpr Isa compiled_isa = Isa::baseline;
inline constexpr bool slopes_alone = false;
#else  // no instruction set of the program: only the bench knows it
inline constexpr Isa compiled_isa = static_cast<Isa>(-1);
inline constexpr bool slopes_alone = true;
#endif

}  // namespace
}  // namespace cvtflow::model
