#pragma once
/// The smallest scene after a millisecond of settling, with its state on file: tips touch, everything moves.

#include <string>
#include <vector>

#include "tasks/scene/scene.hpp"

namespace cvtflow::tasks::test {

/// Settled once per process. Serial, until 20 us with outputs every 10 us; settings "key=value" are applied on top.
[[nodiscard]] Scene settled_tiny(const std::vector<std::string>& settings = {});

}  // namespace cvtflow::tasks::test
