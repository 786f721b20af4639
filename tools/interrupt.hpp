#pragma once
/// Ctrl-C.

#include "engine/executor/cancellation.hpp"

namespace cvtflow::tools {

/// From now on SIGINT and SIGTERM set the returned flag; one that comes half a second or more later ends the
/// program at once, as they do by default.
[[nodiscard]] const engine::Cancellation& catch_interrupts();

}  // namespace cvtflow::tools
