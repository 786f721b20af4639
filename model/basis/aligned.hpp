#pragma once
/// Memory that begins on a cache line: vectors of the processor that cross lines take twice as long to load.

#include <cstddef>
#include <new>
#include <vector>

namespace cvtflow::model {

inline constexpr std::size_t cache_line = 64;

template <class T>
struct LineAllocator {
    using value_type = T;
    LineAllocator() = default;
    template <class U>
    LineAllocator(const LineAllocator<U>&) noexcept {}
    [[nodiscard]] T* allocate(std::size_t count) {
        return static_cast<T*>(::operator new(count * sizeof(T), std::align_val_t(cache_line)));
    }
    void deallocate(T* memory, std::size_t) noexcept { ::operator delete(memory, std::align_val_t(cache_line)); }
    bool operator==(const LineAllocator&) const noexcept { return true; }
};

/// A vector whose first element begins a cache line.
template <class T>
using LineVector = std::vector<T, LineAllocator<T>>;

}  // namespace cvtflow::model
