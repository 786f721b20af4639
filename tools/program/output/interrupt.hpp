#pragma once
/// Ctrl-C, and the other ways in which a run is asked to end.

#include "engine/executor/cancellation.hpp"

namespace cvtflow::tools {

/// From now on engine::ending_signals() set the returned flag; one of a user (not SIGXCPU, not SIGPIPE) that comes half a second or more
/// later ends the program at once, as they do by default.
[[nodiscard]] const engine::Cancellation& catch_interrupts();

}  // namespace cvtflow::tools
