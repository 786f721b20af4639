#pragma once
/// Stack that is left to a caller.

#include <cstddef>

namespace cvtflow::engine {

/// Bytes of stack that the calling thread has left; the largest number where that is unknown: on a process's first thread, whose stack
/// grows, and on stacks that a host has made itself.
[[nodiscard]] std::size_t stack_left() noexcept;

}  // namespace cvtflow::engine
