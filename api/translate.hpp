#pragma once
/// Exceptions of the inside as those of the public interface. Internal to api.

#include <cvtflow/error.hpp>
#include <exception>
#include <new>

#include "tasks/fault.hpp"

namespace cvtflow::api {

/// The public code of a fault; kinds without one of their own are other_fault.
[[nodiscard]] ErrorCode code_of(tasks::FaultKind kind) noexcept;

/// Rethrows the exception in flight as an Error: one of ours stays, lack of memory is memory, anything else is `otherwise`.
[[noreturn]] void rethrow(ErrorCode otherwise);

/// What `action` returns; what it throws, translated.
template <class Action>
auto translated(ErrorCode otherwise, Action&& action) -> decltype(action()) {
    try {
        return action();
    } catch (...) {
        rethrow(otherwise);
    }
}

}  // namespace cvtflow::api
