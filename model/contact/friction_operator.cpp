
#include "model/contact/friction_operator.hpp"

#include <algorithm>
#include <type_traits>

namespace cvtflow::model {

namespace {

Coefficients without_friction(Coefficients c) {
    c.plate_friction.coefficient = c.tip.friction.coefficient = c.joint.friction.coefficient = 0.0;
    return c;
}

}  // namespace

FrictionOperator::FrictionOperator(const ChainModel& chain, bool by_phase, const FrictionKernels& kernels,
                                   const SingleFrictionKernels& single)
    : chain_(chain),
      frictionless_(without_friction(chain.coefficients())),
      numbers_(chain),
      single_numbers_(chain),
      by_phase_(by_phase),
      kernels_(kernels),
      single_(single) {}

namespace {

/// @param rows of the matrix, `size` modes of either end
MirroredInverse inverse_of(const double* rows, int size) {
    const WideInverse inverse(rows, 2 * size);
    MirroredInverse mirrored;
    for (int m = 0; m < size; ++m) {
        for (int k = m % 2; k < size; k += 2) {
            const auto at = static_cast<std::size_t>(m * max_lateral + k);
            mirrored.sum[at] = static_cast<double>(0.5 * (inverse(m, k) + inverse(m, size + k)));
            mirrored.difference[at] = static_cast<double>(0.5 * (inverse(m, k) - inverse(m, size + k)));
        }
    }
    return mirrored;
}

template <class Number>
MirroredInverseOf<Number> rounded(const MirroredInverse& inverse) {
    MirroredInverseOf<Number> to;
    std::ranges::transform(inverse.sum, to.sum.begin(), [](double x) { return static_cast<Number>(x); });
    std::ranges::transform(inverse.difference, to.difference.begin(), [](double x) { return static_cast<Number>(x); });
    return to;
}

/// As a law is evaluated in floats: nothing is divided by zero there, either, and what is surely proportional is so after their rounding.
template <class Number>
FrictionCurve curve_in(FrictionCurve curve) {
    if constexpr (std::is_same_v<Number, float>) {
        curve.proportional_speed = std::max(curve.proportional_speed, slowest_single);
        curve.linear_speed_squared = (1.0 - 1e-6) * curve.proportional_speed * curve.proportional_speed;
    }
    return curve;
}

}  // namespace

template <class Number>
FrictionNumbers<Number>::FrictionNumbers(const ChainModel& chain)
    : joint(curve_in<Number>(chain.coefficients().joint.friction)),
      plate(curve_in<Number>(chain.coefficients().plate_friction)),
      tip(curve_in<Number>(chain.coefficients().tip.friction)),
      tip_law(chain.coefficients().tip.law) {
    const Coefficients& c = chain.coefficients();
    const auto round_all = [](const auto& from, auto& to) {
        std::ranges::transform(from, to.begin(), [](double x) { return static_cast<Number>(x); });
    };
    round_all(c.joint_points.position, joint_position);
    for (std::size_t m = 0; m < joint_basis.size(); ++m) round_all(c.joint_points.basis[m], joint_basis[m]);
    round_all(c.plates.position, plate_position);
    lateral = rounded<Number>(inverse_of(chain.inertia().lateral_matrix.data(), chain.layout().lateral()));
    axial = rounded<Number>(inverse_of(chain.inertia().axial_matrix.data(), 2));
}

template struct FrictionNumbers<double>;
template struct FrictionNumbers<float>;

}  // namespace cvtflow::model
