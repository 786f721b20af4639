#include <algorithm>

#include "tasks/step/assembly/segment_tasks.hpp"

namespace cvtflow::tasks {

model::Account* cleared_accounts(Workspace& w, const Segment& own) noexcept {
    model::Account* accounts = w.links.accounts.data() + model::account_parts * own.first;
    std::fill(accounts, accounts + model::account_parts * own.size(), model::Account{});
    return accounts;
}

void observe_segment(void* workspace, int segment) noexcept {
    auto& w = *static_cast<Workspace*>(workspace);
    const model::ChainLayout& layout = w.layout();
    const Segment& own = w.partition[segment];
    const model::ChainRange range{own.first, own.last, window_of(w, w.states[0], segment), w.pulleys.observed_sheaves,
                                  w.tips.phases.data()};
    model::Account* accounts = cleared_accounts(w, own);
    w.variator.chain().observed_slopes(range, w.cut_state + layout.link_begin(own.first), w.links.loads.data() + own.first, accounts);
    for (int link = own.first; link < own.last; ++link) {
        const double* velocities = w.states[0] + layout.link_begin(link) + layout.link_size();
        accounts[model::account_parts * (link - own.first)].store(model::Energy::kinetic,
                                                                  model::kinetic_energy(w.variator.chain().inertia(), velocities));
    }
}

}  // namespace cvtflow::tasks
