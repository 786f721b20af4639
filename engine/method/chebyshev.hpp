#pragma once
/// Chebyshev methods of order 1, and how far along the real axis they reach.
/// Source: van der Houwen, Sommeijer, On the internal stability of explicit, m-stage Runge-Kutta methods for large m-values,
/// Z. Angew. Math. Mech. 60 (1980) 479-485.

#include "engine/method/stage_plan.hpp"

namespace cvtflow::engine {

/// Order 1, R(z) = T_s(w0 + w1 z)/T_s(w0): |R| ≤ 1/cosh(sqrt(2 ε)), about, inside the interval, so that with ε = 3 five sixths of what is
/// stiff are gone after one step.
/// @param damping ε ≥ 0
/// damping [1]
/// @throws std::invalid_argument for fewer than 2 stages or a negative damping
[[nodiscard]] StagePlan chebyshev(int stages, double damping);

/// Length of its real interval. damping [1]
[[nodiscard]] double chebyshev_reach(int stages, double damping);

}  // namespace cvtflow::engine
