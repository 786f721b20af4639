#include "tasks/step/assembly/staged_tasks.hpp"

#include <algorithm>
#include <cstring>

#include "tasks/step/assembly/segment_tasks.hpp"
#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

namespace {

[[nodiscard]] Workspace& of(void* workspace) noexcept { return *static_cast<Workspace*>(workspace); }

}  // namespace

void combine_segment(void* workspace, int segment) noexcept {
    Workspace& w = of(workspace);
    const Segment& own = w.partition[segment];
    const model::ChainLayout& layout = w.layout();
    const int begin = layout.link_begin(own.first);
    const int end = begin + own.size() * layout.link_block();
    const std::size_t bytes = static_cast<std::size_t>(end - begin) * sizeof(double);
    if (w.step.evaluate_end) {
        std::memcpy(w.staged.state + begin, w.end_state + begin, bytes);
    } else {
        engine::combine(w.step.row, w.step.h, w.slots(), begin, end, w.staged.state + begin);
        if (w.step.row.keep >= 0) std::memcpy(w.states[static_cast<std::size_t>(w.step.row.keep)] + begin, w.staged.state + begin, bytes);
    }
    if (!layout.ledger) return;
    std::fill_n(w.links.accounts.begin() + model::account_parts * own.first, model::account_parts * own.size(), model::Account{});
}

void contact_batch(void* workspace, int batch) noexcept {
    Workspace& w = of(workspace);
    const auto cut = [&](int k) { return static_cast<int>(static_cast<long>(w.tips.touching_count) * k / w.partition.size()); };
    const model::StagedChain chain = w.staged_chain();
    for (int k = cut(batch); k < cut(batch + 1); ++k)
        w.stages.contact(w.variator.chain(), chain, w.tips.touching[static_cast<std::size_t>(k)]);
}

void chain_segment(void* workspace, int segment) noexcept {
    Workspace& w = of(workspace);
    w.stages.chain_forces(w.variator.chain(), w.staged_chain(), w.partition[segment].first, w.partition[segment].last);
}

void boundary_pin(void* workspace, int segment) noexcept {
    Workspace& w = of(workspace);
    w.stages.joint(w.variator.chain(), w.staged_chain(), w.partition[segment].first);
}

void forward_segment(void* workspace, int segment) noexcept {
    Workspace& w = of(workspace);
    w.stages.forward(w.variator.chain(), w.staged_chain(), w.partition[segment].first, w.partition[segment].last);
}

void reverse_segment(void* workspace, int segment) noexcept {
    Workspace& w = of(workspace);
    w.stages.reverse(w.variator.chain(), w.staged_chain(), w.partition[segment].first, w.partition[segment].last);
}

void forward_all(void* workspace, int) noexcept {
    for (int segment = 0; segment < of(workspace).partition.size(); ++segment) forward_segment(workspace, segment);
}

void reverse_all(void* workspace, int) noexcept {
    for (int segment = 0; segment < of(workspace).partition.size(); ++segment) reverse_segment(workspace, segment);
}

void detect_all(void* workspace, int) noexcept {
    for (int segment = 0; segment < of(workspace).partition.size(); ++segment) detect_segment(workspace, segment);
}

}  // namespace cvtflow::tasks
