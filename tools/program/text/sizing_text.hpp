#pragma once
/// Clamping forces and pressures for `check`, as lines and as JSON.

#include <string>
#include <vector>

#include "tasks/sizing/sizing.hpp"

namespace cvtflow::tools {

/// Torque limit of the driven pulley and safety factor, a table with a column per point, and warnings of what the machine cannot do. Empty
/// without pulleys.
[[nodiscard]] std::string sizing_lines(const tasks::Scene& scene, const tasks::Sizing& sizing);
/// Where the scene lies outside of the ranges in which errors are known. @param outside sentences of tasks::outside_validity()
[[nodiscard]] std::string validity_lines(const std::vector<std::string>& outside);
/// Points in SI units; null: not known.
[[nodiscard]] std::string sizing_json(const tasks::Scene& scene, const tasks::Sizing& sizing, const std::vector<std::string>& outside);

}  // namespace cvtflow::tools
