#pragma once
/// The constant inertia of a link and its inverse. x, y and z do not couple: diag(B, B, C). (model/EQUATIONS.md section 2)

#include <array>

#include "model/machine/coefficients.hpp"

namespace cvtflow::model {

inline constexpr int most_lateral_block = 2 * most_lateral;

/// Inverse of a small symmetric positive definite matrix, column by column, each padded with zeros to a whole number of lanes.
struct SmallInverse {
    int size = 0;
    alignas(64) std::array<double, most_lateral_block * most_lateral_block> column{};  ///< [size][padded(size)]
};
/// Lanes that hold one column: a power of two.
[[nodiscard]] constexpr int padded(int size) noexcept { return size <= 2 ? 2 : size <= 4 ? 4 : 8; }

struct LinkInertia {
    SmallInverse lateral;                                                          ///< of B, for x and for y: [a_0…a_p, b_0…b_p]
    SmallInverse axial;                                                            ///< of C: [a.z, a.e, b.z, b.e]
    std::array<double, most_lateral_block * most_lateral_block> lateral_matrix{};  ///< B itself, rows of 2(p+1) [kg]
    std::array<double, 16> axial_matrix{};                                         ///< C itself [kg]
};

/// Kinetic energy of a link [J]. @param v its velocities as in the state, [2 lateral + 2 lateral + 4] @param lateral 2(p+1), the size of B
[[nodiscard]] double kinetic_energy(const LinkInertia& inertia, const double* v, int lateral) noexcept;

/// Inertia of a link with the given parameters; the same for every link as plates weigh the same whatever their pitch.
[[nodiscard]] LinkInertia link_inertia(const Parameters& parameters);

}  // namespace cvtflow::model
