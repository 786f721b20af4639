#pragma once
/// Regularized friction (EQUATIONS.md, section 7).

#include "model/parameters/parameters.hpp"
#include "tests/oracle/vectors.hpp"

namespace cvtflow::oracle {

/// s(u): share of the full friction at u = |v|/v0.
Real saturation(const model::Detail& detail, Real u);
/// g(v) = s(|v|/v0)/|v| [s/m]; friction force = -μ N g v.
Real friction_slope(const model::Detail& detail, const model::Friction& friction, Real speed);

}  // namespace cvtflow::oracle
