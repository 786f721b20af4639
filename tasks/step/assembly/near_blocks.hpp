#pragma once
/// States of links with those of the neighbours that contact of their tips depends on beside them.

#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

/// A link and those of its neighbours that its tips depend on, at a time between those of states that are kept.
struct NearBlocks {
    static constexpr int most = 2 * model::ChainLayout{.rigid = true}.probe_halo() + 1;
    double numbers[most * model::max_link_block];

    [[nodiscard]] double* place(const model::ChainLayout& layout, int from_link) noexcept {
        return numbers + (layout.probe_halo() + from_link) * layout.link_block();
    }
};

/// State of one link at a share of the step, its neighbours beside it.
[[nodiscard]] const double* near_at(const Workspace& w, int link, double theta, NearBlocks& blocks) noexcept;

/// States of a segment's links at a share of the step, with as many beside them: in the segment's window.
[[nodiscard]] const double* blocks_at(Workspace& w, int segment, double theta) noexcept;

/// States of a segment's links at the step's end, with as many beside them as contact depends on: those of other segments may not be
/// written yet, so they are combined once more.
[[nodiscard]] const double* end_blocks(Workspace& w, int segment) noexcept;

}  // namespace cvtflow::tasks
