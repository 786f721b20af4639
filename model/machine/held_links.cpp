#include "model/machine/held_links.hpp"

#include <cmath>

namespace cvtflow::model {

namespace {

/// θ. A quarter of all that acts on a motion lifts its limit; plates take part in motions that joints stiffen as well. Joints: of k_J, as
/// if the other half stood still. Extension: a quarter of k_e and of both tips. Larger ones lengthen no step, and their errors go with θ h²
/// [1].
constexpr double hold_of_plates = 1.0 / 3.0, hold_of_bending = 0.25, hold_of_joints = 0.2, hold_of_extension = 0.45;

/// Stiffness of Palmgren's joints under heavy load over k_J [1].
constexpr double stiffness_under_load = 1.25;

/// Chains with one joint point go wrong from 12 % below the limit that K - 4 K_held has on, for a reason that was not found.
constexpr int least_joint_points = 2;

/// β. Waves take steps up to h ω = 1/√β, 6.6 us; with 0.08 a geometric start at ratio 2 fails at 5 us (unexplained) [1].
constexpr double filter_of_waves = 0.09;

/// Rings of fewer pins filter no waves: links meet at 0.4 rad, and at 4.5 us the energy of 4 of 25 rings of 24 pins seemed not to close (at
/// most 0.92 of the tolerance with 32 pins, 0.48 with 40).
constexpr int least_filtered_pins = 36;

/// Half of the inverse of 2 (m + factor k), of the first `size` modes where they couple.
[[nodiscard]] AxisMatrix<double> half_inverse(const AxisMatrix<double>& m, const AxisMatrix<double>& k, double factor, int size) noexcept {
    AxisMatrix<double> matrix, half{};
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
void add_point(const PointLanes<Most>& points, int point, double weight, int first, AxisMatrix<double>& to) noexcept {
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
    : lateral_inertia_(mirrored(inertia.lateral_matrix.data(), axis_terms)), axial_inertia_(mirrored(inertia.axial_matrix.data(), 2)) {
    if (c.joint_points.count < least_joint_points) return;
    if (c.layout.links >= least_filtered_pins) filter_ = filter_of_waves;
    const auto diagonal = [](int m) { return static_cast<std::size_t>(m * (axis_terms + 1)); };
    for (int m = 2; m < axis_terms; ++m) {
        const auto mode = static_cast<std::size_t>(m - 2);
        along_.sum[diagonal(m)] = 0.5 * hold_of_bending * c.travel.stiffness[mode];
        across_.sum[diagonal(m)] = 0.5 * hold_of_bending * c.height.stiffness[mode];
    }
    for (int g = 0; g < c.joint_points.count; ++g) {
        const double stiffness = c.joint.stiffness * c.joint_points.weight[static_cast<std::size_t>(g)];
        add_point(c.joint_points, g, (c.joint.palmgren ? stiffness_under_load : 1.0) * stiffness, 0, joint_);
        add_point(c.joint_points, g, 0.5 * hold_of_joints * stiffness, 2, along_.sum);
    }
    axial_.sum[diagonal(1)] = 0.5 * hold_of_extension * c.extension.stiffness;
    for (MirroredMatrix<double>* each : {&along_, &across_, &axial_}) each->difference = each->sum;
    for (int j = 0; j < c.plates.count; ++j) add_point(c.plates, j, c.plates.weight[static_cast<std::size_t>(j)], 0, plates_);
    for (std::size_t k = 0; k < plates_.size(); ++k) along_.difference[k] += hold_of_plates * plates_[k];
}

HeldInverse HeldLinks::inverse(double step) const noexcept {
    const double square = step * step;
    HeldInverse inverse{inverse_of(lateral_inertia_, along_, square, axis_terms), inverse_of(lateral_inertia_, across_, square, axis_terms),
                        inverse_of(axial_inertia_, axial_, square, 2)};
    for (std::size_t m = 0; m < axis_terms; ++m) inverse.turning[m] = square * along_.difference[axis_terms * m];  // of the plates alone
    for (std::size_t k = 0; k < plates_.size(); ++k) {
        inverse.wave_plates[k] = filter_ * square * plates_[k];
        inverse.wave_joint[k] = filter_ * square * joint_[k];
    }
    return inverse;
}

void HeldLinks::hold(const HeldInverse& inverse, const double* q, double* accelerations) const noexcept {
    constexpr ChainLayout at;
    const double dx = q[at.x(End::front, 0)] - q[at.x(End::rear, 0)], dy = q[at.y(End::front, 0)] - q[at.y(End::rear, 0)],
                 length = std::sqrt(dx * dx + dy * dy);
    double *const y = accelerations + at.y(End::rear, 0), *const axial = accelerations + at.z(End::rear);
    for (double* axis : {accelerations, y}) multiply_ends<axis_terms>(lateral_inertia_, axis, axis);
    multiply_ends<2>(axial_inertia_, axial, axial);
    multiply_turned(inverse.along, inverse.across, dx / length, dy / length, accelerations, accelerations);
    multiply_ends<2>(inverse.axial, axial, axial);
}

}  // namespace cvtflow::model
