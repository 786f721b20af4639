#pragma once
/// Signals that end a run: Ctrl-C and others.

#include "engine/executor/cancellation.hpp"

namespace cvtflow::tools {

/// Installs handlers: engine::ending_signals() set the returned flag. A further signal of a user (not SIGXCPU, not SIGPIPE) at least half a
/// second later ends the program at once.
[[nodiscard]] const engine::Cancellation& catch_interrupts();

}  // namespace cvtflow::tools
