#pragma once
/// The instruction sets that this program contains and this processor runs, and the choice among them.

#include <string_view>
#include <vector>

#include "model/basis/isa.hpp"

namespace cvtflow::model {

/// Instruction sets that this program contains and this processor runs, ascending; none if it was built for another processor.
[[nodiscard]] std::vector<Isa> usable_isas();
/// The set that the environment variable CVTFLOW_ISA names, else the last usable one.
/// @throws std::invalid_argument if CVTFLOW_ISA names none, or one that is not usable, or if none is
[[nodiscard]] Isa chosen_isa();
/// The one named, "auto" for chosen_isa().
/// @throws std::invalid_argument
[[nodiscard]] Isa isa_named(std::string_view name);

}  // namespace cvtflow::model
