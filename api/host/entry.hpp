#pragma once
/// Calls of hosts: default floating-point environment, enough stack, public exceptions, checked pointers. Internal to api.

#include <cfenv>
#include <cstddef>
#include <cvtflow/error.hpp>
#include <exception>
#include <new>
#include <span>
#include <string>

#include "tasks/step/fault.hpp"

namespace cvtflow::api {

/// Sets round to nearest, denormals kept, traps off; restores the host's environment on destruction, exception flags included.
class FloatingDefaults {
public:
    FloatingDefaults() noexcept { enter(); }
    ~FloatingDefaults() { leave(); }
    FloatingDefaults(const FloatingDefaults&) = delete;
    FloatingDefaults& operator=(const FloatingDefaults&) = delete;

    /// The host's environment again while its callback runs, which may change it.
    class Outside {
    public:
        explicit Outside(FloatingDefaults& defaults) noexcept : defaults_(defaults) { defaults_.leave(); }
        ~Outside() { defaults_.enter(); }
        Outside(const Outside&) = delete;
        Outside& operator=(const Outside&) = delete;

    private:
        FloatingDefaults& defaults_;
    };

private:
    void enter() noexcept {
        std::fegetenv(&found_);
        std::fesetenv(FE_DFL_ENV);
    }
    void leave() noexcept { std::fesetenv(&found_); }

    std::fenv_t found_;
};

/// "cancelled", "non_finite", …; "unknown" for a number that is no code
[[nodiscard]] const char* code_name(ErrorCode code) noexcept;

/// The public code with the name of a fault; kinds without a code are other_fault.
[[nodiscard]] ErrorCode code_of(const tasks::Fault& fault);

/// Rethrows the exception in flight as an Error: one of ours stays, lack of memory is memory, anything else is `otherwise`.
[[noreturn]] void rethrow(ErrorCode otherwise);

/// Stack that a calling thread must have left: the kernels keep a link's numbers there. [byte]
inline constexpr std::size_t min_stack = std::size_t{224} << 10U;

/// @throws Error (argument) on a thread with less; not on a process's first thread, whose stack grows, nor on stacks that a host has made
void require_stack();

/// Result of `action`; its exceptions are translated.
template <class Action>
auto translated(ErrorCode otherwise, Action&& action) -> decltype(action()) {
    try {
        require_stack();
        return action();
    } catch (...) {
        rethrow(otherwise);
    }
}

/// Every entry point of the interface: result of `action` in the default floating-point environment; its exceptions are translated. Reading
/// a number rounds as the environment is set, so this also applies to scenes.
template <class Action>
auto entered(ErrorCode otherwise, Action&& action) -> decltype(action()) {
    const FloatingDefaults defaults;
    return translated(otherwise, action);
}

/// The object behind a pointer. @throws Error (argument) that names what is NULL
template <class T>
T& given(T* pointer, const char* name) {
    if (pointer == nullptr) throw Error(ErrorCode::argument, std::string(name) + " is NULL");
    return *pointer;
}

/// The `count` objects behind a pointer, which may be NULL if there are none. @throws Error (argument) as above
template <class T>
std::span<T> given(T* first, std::size_t count, const char* name) {
    return count == 0 ? std::span<T>() : std::span<T>(&given(first, name), count);
}

}  // namespace cvtflow::api
