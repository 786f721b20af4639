#pragma once
/// Small dense kernels on row-major matrices: what the block solver is made of. Each entry's sum is taken in one fixed order without fused
/// multiply-adds, so results are bitwise the same on every machine. Nothing is allocated.

#include "bench/method/product_names.hpp"

namespace cvtflow::bench {

/// C -= A B.   A is [rows × inner], B [inner × columns], C [rows × columns]; a `stride` is the distance of two rows.
void subtract_product(int rows, int inner, int columns, const double* a, int a_stride, const double* b, int b_stride, double* c,
                      int c_stride) noexcept;

/// P A = L U in place with row exchanges: row k was exchanged with row exchanges[k] ≥ k. A is [size × size], rows `size` apart.
/// @return false if a pivot is zero or not finite; A is then of no use
[[nodiscard]] bool factorise(int size, double* a, int* exchanges) noexcept;

/// X ← A⁻¹ X with what factorise() left. X is [size × columns].
void solve_factorised(int size, const double* lu, const int* exchanges, double* x, int stride, int columns) noexcept;

}  // namespace cvtflow::bench
