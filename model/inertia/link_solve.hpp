#pragma once
/// Accelerations of a link from its generalized forces: the two triangular solves. (model/EQUATIONS.md section 2)

#include "model/inertia/link_inertia.hpp"

namespace cvtflow::model {
namespace {

/// Solves L y = f in place, N = size of the factor, for `Columns` right-hand sides that lie N apart.
template <int N, int Columns>
inline void forward(const SmallCholesky& l, double* f) noexcept {
    for (int row = 0; row < N; ++row) {
        for (int column = 0; column < Columns; ++column) {
            double value = f[column * N + row];
            for (int k = 0; k < row; ++k) value -= l.factor[static_cast<std::size_t>(row * N + k)] * f[column * N + k];
            f[column * N + row] = value * l.inverse_diagonal[static_cast<std::size_t>(row)];
        }
    }
}

/// Solves Lᵀ x = y in place.
template <int N, int Columns>
inline void backward(const SmallCholesky& l, double* f) noexcept {
    for (int row = N - 1; row >= 0; --row) {
        for (int column = 0; column < Columns; ++column) {
            double value = f[column * N + row];
            for (int k = row + 1; k < N; ++k) value -= l.factor[static_cast<std::size_t>(k * N + row)] * f[column * N + k];
            f[column * N + row] = value * l.inverse_diagonal[static_cast<std::size_t>(row)];
        }
    }
}

/// Forward pass of a link: from generalized forces, in place.
template <int P>
inline void forward_pass(const LinkInertia& inertia, double* f) noexcept {
    forward<2 * (P + 1), 2>(inertia.lateral, f);
    forward<4, 1>(inertia.axial, f + 4 * (P + 1));
}

/// Reverse pass of a link: to accelerations, in place.
template <int P>
inline void reverse_pass(const LinkInertia& inertia, double* f) noexcept {
    backward<2 * (P + 1), 2>(inertia.lateral, f);
    backward<4, 1>(inertia.axial, f + 4 * (P + 1));
}

/// Accelerations of a link from its generalized forces, in place.
template <int P>
inline void accelerate(const LinkInertia& inertia, double* f) noexcept {
    forward_pass<P>(inertia, f);
    reverse_pass<P>(inertia, f);
}

}  // namespace
}  // namespace cvtflow::model
