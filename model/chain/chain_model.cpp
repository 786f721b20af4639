#include "model/chain/chain_model.hpp"

#include <algorithm>

namespace cvtflow::model {

const double* NeighbourWindow::of(const ChainLayout& layout, const double* state, int link) noexcept {
    if (!layout.rigid) return state + layout.link_begin(link);
    const int block = layout.link_block();
    for (int place = 0; place < blocks; ++place)
        std::copy_n(state + layout.link_begin(layout.wrapped(link + place - before)), block, numbers_ + place * block);
    return numbers_ + before * block;
}

void ChainModel::book_kinetic(const double* states, int links, Account* accounts) const noexcept {
    for (int link = 0; link < links; ++link, states += layout().link_block(), accounts += account_parts)
        accounts->store(Energy::kinetic, kinetic_energy(inertia_, states + layout().link_size()));
}

}  // namespace cvtflow::model
