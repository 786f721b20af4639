#pragma once
/// Exceptions of the inside as those of the public interface. Internal to api.

#include <cstddef>
#include <cvtflow/error.hpp>
#include <exception>
#include <new>

#include "api/host/floating_defaults.hpp"
#include "tasks/step/fault.hpp"

namespace cvtflow::api {

/// The public code of a fault; kinds without one of their own are other_fault.
[[nodiscard]] ErrorCode code_of(tasks::FaultKind kind) noexcept;

/// Rethrows the exception in flight as an Error: one of ours stays, lack of memory is memory, anything else is `otherwise`.
[[noreturn]] void rethrow(ErrorCode otherwise);

/// Stack that a calling thread must have left: the kernels keep a link's numbers there. [byte]
inline constexpr std::size_t min_stack = std::size_t{224} << 10U;

/// @throws Error (argument) on a thread with less; not on a process's first thread, whose stack grows, nor on stacks that a host has made
void require_stack();

/// What `action` returns; what it throws, translated.
template <class Action>
auto translated(ErrorCode otherwise, Action&& action) -> decltype(action()) {
    try {
        require_stack();
        return action();
    } catch (...) {
        rethrow(otherwise);
    }
}

/// Every entry point of the interface: what `action` returns in the default floating-point environment; what it throws, translated.
/// Reading a number rounds as the environment is set, so this also applies to scenes.
template <class Action>
auto entered(ErrorCode otherwise, Action&& action) -> decltype(action()) {
    const FloatingDefaults defaults;
    return translated(otherwise, action);
}

}  // namespace cvtflow::api
