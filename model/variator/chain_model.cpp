#include "model/variator/chain_model.hpp"

#include <algorithm>

#include "model/kernels/kernels.hpp"
#include "model/rigid/rigid_chain.hpp"

namespace cvtflow::model {

namespace {

[[nodiscard]] ChainKernels kernels_for(const Parameters& parameters, Isa isa) {
    return parameters.detail.pins == PinDetail::rigid ? RigidChain::kernels() : kernels_of(isa).chain(parameters.detail.order);
}

}  // namespace

const double* NeighbourWindow::of(const ChainLayout& layout, const double* state, int link) noexcept {
    if (!layout.rigid) return state + layout.link_begin(link);
    const int block = layout.link_block();
    for (int place = 0; place < blocks; ++place)
        std::copy_n(state + layout.link_begin(layout.wrapped(link + place - before)), block, numbers_ + place * block);
    return numbers_ + before * block;
}

ChainModel::ChainModel(const Parameters& parameters, Isa isa)
    : coefficients_(parameters), inertia_(link_inertia(parameters)), isa_(isa), kernels_(kernels_for(parameters, isa)) {
    if (!layout().rigid) return;
    rigid_ = std::make_shared<const RigidChain>(parameters, isa);
    coefficients_.tip.law = rigid_->model().coefficients().tip_law;
}

}  // namespace cvtflow::model
