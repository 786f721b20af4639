
#include "model/contact/friction_operator.hpp"

#include <algorithm>

namespace cvtflow::model {

namespace {

template <class From, class To>
void round_all(const From& from, To& to) {
    std::ranges::transform(from, to.begin(), [](double x) { return static_cast<float>(x); });
}

template <int Most>
PointLanes<Most, float> rounded(const PointLanes<Most>& points) {
    PointLanes<Most, float> to{points.count, points.width};
    round_all(points.position, to.position);
    round_all(points.weight, to.weight);
    round_all(points.damping, to.damping);
    for (std::size_t m = 0; m < to.basis.size(); ++m) round_all(points.basis[m], to.basis[m]);
    return to;
}

MirroredMatrix<float> rounded(const MirroredMatrix<double>& matrix) {
    MirroredMatrix<float> to;
    round_all(matrix.sum, to.sum);
    round_all(matrix.difference, to.difference);
    return to;
}

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
      plates(rounded(c.plates)) {
    inverse = {rounded(responses.along), rounded(responses.across), rounded(responses.axial), {}, {}, {}};
    round_all(responses.turning, inverse.turning);
    round_all(responses.wave_plates, inverse.wave_plates);
    round_all(responses.wave_joint, inverse.wave_joint);
}

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
