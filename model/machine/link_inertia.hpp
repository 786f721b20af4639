#pragma once
/// The constant inertia of a link (or of a rigid pin) and its inverse. x, y and z do not couple: diag(B, B, C). (model/EQUATIONS.md
/// sections 2 and 11)

#include <array>

#include "model/basis/extended.hpp"
#include "model/machine/coefficients.hpp"
#include "model/machine/mirrored_matrix.hpp"

namespace cvtflow::model {

inline constexpr int max_lateral_block = 2 * axis_terms;

/// Inverse of a small symmetric positive definite matrix, column by column, each padded with zeros to a whole number of lanes.
struct SmallInverse {
    int size = 0;
    alignas(64) std::array<double, max_lateral_block * max_lateral_block> column{};  ///< [size][padded(size)]
};
/// Lanes that hold one column: a power of two.
[[nodiscard]] constexpr int padded(int size) noexcept { return size <= 2 ? 2 : size <= 4 ? 4 : 8; }

/// Inverse of a symmetric positive definite matrix of at most max_lateral_block rows. In extended precision, so that products with it are
/// as exact as a solve.
class WideInverse {
public:
    /// @param rows of the matrix, of which the lower triangle is read
    WideInverse(const double* rows, int size) noexcept;
    [[nodiscard]] Extended operator()(int row, int column) const noexcept {
        return columns_[static_cast<std::size_t>(column) * static_cast<std::size_t>(size_) + static_cast<std::size_t>(row)];
    }

private:
    int size_;
    std::array<Extended, max_lateral_block * max_lateral_block> columns_{};
};

struct LinkInertia {
    SmallInverse lateral;                                                        ///< inverse of B, for x and for y: [a_0…a_p, b_0…b_p]
    SmallInverse axial;                                                          ///< inverse of C: [a.z, a.e, b.z, b.e]
    std::array<double, max_lateral_block * max_lateral_block> lateral_matrix{};  ///< B, rows of 2(p+1) [kg]
    std::array<double, 16> axial_matrix{};                                       ///< C [kg]
};

/// Kinetic energy of a link or a rigid pin [J]. @param v its velocities as in the state
[[nodiscard]] double kinetic_energy(const LinkInertia& inertia, const double* v) noexcept;

/// Inertia of a link, equal for all links as plates weigh the same whatever their pitch; with rigid pins that of a pin with half of the
/// plates of both its links.
[[nodiscard]] LinkInertia link_inertia(const Parameters& parameters);

}  // namespace cvtflow::model
