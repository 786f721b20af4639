#include "bench/method/linear/dense.hpp"

#include <algorithm>
#include <cmath>

namespace cvtflow::bench {

namespace {

/// c -= a_0 b_0 + … of `inner` rows of B, four at a time, each product subtracted by itself.
void subtract_rows(int inner, int columns, const double* __restrict a, const double* b, int b_stride, double* __restrict c) noexcept {
    int k = 0;
    for (; k + 4 <= inner; k += 4) {
        const double* __restrict b0 = b + k * b_stride;
        const double* __restrict b1 = b0 + b_stride;
        const double* __restrict b2 = b1 + b_stride;
        const double* __restrict b3 = b2 + b_stride;
        const double a0 = a[k], a1 = a[k + 1], a2 = a[k + 2], a3 = a[k + 3];
        for (int j = 0; j < columns; ++j) c[j] = (((c[j] - a0 * b0[j]) - a1 * b1[j]) - a2 * b2[j]) - a3 * b3[j];
    }
    for (; k < inner; ++k) {
        const double* __restrict row = b + k * b_stride;
        const double factor = a[k];
        for (int j = 0; j < columns; ++j) c[j] -= factor * row[j];
    }
}

[[nodiscard]] int largest_below(int size, const double* a, int k) noexcept {
    int best = k;
    for (int row = k + 1; row < size; ++row) {
        if (std::abs(a[row * size + k]) > std::abs(a[best * size + k])) best = row;
    }
    return best;
}

}  // namespace

void subtract_product(int rows, int inner, int columns, const double* a, int a_stride, const double* b, int b_stride, double* c,
                      int c_stride) noexcept {
    for (int row = 0; row < rows; ++row) subtract_rows(inner, columns, a + row * a_stride, b, b_stride, c + row * c_stride);
}

bool factorise(int size, double* a, int* exchanges) noexcept {
    for (int k = 0; k < size; ++k) {
        const int pivot = largest_below(size, a, k);
        exchanges[k] = pivot;
        if (pivot != k) std::swap_ranges(a + k * size, a + (k + 1) * size, a + pivot * size);
        const double head = a[k * size + k];
        if (!(std::abs(head) > 0.0) || !std::isfinite(head)) return false;
        for (int row = k + 1; row < size; ++row) {
            double* __restrict own = a + row * size;
            const double* __restrict top = a + k * size;
            const double factor = own[k] / head;
            own[k] = factor;
            for (int j = k + 1; j < size; ++j) own[j] -= factor * top[j];
        }
    }
    return true;
}

void solve_factorised(int size, const double* lu, const int* exchanges, double* x, int stride, int columns) noexcept {
    for (int k = 0; k < size; ++k) {
        if (exchanges[k] != k) std::swap_ranges(x + k * stride, x + k * stride + columns, x + exchanges[k] * stride);
    }
    for (int row = 1; row < size; ++row) subtract_rows(row, columns, lu + row * size, x, stride, x + row * stride);
    for (int row = size - 1; row >= 0; --row) {
        double* own = x + row * stride;
        subtract_rows(size - 1 - row, columns, lu + row * size + row + 1, x + (row + 1) * stride, stride, own);
        const double inverse = 1.0 / lu[row * size + row];
        for (int j = 0; j < columns; ++j) own[j] *= inverse;
    }
}

}  // namespace cvtflow::bench
