#pragma once
/// Makes a chain, and its friction, with the kernels of an instruction set.

#include "model/chain/chain_model.hpp"
#include "model/kernels/available_isas.hpp"

namespace cvtflow::model {

class FrictionOperator;

/// @param isa which kernels run; results do not depend on it
/// @throws std::invalid_argument if the instruction set is not compiled in
[[nodiscard]] ChainModel make_chain(const Parameters& parameters, Isa isa = chosen_isa());

/// Friction of a chain, which must outlive it, with the kernels of the chain's instruction set.
/// @param by_phase whether the branch of the law is that of the tip's phase (detail.stick_slip)
[[nodiscard]] FrictionOperator make_friction(const ChainModel& chain, bool by_phase);

}  // namespace cvtflow::model
