#include "model/contact/friction_operator.hpp"

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

}  // namespace cvtflow::model
