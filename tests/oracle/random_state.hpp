#pragma once
/// Random states in which every force term is active, for comparing right-hand sides.

#include "model/parameters/chain_layout.hpp"
#include "model/parameters/parameters.hpp"

#include <cstdint>
#include <vector>

namespace cvtflow::oracle {

struct RandomState {
    std::vector<double> state;
    std::vector<model::Phase> phases;  ///< one per tip
};

/// A geometric start (model/start, which tests/claims/geometry_test.cpp checks) with joint depths of a few µm, stretched plates, some
/// joints beyond their clearance, tips in the arcs 5–15 µm deep in the sheaves (with one pitch; with mixed pitches the deepest is so), all
/// coordinates disturbed by µm and all velocities by some cm/s. Phases touch where tips are deep, with about one in ten flipped. Rigid
/// pins have no joint depths, some links that push, tilts of some 10 µm and phases as deep as their tips are. A seed gives the same state
/// on every machine.
RandomState random_state(const model::Parameters& parameters, std::uint64_t seed);

}  // namespace cvtflow::oracle
