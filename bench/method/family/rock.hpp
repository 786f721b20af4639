#pragma once
/// ROCK4 (Abdulle 2002): order 4 with an embedded order 3, real interval 0.24 stages² for 5, 0.32 for 10, 0.35 from 30 on.

#include "bench/method/product_names.hpp"
#include "engine/method/stage_plan.hpp"

namespace cvtflow::bench {

inline constexpr int min_rock4_stages = 5;
/// Tables could be made for up to 400. But an error in one stage grows like stages⁸·⁸: 100 stages make a thousandth of a rounding error.
inline constexpr int max_rock4_stages = 100;

/// @param stages evaluations of a step; the last stage of the table serves the next step
/// @throws std::invalid_argument outside 5 … 400
[[nodiscard]] StagePlan rock4(int stages);

}  // namespace cvtflow::bench
