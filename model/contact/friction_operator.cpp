
#include "model/contact/friction_operator.hpp"

#include <algorithm>

namespace cvtflow::model {

namespace {

template <std::size_t N>
std::array<float, N> rounded(const std::array<double, N>& numbers) {
    std::array<float, N> to;
    std::ranges::transform(numbers, to.begin(), [](double x) { return static_cast<float>(x); });
    return to;
}

template <int Most>
PointLanes<Most, float> rounded(const PointLanes<Most>& points) {
    PointLanes<Most, float> to{points.count, points.width, rounded(points.position), rounded(points.weight), rounded(points.damping)};
    std::ranges::transform(points.basis, to.basis.begin(), [](const auto& row) { return rounded(row); });
    return to;
}

MirroredMatrix<float> rounded(const MirroredMatrix<double>& matrix) { return {rounded(matrix.sum), rounded(matrix.difference)}; }

}  // namespace

ContactField::ContactField(const ChainModel& chain)
    : components{chain.coefficients().joint_points.count, chain.coefficients().plates.count} {
    make_columns(chain.layout().links + 2);
}

void ContactField::make_columns(int count) {
    columns = FloatColumns(components.count(), count);
    arms = Columns(3 * tips_per_link, count);
}

FrictionNumbers::FrictionNumbers(const Coefficients& c, const HeldInverse& responses)
    : joint_saturation(c.joint.friction.saturation_speed),
      plate_saturation(c.plate_friction.saturation_speed),
      tip_saturation(c.tip.friction.saturation_speed),
      tip_law(c.tip.law),
      joint_points(rounded(c.joint_points)),
      plates(rounded(c.plates)),
      inverse{rounded(responses.along),   rounded(responses.across),      rounded(responses.axial),
              rounded(responses.turning), rounded(responses.wave_plates), rounded(responses.wave_joint)} {}

FrictionOperator::FrictionOperator(const ChainModel& chain, const FrictionKernels& kernels)
    : chain_(chain),
      inverse_(HeldLinks(chain.coefficients(), chain.inertia()).inverse(0.0)),
      numbers_(chain.coefficients(), inverse_),
      kernels_(kernels) {}

void FrictionOperator::hold(float step) noexcept {
    if (step == held_for_) return;
    held_for_ = step;
    inverse_ = HeldLinks(chain_.coefficients(), chain_.inertia()).inverse(step);
    numbers_ = {chain_.coefficients(), inverse_};
}

}  // namespace cvtflow::model
