#pragma once
/// Forces inside a chain of rigid pins at one instant.

#include "model/observe/chain_forces.hpp"
#include "model/variator/rigid/rigid_chain.hpp"

namespace cvtflow::model {

/// Evaluates the chain. Bending moments, and friction between the halves of a pin along its length, do not exist there and stay as they
/// are.
/// @param state [unknowns]   @param sheaves [4], unused without pulleys   @param forces with room for all
void observe_rigid_forces(const RigidChain& chain, const double* state, const SheaveMotion* sheaves, ChainForces& forces) noexcept;

}  // namespace cvtflow::model
