#pragma once
/// Regularized friction (EQUATIONS.md, section 7).

#include "model/parameters/parameters.hpp"
#include "tests/oracle/vectors.hpp"

namespace cvtflow::oracle {

/// s(u): share of the full friction at u = |v|/v0.
Real saturation(const model::Detail& detail, Real u);
/// g(v) = s(|v|/v0)/|v| [s/m]; friction force = -μ N g v.
Real friction_slope(const model::Detail& detail, const model::Friction& friction, Real speed);

/// Factor on a tip's friction by its law (table or lubricated contact) and by the Hertz pressure of its depth [m].
Real tip_law_factor(const model::Parameters& parameters, Real speed, Real depth);

}  // namespace cvtflow::oracle
