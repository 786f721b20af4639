#pragma once
/// How the tips' friction couples the pins to the rotation of their pulleys. (model/EQUATIONS.md section 9)

#include <array>

#include "model/variator/chain_model.hpp"

namespace cvtflow::model {

/// Sums over the tips of each pulley. Sliding along the circumference at speed v_θ, on radius r, against a sheave.
struct Creep {
    std::array<double, 2> hold{};  ///< Σ μ N g r²: moment of friction on the shaft per speed of the shaft [N·m·s]
    std::array<double, 2> drag{};  ///< Σ μ N g r v_θ: moment of friction on the shaft [N·m]
    double power = 0.0;            ///< Σ μ N g v_θ², of both pulleys: lost by sliding along the circumference, ≥ 0 [W]
};

/// Of rigid pins: what the chain's last evaluation has found, which must have been of this state.
/// Serial, about a third of an evaluation of the chain; sums are in the order of the links. state [unknowns], sheaves [4], phases [4 links]
[[nodiscard]] Creep observe_creep(const ChainModel& chain, const double* state, const SheaveMotion* sheaves, const Phase* phases) noexcept;

}  // namespace cvtflow::model
