#pragma once
/// Scenes and helpers shared by the tests of the oracle.

#include "tests/oracle/plain_rhs.hpp"
#include "tests/oracle/random_state.hpp"
#include "tests/oracle/vectors.hpp"

#include <string>
#include <vector>

namespace cvtflow::oracle {

struct Case {
    std::string name;
    model::Parameters parameters;
};

/// A short chain of long links of two pitches, with few plates: everything the model has, at little cost.
model::Parameters small_scene();
/// All combinations of plates each/lumped, joint points 1, 3, 8, both joint laws, and pulleys elastic/rigid/absent; quick:
/// nine that contain every pair of two of these.
std::vector<Case> all_details(const model::Parameters& base);
/// The machine of these parameters with rigid pins.
model::Parameters with_rigid_pins(model::Parameters parameters);
/// Rigid pins: all combinations of pulleys and friction laws, with two laws of tips for each of the piecewise ones.
std::vector<Case> rigid_details(const model::Parameters& base);
/// No friction, no damping.
void make_conservative(model::Parameters& parameters);

/// A random state in full precision, with its phases.
struct ExactState {
    std::vector<Real> state;
    std::vector<model::Phase> phases;
};
ExactState exact_random_state(const model::Parameters& parameters, std::uint64_t seed);

/// Index in the state of every generalized coordinate, in the order of q; its rate is at the same place of `rate_indices`.
std::vector<int> coordinate_indices(const model::ChainLayout& layout);
std::vector<int> rate_indices(const model::ChainLayout& layout);

Real potential_energy(const model::Parameters& parameters, const ExactState& at);

}  // namespace cvtflow::oracle
