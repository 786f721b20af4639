
#include "model/contact/friction_operator.hpp"

#include <algorithm>

namespace cvtflow::model {

namespace {

Coefficients without_friction(Coefficients c) {
    c.plate_friction.coefficient = c.tip.friction.coefficient = c.joint.friction.coefficient = 0.0;
    return c;
}

MirroredMatrix<float> rounded(const MirroredMatrix<double>& matrix) {
    MirroredMatrix<float> to;
    std::ranges::transform(matrix.sum, to.sum.begin(), [](double x) { return static_cast<float>(x); });
    std::ranges::transform(matrix.difference, to.difference.begin(), [](double x) { return static_cast<float>(x); });
    return to;
}

HeldInverse free_inverse(const LinkInertia& inertia) noexcept {
    const MirroredMatrix<double> lateral = mirrored_inverse(inertia.lateral_matrix.data(), axis_terms);
    return {lateral, lateral, mirrored_inverse(inertia.axial_matrix.data(), 2)};
}

/// Returns the law as it is evaluated in floats: without division by zero, and proportional after rounding wherever it is in doubles.
FrictionCurve in_floats(FrictionCurve curve) {
    curve.proportional_speed = std::max(curve.proportional_speed, slowest_single);
    curve.linear_speed_squared = (1.0 - 1e-6) * curve.proportional_speed * curve.proportional_speed;
    return curve;
}

}  // namespace

FrictionNumbers::FrictionNumbers(const Coefficients& c, const HeldInverse& inverse)
    : joint(in_floats(c.joint.friction)), plate(in_floats(c.plate_friction)), tip(in_floats(c.tip.friction)), tip_law(c.tip.law) {
    respond_by(inverse);
    const auto round_all = [](const auto& from, auto& to) {
        std::ranges::transform(from, to.begin(), [](double x) { return static_cast<float>(x); });
    };
    round_all(c.joint_points.position, joint_position);
    for (std::size_t m = 0; m < joint_basis.size(); ++m) round_all(c.joint_points.basis[m], joint_basis[m]);
    round_all(c.plates.position, plate_position);
}

void FrictionNumbers::respond_by(const HeldInverse& inverse) noexcept {
    along = rounded(inverse.along);
    across = rounded(inverse.across);
    axial = rounded(inverse.axial);
}

FrictionOperator::FrictionOperator(const ChainModel& chain, bool by_phase, const FrictionKernels& kernels)
    : chain_(chain),
      frictionless_(without_friction(chain.coefficients())),
      inverse_(free_inverse(chain.inertia())),
      numbers_(chain.coefficients(), inverse_),
      by_phase_(by_phase),
      kernels_(kernels) {}

FrictionOperator FrictionOperator::all_sticking() const {
    FrictionOperator sticking = *this;
    for (FrictionCurve* curve : {&sticking.numbers_.joint, &sticking.numbers_.plate, &sticking.numbers_.tip}) *curve = curve->linear();
    sticking.numbers_.tip_law = nullptr;
    sticking.by_phase_ = false;
    return sticking;
}

void FrictionOperator::hold(float step) noexcept {
    if (step == held_for_) return;
    held_for_ = step;
    inverse_ = HeldLinks(chain_.coefficients(), chain_.inertia()).inverse(step);
    numbers_.respond_by(inverse_);
}

}  // namespace cvtflow::model
