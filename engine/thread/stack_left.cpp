#include "engine/thread/stack_left.hpp"

#ifdef _WIN32
#include <windows.h>
#elif defined(__linux__)
#include <pthread.h>
#include <sys/syscall.h>
#include <unistd.h>
#endif

#include <cstdint>
#include <limits>

namespace cvtflow::engine {
namespace {

/// Range of this thread's stack; empty where it can grow or is unknown.
struct Stack {
    std::uintptr_t begin = 0, size = 0;

#ifdef _WIN32
    Stack() noexcept {
        ULONG_PTR lowest = 0, end = 0;
        GetCurrentThreadStackLimits(&lowest, &end);
        begin = lowest, size = end - lowest;
    }
#elif defined(__linux__)
    Stack() noexcept {
        pthread_attr_t attributes;
        if (syscall(SYS_gettid) == getpid() || pthread_getattr_np(pthread_self(), &attributes) != 0) return;
        void* lowest = nullptr;
        std::size_t bytes = 0;
        if (pthread_attr_getstack(&attributes, &lowest, &bytes) == 0) begin = reinterpret_cast<std::uintptr_t>(lowest), size = bytes;
        pthread_attr_destroy(&attributes);
    }
#endif
};

}  // namespace

std::size_t stack_left() noexcept {
    thread_local const Stack stack;
    const auto left = reinterpret_cast<std::uintptr_t>(__builtin_frame_address(0)) - stack.begin;
    return left < stack.size ? left : std::numeric_limits<std::size_t>::max();
}

}  // namespace cvtflow::engine
