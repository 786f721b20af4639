
#include "model/contact/friction_operator.hpp"

#include <algorithm>

namespace cvtflow::model {

namespace {

Coefficients without_friction(Coefficients c) {
    c.plate_friction.coefficient = c.tip.friction.coefficient = c.joint.friction.coefficient = 0.0;
    return c;
}

/// @param rows of the matrix, `size` modes of either end
MirroredInverse<double> inverse_of(const double* rows, int size) {
    const WideInverse inverse(rows, 2 * size);
    MirroredInverse<double> mirrored;
    for (int m = 0; m < size; ++m) {
        for (int k = m % 2; k < size; k += 2) {
            const auto at = static_cast<std::size_t>(m * axis_terms + k);
            mirrored.sum[at] = static_cast<double>(0.5 * (inverse(m, k) + inverse(m, size + k)));
            mirrored.difference[at] = static_cast<double>(0.5 * (inverse(m, k) - inverse(m, size + k)));
        }
    }
    return mirrored;
}

MirroredInverse<float> rounded(const MirroredInverse<double>& inverse) {
    MirroredInverse<float> to;
    std::ranges::transform(inverse.sum, to.sum.begin(), [](double x) { return static_cast<float>(x); });
    std::ranges::transform(inverse.difference, to.difference.begin(), [](double x) { return static_cast<float>(x); });
    return to;
}

/// As a law is evaluated in floats: nothing is divided by zero there, either, and what is surely proportional is so after their rounding.
FrictionCurve in_floats(FrictionCurve curve) {
    curve.proportional_speed = std::max(curve.proportional_speed, slowest_single);
    curve.linear_speed_squared = (1.0 - 1e-6) * curve.proportional_speed * curve.proportional_speed;
    return curve;
}

}  // namespace

FrictionNumbers::FrictionNumbers(const Coefficients& c, const MirroredInverse<double>& of_lateral, const MirroredInverse<double>& of_axial)
    : joint(in_floats(c.joint.friction)),
      plate(in_floats(c.plate_friction)),
      tip(in_floats(c.tip.friction)),
      tip_law(c.tip.law),
      lateral(rounded(of_lateral)),
      axial(rounded(of_axial)) {
    const auto round_all = [](const auto& from, auto& to) {
        std::ranges::transform(from, to.begin(), [](double x) { return static_cast<float>(x); });
    };
    round_all(c.joint_points.position, joint_position);
    for (std::size_t m = 0; m < joint_basis.size(); ++m) round_all(c.joint_points.basis[m], joint_basis[m]);
    round_all(c.plates.position, plate_position);
}

FrictionOperator::FrictionOperator(const ChainModel& chain, bool by_phase, const FrictionKernels& kernels)
    : chain_(chain),
      frictionless_(without_friction(chain.coefficients())),
      lateral_inverse_(inverse_of(chain.inertia().lateral_matrix.data(), chain.layout().lateral())),
      axial_inverse_(inverse_of(chain.inertia().axial_matrix.data(), 2)),
      numbers_(chain.coefficients(), lateral_inverse_, axial_inverse_),
      by_phase_(by_phase),
      kernels_(kernels) {}

FrictionOperator FrictionOperator::all_sticking() const {
    FrictionOperator sticking = *this;
    for (FrictionCurve* curve : {&sticking.numbers_.joint, &sticking.numbers_.plate, &sticking.numbers_.tip}) *curve = curve->linear();
    sticking.numbers_.tip_law = nullptr;
    sticking.by_phase_ = false;
    return sticking;
}

}  // namespace cvtflow::model
