#pragma once
/// Derivatives of the whole right-hand side by central differences: for cases without exact derivatives, and for eigenvalues.

#include <vector>

#include "bench/method/product_names.hpp"
#include "model/variator/variator.hpp"

namespace cvtflow::bench {

/// Whether an unknown is a velocity (or a first-order unknown), not a coordinate.
[[nodiscard]] bool is_velocity(const ChainLayout& layout, int index) noexcept;

/// ∂(slope)/∂(state) with phases held: [unknowns × unknowns], column by column. t [s], state [unknowns]
[[nodiscard]] std::vector<double> difference_jacobian(const Variator& variator, double t, const std::vector<double>& state,
                                                      const std::vector<Phase>& phases);

}  // namespace cvtflow::bench
