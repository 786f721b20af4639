#pragma once
/// Memory of fields over links, laid out component by component. It begins on a cache line: vectors of the processor that cross lines take
/// twice as long to load.

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

/// Columns of numbers, one row per component, each row on separate cache lines. Column 1, where links begin, begins a cache line. A whole
/// line may be read from any column on. Rows are an odd number of lines apart, so that one column's numbers do not meet in few sets of a
/// cache.
template <class Number>
class ColumnsOf {
public:
    static constexpr int line = static_cast<int>(cache_line / sizeof(Number));
    /// Numbers that may be read and written before column 0.
    static constexpr int before_first = line - 1;

    ColumnsOf() = default;
    ColumnsOf(int components, int columns) : stride_(((columns + before_first + 2 * line - 1) / line | 1) * line) {
        memory_.assign(static_cast<std::size_t>(components * stride_ + 2 * line), Number(0));
    }

    [[nodiscard]] Number* at(std::ptrdiff_t component, std::ptrdiff_t column) noexcept { return data() + component * stride_ + column; }
    [[nodiscard]] const Number* at(std::ptrdiff_t component, std::ptrdiff_t column) const noexcept {
        return data() + component * stride_ + column;
    }
    [[nodiscard]] std::size_t bytes() const noexcept { return memory_.size() * sizeof(Number); }
    [[nodiscard]] int stride() const noexcept { return static_cast<int>(stride_); }
    [[nodiscard]] const Number* data() const noexcept { return memory_.data() + before_first; }
    [[nodiscard]] Number* data() noexcept { return memory_.data() + before_first; }

private:
    LineVector<Number> memory_;
    std::ptrdiff_t stride_ = 0;
};
using Columns = ColumnsOf<double>;
using FloatColumns = ColumnsOf<float>;

/// Coefficients and solution of a ring of equations, in the order of RingShares (ring_solver.hpp): entry row · lanes + lane.
template <class Real>
struct RingRows {
    Real *rhs, *own, *back, *on;
    Real *upper, *lower;  ///< factors of the next row, and of the last row of the lane before
    Real* solution;
};

}  // namespace cvtflow::model
