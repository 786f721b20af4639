#pragma once
/// Positions of the halves of rigid pins, for observations of halves, plates and links.

#include <vector>

#include "model/machine/coefficients.hpp"

namespace cvtflow::model {

/// Layout of what halves_of() gives.
[[nodiscard]] ChainLayout halves_layout(ChainLayout layout) noexcept;

/// The links of a state as those of halves, in halves_layout(); as they are where pins are halves already. state, halves [unknowns]
void halves_of(const Coefficients& coefficients, const double* state, std::vector<double>& halves);

}  // namespace cvtflow::model
