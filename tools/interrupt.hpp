#pragma once
/// Ctrl-C.

#include <atomic>

namespace cvtflow::tools {

/// From now on SIGINT and SIGTERM set the returned flag; a second one ends the program at once, as they do by default.
[[nodiscard]] const std::atomic<bool>& catch_interrupts();

}  // namespace cvtflow::tools
