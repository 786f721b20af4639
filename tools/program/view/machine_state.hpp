#pragma once
/// States of a record, checked against the layout of its machine, for pictures and exports.

#include <cstddef>

#include "tools/program/view/recorded_run.hpp"

namespace cvtflow::tools {

/// One state of a record. Its size and phases are compared with the machine, because the file may be forged.
/// @throws engine::RecordError for another number of unknowns or phases, and for invalid phases
[[nodiscard]] engine::RecordedState machine_state(const std::string& path, const engine::RunReader& run, std::size_t number,
                                                  const model::ChainLayout& at);

/// Whether all unknowns are finite.
[[nodiscard]] bool finite(const engine::RecordedState& recorded);

}  // namespace cvtflow::tools
