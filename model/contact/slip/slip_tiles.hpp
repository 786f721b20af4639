#pragma once
/// Rows of floats, lanes over links, and small dense matrices of them: factors and products, in tiles that stay in registers.

#include <cstdint>
#include <type_traits>

#include "model/basis/float_lanes.hpp"
#include "model/contact/slip/joint_chain.hpp"

namespace cvtflow::model {
namespace {

[[nodiscard]] inline FloatLanes get(const FloatRows& rows, int row) noexcept { return load(rows.at(row)); }
inline void put(FloatRows& rows, int row, const FloatLanes& value) noexcept { value.copy_to(rows.at(row)); }

/// Rows and columns of a tile: divide the unknowns of a joint, and leave registers for its factors (32 of AVX-512, else 16). Points: of a
/// joint, 0: any number.
template <int Points>
inline constexpr int tile_rows = Points == 3 ? (native_lanes == 8 ? 6 : 3) : 2;
template <int Points>
inline constexpr int tile_columns = Points == 3 ? 3 : 2;

/// body(begin) … body(end - 1), each number a constant for the compiler.
template <int begin, int end, class Body>
[[gnu::always_inline]] inline void unrolled(const Body& body) noexcept {
    if constexpr (begin < end) {
        body(std::integral_constant<int, begin>{});
        unrolled<begin + 1, end>(body);
    }
}

/// L D Lᵀ of a symmetric matrix with all eigenvalues ≥ 1, in place; D⁻¹ on the diagonal. Pivots are ≥ 1 but for rounding.
/// @param m lower triangle, row by row
template <int Size>
inline void ldl(FloatLanes* m) noexcept {
    unrolled<0, Size>([m](auto pivot) noexcept {
        const FloatLanes inverse = 1.0f / larger(m[triangle(pivot, pivot)], 1.0f);
        m[triangle(pivot, pivot)] = inverse;
        unrolled<0, Size - 1 - pivot>([m, &inverse](auto behind) noexcept {
            constexpr int p = decltype(pivot)::value, row = Size - 1 - decltype(behind)::value;
            const FloatLanes by = m[triangle(row, p)] * inverse;
            unrolled<p + 1, row + 1>([m, &by](auto column) noexcept {
                constexpr int k = decltype(column)::value;
                m[triangle(row, k)] = m[triangle(row, k)] - by * m[triangle(k, p)];
            });
            m[triangle(row, p)] = by;
        });
    });
}
/// The factorisation for any size.
inline void ldl(FloatLanes* m, int size) noexcept {
    for (int pivot = 0; pivot < size; ++pivot) {
        const FloatLanes inverse = 1.0f / larger(m[triangle(pivot, pivot)], 1.0f);
        m[triangle(pivot, pivot)] = inverse;
        for (int row = size - 1; row > pivot; --row) {
            const FloatLanes by = m[triangle(row, pivot)] * inverse;
            for (int column = pivot + 1; column <= row; ++column)
                m[triangle(row, column)] = m[triangle(row, column)] - by * m[triangle(column, pivot)];
            m[triangle(row, pivot)] = by;
        }
    }
}

/// y ← L⁻ᵀ D⁻¹ y. @param factor (row, column ≤ row): L, and D⁻¹ on its diagonal
template <class Factor>
[[gnu::always_inline]] inline void back_substitute(FloatLanes* y, int size, const Factor& factor) noexcept {
    for (int row = 0; row < size; ++row) y[row] = y[row] * factor(row, row);
    for (int k = size - 1; k > 0; --k) {
        for (int row = 0; row < k; ++row) y[row] = y[row] - factor(k, row) * y[k];
    }
}

/// to = from - aᵀ b by tiles, rows of floats throughout; Lower: only those that reach below the diagonal. Depth: rows of a and b.
/// @param from may be `to`; nullptr: zero
template <int Depth, int Rows, int Columns, bool Lower>
inline void subtract_products(const float* a, int a_stride, const float* b, int b_stride, int rows, int columns, const float* from,
                              float* to, int depth = Depth) noexcept {
    using Native = Floats<native_floats>;
    for (int row = 0; row < rows; row += Rows) {
        for (int column = 0; column < (Lower ? row + Rows : columns); column += Columns) {
            for (int lane = 0; lane < slip_lanes; lane += native_floats) {
                Native tile[Rows][Columns];
                const auto at = [&](int i, int j) { return ((row + i) * columns + column + j) * slip_lanes + lane; };
#pragma GCC unroll 8
                for (int i = 0; i < Rows; ++i) {
#pragma GCC unroll 8
                    for (int j = 0; j < Columns; ++j)
                        tile[i][j] = from == nullptr ? Native(0.0f) : load_floats<native_floats>(from + at(i, j));
                }
                for (int k = 0; k < (Depth > 0 ? Depth : depth); ++k) {
                    Native right[Columns];
#pragma GCC unroll 8
                    for (int j = 0; j < Columns; ++j)
                        right[j] = load_floats<native_floats>(b + (k * b_stride + column + j) * slip_lanes + lane);
#pragma GCC unroll 8
                    for (int i = 0; i < Rows; ++i) {
                        const Native left = load_floats<native_floats>(a + (k * a_stride + row + i) * slip_lanes + lane);
#pragma GCC unroll 8
                        for (int j = 0; j < Columns; ++j) tile[i][j] = tile[i][j] - left * right[j];
                    }
                }
#pragma GCC unroll 8
                for (int i = 0; i < Rows; ++i) {
#pragma GCC unroll 8
                    for (int j = 0; j < Columns; ++j) tile[i][j].copy_to(to + at(i, j));
                }
            }
        }
    }
}

/// Lane k takes lane number[k], the first `count` at least; number[k] ≥ k where from is to.
inline void permute(const float* from, const std::int32_t* number, [[maybe_unused]] int count, float* to) noexcept {
#if defined(__AVX512F__)
    typedef float Row __attribute__((vector_size(slip_lanes * sizeof(float))));
    typedef std::int32_t Numbers __attribute__((vector_size(slip_lanes * sizeof(std::int32_t))));
    Row row;
    Numbers numbers;
    __builtin_memcpy(&row, from, sizeof row);
    __builtin_memcpy(&numbers, number, sizeof numbers);
#if defined(__clang__)  // which has no shuffle by numbers that are known at run time only
    row = __builtin_ia32_permvarsf512(row, numbers);
#else
    row = __builtin_shuffle(row, numbers);
#endif
    __builtin_memcpy(to, &row, sizeof row);
#else
    for (int lane = 0; lane < count; ++lane) to[lane] = from[number[lane]];
#endif
}

}  // namespace
}  // namespace cvtflow::model
