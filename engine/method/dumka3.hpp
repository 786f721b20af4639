#pragma once
/// DUMKA3, explicit methods of order 3 with long real stability intervals, and their coefficients.
/// Source: A. A. Medovikov, High order explicit methods for parabolic equations, BIT 38 (1998) 372-390, values as in his published program.
///
/// Degrees 3, 6, 9, 15, 21, 27, 36, 48, 63, 81, 135, 189, 243, 324. The published P13 has two roots twice, misses two others
/// and is neither stable nor of order 3. Here the missing roots 3.928550119760627e-05 and 1.9737941311788493e-05 are put back in
/// place of the repeated ones, and the finish is solved from the order conditions again.

#include "engine/method/stage_plan.hpp"

namespace cvtflow::engine {

inline constexpr int dumka3_polynomials = 14;

/// |R| ≤ 1 on [-dumka3_reach, 0] [1]. @throws std::out_of_range unless 0 ≤ polynomial < dumka3_polynomials
[[nodiscard]] double dumka3_reach(int polynomial);

/// Plan "dumka3-p5": s - 3 chained Euler steps, then a finish of two stages that carries the complex pair of roots, then one Euler step.
/// Two state slots and two slope slots take turns along the chain, whatever the degree; the finish needs two slopes more. The error
/// estimate is that of his program: h (c3/2 (f1 - f3) + (c4 - c2)/2 (f2 - f0)) of the finish.
/// @throws std::out_of_range as dumka3_reach()
[[nodiscard]] StagePlan dumka3(int polynomial);

}  // namespace cvtflow::engine
