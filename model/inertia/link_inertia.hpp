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

}  // namespace cvtflow::model
