#pragma once
/// Small dense matrices of floats, lanes over links: factors and products, in tiles that stay in registers.

#include "model/basis/float_lanes.hpp"
#include "model/friction/slip_space.hpp"

namespace cvtflow::model {
namespace {

/// Rows and columns of a tile: divide the unknowns of a joint. Points: of a joint, 0: any number.
template <int Points>
inline constexpr int tile_rows = Points == 3 ? 6 : 2;
template <int Points>
inline constexpr int tile_columns = Points == 3 ? 3 : 2;

/// L D Lᵀ of a symmetric matrix with all eigenvalues ≥ 1, in place; D⁻¹ on the diagonal. Pivots are ≥ 1 but for rounding.
/// @param m lower triangle, row by row
inline void ldl(FloatLanes* m, int size) noexcept {
    for (int pivot = 0; pivot < size; ++pivot) {
        const FloatLanes inverse = 1.0f / larger(m[triangle(pivot, pivot)], 1.0f);
        m[triangle(pivot, pivot)] = inverse;
        for (int row = size - 1; row > pivot; --row) {
            const FloatLanes by = m[triangle(row, pivot)] * inverse;
            for (int column = pivot + 1; column <= row; ++column) m[triangle(row, column)] = m[triangle(row, column)] - by * m[triangle(column, pivot)];
            m[triangle(row, pivot)] = by;
        }
    }
}

/// m -= aᵀ b by tiles; Lower: only those that reach below the diagonal. Depth: rows of a and b.
/// @param a [Depth][a_stride] rows of floats
template <int Depth, int Rows, int Columns, bool Lower>
inline void subtract_products(const float* a, int a_stride, const FloatLanes* b, int b_stride, int rows, int columns, FloatLanes* m, int stride) noexcept {
    for (int row = 0; row < rows; row += Rows) {
        for (int column = 0; column < (Lower ? row + Rows : columns); column += Columns) {
            FloatLanes tile[Rows][Columns];
#pragma GCC unroll 8
            for (int i = 0; i < Rows; ++i) {
#pragma GCC unroll 8
                for (int j = 0; j < Columns; ++j) tile[i][j] = m[(row + i) * stride + column + j];
            }
            for (int k = 0; k < Depth; ++k) {
                FloatLanes right[Columns];
#pragma GCC unroll 8
                for (int j = 0; j < Columns; ++j) right[j] = b[k * b_stride + column + j];
#pragma GCC unroll 8
                for (int i = 0; i < Rows; ++i) {
                    const FloatLanes left = load(a + (k * a_stride + row + i) * slip_lanes);
#pragma GCC unroll 8
                    for (int j = 0; j < Columns; ++j) tile[i][j] = tile[i][j] - left * right[j];
                }
            }
#pragma GCC unroll 8
            for (int i = 0; i < Rows; ++i) {
#pragma GCC unroll 8
                for (int j = 0; j < Columns; ++j) m[(row + i) * stride + column + j] = tile[i][j];
            }
        }
    }
}

}  // namespace
}  // namespace cvtflow::model
