#pragma once
/// The constant inertia of a link and its Cholesky factor. x, y and z do not couple: diag(B, B, C). (model/EQUATIONS.md section 2)

#include <array>
#include <cmath>

#include "model/coefficients.hpp"

namespace cvtflow::model {

inline constexpr int most_lateral_block = 2 * most_lateral;

/// Lower Cholesky factor of a small symmetric positive definite matrix, row by row, with the reciprocals of its diagonal.
struct SmallCholesky {
    int size = 0;
    alignas(64) std::array<double, most_lateral_block * most_lateral_block> factor{};
    std::array<double, most_lateral_block> inverse_diagonal{};
};

struct LinkInertia {
    SmallCholesky lateral;   ///< B, for x and for y: [a_0…a_p, b_0…b_p]
    SmallCholesky axial;     ///< C: [a.z, a.e, b.z, b.e]
    std::array<double, most_lateral_block * most_lateral_block> lateral_matrix{};  ///< B itself, rows of 2(p+1)
    std::array<double, 16> axial_matrix{};                                         ///< C itself
};

/// Inertia of a link with the given parameters; the same for every link as plates weigh the same whatever their pitch.
[[nodiscard]] LinkInertia link_inertia(const Parameters& parameters);

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

}  // namespace cvtflow::model
