#pragma once
/// Geometric start: a closed chain with every joint just touching (or pre-tensioned against its own centrifugal pull), every plate at its
/// free length, sheaves just touching the tips, velocities of running without slip. (model/EQUATIONS.md)

#include <vector>

#include "model/parameters/chain_layout.hpp"
#include "model/start/belt.hpp"

namespace cvtflow::model {

struct StartState {
    std::vector<double> state;  ///< [layout.size()]
    std::vector<Phase> phases;  ///< [4 links], all free: the first step finds what touches
    BeltRadii radii;            ///< of the pitch path [m]
    double speed;               ///< of the chain [m/s]
};

/// State at the begin of settling. Throws std::invalid_argument if the chain does not close around the pulleys at the given ratio.
[[nodiscard]] StartState start_state(const Parameters& parameters);

/// Mass of one pitch of the chain [kg].
[[nodiscard]] double link_mass(const Parameters& parameters) noexcept;

}  // namespace cvtflow::model
