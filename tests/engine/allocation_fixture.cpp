#include "allocation_fixture.hpp"

#include <atomic>
#include <cstddef>

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define CVTFLOW_SANITIZER_OWNS_MALLOC
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define CVTFLOW_SANITIZER_OWNS_MALLOC
#endif

#ifdef CVTFLOW_SANITIZER_OWNS_MALLOC

namespace cvtflow::engine::test {

long allocation_count() noexcept { return -1; }

}  // namespace cvtflow::engine::test

#else

namespace {

std::atomic<long> calls{0};

}  // namespace

/// Entry points of glibc; its malloc may be replaced by a program's definition that shared libraries see.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

[[gnu::visibility("default")]] void* malloc(std::size_t size) {
    calls.fetch_add(1, std::memory_order_relaxed);
    return __libc_malloc(size);
}

[[gnu::visibility("default")]] void* calloc(std::size_t count, std::size_t size) {
    calls.fetch_add(1, std::memory_order_relaxed);
    return __libc_calloc(count, size);
}

[[gnu::visibility("default")]] void* realloc(void* memory, std::size_t size) {
    calls.fetch_add(1, std::memory_order_relaxed);
    return __libc_realloc(memory, size);
}

[[gnu::visibility("default")]] void* aligned_alloc(std::size_t alignment, std::size_t size) {
    calls.fetch_add(1, std::memory_order_relaxed);
    return __libc_memalign(alignment, size);
}
}

namespace cvtflow::engine::test {

long allocation_count() noexcept { return calls.load(std::memory_order_relaxed); }

}  // namespace cvtflow::engine::test

#endif
