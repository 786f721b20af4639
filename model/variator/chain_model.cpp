#include "model/variator/chain_model.hpp"

#include <algorithm>

#include "model/kernels/kernels.hpp"
#include "model/variator/rigid/rigid_chain.hpp"

namespace cvtflow::model {

namespace {

[[nodiscard]] ChainKernels kernels_for(const Parameters& parameters, Isa isa) {
    const CompiledKernels kernels = kernels_of(isa);
    const int order = parameters.detail.order;
    switch (parameters.detail.pins) {
        case PinDetail::rigid: return RigidChain::kernels();
        case PinDetail::whole: return kernels.pins(order).chain;
        case PinDetail::halves: break;
    }
    return kernels.chain(order);
}

}  // namespace

const double* NeighbourWindow::of(const ChainLayout& layout, const double* state, int link) noexcept {
    if (!layout.whole) return state + layout.link_begin(link);
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
