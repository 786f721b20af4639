#include "model/machine/held_links.hpp"

#include <cmath>

namespace cvtflow::model {

namespace {

using Rows = std::array<double, axis_terms * axis_terms>;

/// θ. A quarter of all that acts on a motion lifts its limit; plates take part in motions that joints stiffen as well. Joints: of k_J, as
/// if the other half stood still. Larger ones lengthen no step, and their errors go with θ h² [1].
constexpr double hold_of_plates = 1.0 / 3.0, hold_of_bending = 0.15, hold_of_joints = 0.2, hold_of_extension = 0.1;

/// Chains with one joint point go wrong from 12 % below the limit that K - 4 K_held has on, for a reason that was not found.
constexpr int least_joint_points = 2;

/// Half of the inverse of 2 (m + factor k), of the first `size` modes where they couple.
[[nodiscard]] Rows half_inverse(const Rows& m, const Rows& k, double factor, int size) noexcept {
    Rows matrix, half{};
    for (int row = 0; row < size; ++row) {
        for (int column = 0; column < size; ++column) {
            const auto at = static_cast<std::size_t>(row * axis_terms + column);
            matrix[static_cast<std::size_t>(row * size + column)] = 2.0 * (m[at] + factor * k[at]);
        }
    }
    const WideInverse inverse(matrix.data(), size);
    for (int row = 0; row < size; ++row) {
        for (int column = row % 2; column < size; column += 2)
            half[static_cast<std::size_t>(row * axis_terms + column)] = static_cast<double>(0.5 * inverse(row, column));
    }
    return half;
}

[[nodiscard]] MirroredMatrix<double> inverse_of(const MirroredMatrix<double>& m, const MirroredMatrix<double>& k, double factor,
                                                int size) noexcept {
    return {half_inverse(m.sum, k.sum, factor, size), half_inverse(m.difference, k.difference, factor, size)};
}

/// @param rows of a link's matrix, `size` modes of either end
[[nodiscard]] MirroredMatrix<double> mirrored(const double* rows, int size) noexcept {
    MirroredMatrix<double> matrix;
    for (int m = 0; m < size; ++m) {
        for (int k = m % 2; k < size; k += 2) {
            const double *from = rows + 2 * size * m + k, same = *from, other = from[size];
            matrix.sum[static_cast<std::size_t>(m * axis_terms + k)] = 0.5 * (same + other);
            matrix.difference[static_cast<std::size_t>(m * axis_terms + k)] = 0.5 * (same - other);
        }
    }
    return matrix;
}

/// Adds `weight` times φ φ' of a point, between modes that couple. @param first the lowest mode
template <int Most>
void add_point(const PointLanes<Most>& points, int point, double weight, int first, Rows& to) noexcept {
    const auto basis = [&](int m) { return points.basis[static_cast<std::size_t>(m)][static_cast<std::size_t>(point)]; };
    for (int m = first; m < axis_terms; ++m) {
        for (int k = m; k < axis_terms; k += 2) {
            to[static_cast<std::size_t>(m * axis_terms + k)] += weight * basis(m) * basis(k);
            if (k != m) to[static_cast<std::size_t>(k * axis_terms + m)] += weight * basis(m) * basis(k);
        }
    }
}

}  // namespace

HeldLinks::HeldLinks(const Coefficients& c, const LinkInertia& inertia)
    : lateral_inertia_(mirrored(inertia.lateral_matrix.data(), axis_terms)),
      axial_inertia_(mirrored(inertia.axial_matrix.data(), 2)),
      lateral_inverse_(mirrored_inverse(inertia.lateral_matrix.data(), axis_terms)),
      axial_inverse_(mirrored_inverse(inertia.axial_matrix.data(), 2)) {
    if (c.joint_points.count < least_joint_points) return;
    const auto diagonal = [](int m) { return static_cast<std::size_t>(m * (axis_terms + 1)); };
    for (int m = 2; m < axis_terms; ++m) {
        const auto mode = static_cast<std::size_t>(m - 2);
        along_.sum[diagonal(m)] = 0.5 * hold_of_bending * c.travel.stiffness[mode];
        across_.sum[diagonal(m)] = 0.5 * hold_of_bending * c.height.stiffness[mode];
    }
    for (int g = 0; g < c.joint_points.count; ++g)
        add_point(c.joint_points, g, 0.5 * hold_of_joints * c.joint.stiffness * c.joint_points.weight[static_cast<std::size_t>(g)], 2,
                  along_.sum);
    axial_.sum[diagonal(1)] = 0.5 * hold_of_extension * c.extension.stiffness;
    for (MirroredMatrix<double>* each : {&along_, &across_, &axial_}) each->difference = each->sum;
    for (int j = 0; j < c.plates.count; ++j)
        add_point(c.plates, j, hold_of_plates * c.plates.weight[static_cast<std::size_t>(j)], 0, along_.difference);
}

HeldInverse HeldLinks::inverse(double step) const noexcept {
    const double square = step * step;
    HeldInverse inverse{inverse_of(lateral_inertia_, along_, square, axis_terms), inverse_of(lateral_inertia_, across_, square, axis_terms),
                        inverse_of(axial_inertia_, axial_, square, 2)};
    for (std::size_t m = 0; m < axis_terms; ++m) inverse.turning[m] = square * along_.difference[axis_terms * m];  // of the plates alone
    return inverse;
}

void HeldLinks::add(double factor, const double* q, const double* moved, double* accelerations) const noexcept {
    constexpr ChainLayout at;
    const double dx = q[at.x(End::front, 0)] - q[at.x(End::rear, 0)], dy = q[at.y(End::front, 0)] - q[at.y(End::rear, 0)],
                 length = std::sqrt(dx * dx + dy * dy);
    constexpr int size = 2 * axis_terms;
    std::array<double, at.link_size()> product;
    multiply_turned(along_, across_, dx / length, dy / length, moved, product.data());
    multiply_ends<2>(axial_, moved + 2 * size, product.data() + 2 * size);
    for (int axis = 0; axis < 2; ++axis)
        multiply_ends<axis_terms>(lateral_inverse_, product.data() + axis * size, product.data() + axis * size);
    multiply_ends<2>(axial_inverse_, product.data() + 2 * size, product.data() + 2 * size);
    for (std::size_t k = 0; k < product.size(); ++k) accelerations[k] += factor * product[k];
}

}  // namespace cvtflow::model
