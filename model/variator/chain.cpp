#include "model/variator/chain.hpp"

#include <memory>
#include <utility>

#include "model/contact/friction_operator.hpp"
#include "model/kernels/kernels.hpp"
#include "model/rigid/rigid_chain.hpp"

namespace cvtflow::model {

/// Rigid pins and the chain share one friction law of the tips, which warm() changes in place.
ChainModel make_chain(const Parameters& parameters, Isa isa) {
    Coefficients coefficients(parameters);
    const LinkInertia inertia = link_inertia(parameters);
    if (parameters.detail.pins != PinDetail::rigid)
        return {std::move(coefficients), inertia, isa, kernels_of(isa).of_order(parameters.detail.order).chain, nullptr};
    auto rigid = std::make_shared<const RigidChain>(parameters, isa);
    coefficients.tip.law = rigid->model().coefficients().tip_law;
    return {std::move(coefficients), inertia, isa, RigidChain::kernels(), std::move(rigid)};
}

FrictionOperator make_friction(const ChainModel& chain, bool by_phase) {
    const Kernels kernels = kernels_of(chain.isa()).of_order(chain.layout().order);
    return {chain, by_phase, kernels.friction, kernels.single};
}

}  // namespace cvtflow::model
