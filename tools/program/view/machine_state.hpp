#pragma once
/// States of a record as its machine has them: what a picture or an export indexes by link, tip and shaft.

#include <cstddef>

#include "tools/program/view/recorded_run.hpp"

namespace cvtflow::tools {

/// One state of a record. Everything that a record's writer could have made up is compared with the machine first.
/// @throws engine::RecordError for another number of unknowns or phases, and for invalid phases
[[nodiscard]] engine::RecordedState machine_state(const std::string& path, const engine::RunReader& run, std::size_t number,
                                                  const model::ChainLayout& at);

/// Whether all unknowns are finite.
[[nodiscard]] bool finite(const engine::RecordedState& recorded);

}  // namespace cvtflow::tools
