#include "api/host/translate.hpp"

#include <pthread.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdint>
#include <string>

#include "engine/base/error_text.hpp"

namespace cvtflow::api {

ErrorCode code_of(tasks::FaultKind kind) noexcept {
    using tasks::FaultKind;
    if (kind == FaultKind::none) return ErrorCode::none;
    if (kind == FaultKind::non_finite) return ErrorCode::non_finite;
    if (kind == FaultKind::penetration) return ErrorCode::penetration;
    if (kind == FaultKind::left_sheave) return ErrorCode::left_sheave;
    if (kind == FaultKind::max_steps) return ErrorCode::max_steps;
    if (kind == FaultKind::max_wall) return ErrorCode::max_wall;
    if (kind == FaultKind::cancelled) return ErrorCode::cancelled;
    if (kind == FaultKind::blow_up) return ErrorCode::blow_up;
    return ErrorCode::other_fault;
}

namespace {

/// Where the stack of this thread lies; nothing where it can grow or is unknown.
struct Stack {
    std::uintptr_t begin = 0, size = 0;

    Stack() noexcept {
        pthread_attr_t attributes;
        if (syscall(SYS_gettid) == getpid() || pthread_getattr_np(pthread_self(), &attributes) != 0) return;
        void* lowest = nullptr;
        std::size_t bytes = 0;
        if (pthread_attr_getstack(&attributes, &lowest, &bytes) == 0) begin = reinterpret_cast<std::uintptr_t>(lowest), size = bytes;
        pthread_attr_destroy(&attributes);
    }
};

}  // namespace

void require_stack() {
    thread_local const Stack stack;
    const auto left = reinterpret_cast<std::uintptr_t>(__builtin_frame_address(0)) - stack.begin;
    if (left >= stack.size || left >= least_stack) return;  // the first: another stack than the thread began with
    throw Error(ErrorCode::argument, "the calling thread has " + std::to_string(left >> 10U) + " KiB of stack left; 256 KiB are needed");
}

void rethrow(ErrorCode otherwise) {
    try {
        throw;
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::memory, "no memory");
    } catch (const std::exception& error) {
        throw Error(otherwise, engine::error_text(error));
    }
}

}  // namespace cvtflow::api
