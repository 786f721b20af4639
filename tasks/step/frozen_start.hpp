#pragma once
/// A state with the data that are constant while it is frozen: for linear stability and local errors.

#include <vector>

#include "model/variator/chain_model.hpp"

namespace cvtflow::tasks {

/// A state and the phases that hold from there on.
struct FrozenStart {
    double time = 0.0;                 ///< [s]
    std::vector<double> state;         ///< [layout.size()]
    std::vector<model::Phase> phases;  ///< [4 links]
    double suspicion = 0.0;            ///< of the integration that led here (Simulation::suspicion); above 1 the state is wrong [1]
};

}  // namespace cvtflow::tasks
