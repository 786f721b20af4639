#pragma once
/// Work of a segment in each cycle: bodies of tasks (context is the workspace, item the segment), and the data of links, their neighbours
/// and their tips that they read.

#include <array>

#include "model/contact/friction_operator.hpp"
#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

/// Stage state of a segment's links and of `halo` links on each side, as workspace.step.row combines it, in the segment's window, which is
/// returned.
const double* fill_window(Workspace& workspace, int segment, int halo) noexcept;

/// A link of pin halves beside a segment, which follows it by itself.
struct alignas(model::cache_line) GhostLink {
    using Block = std::array<double, model::max_link_block>;
    Block start, slope;  ///< state and slope of which workspace.step.row is made
    Block middle;        ///< result of the last row
    Block before;        ///< state at the start of the step before
};

/// fill_window() with the halo of the layout, by a kernel, where workspace.step.row is a state plus a multiple of a slope.
/// @param ghosts [2] the links before and behind the segment; nullptr: the workspace's slots have them
const double* advance_window(Workspace& workspace, int segment, model::LinkAdvance* kernel, GhostLink* ghosts) noexcept;

/// A link and those of its neighbours that its tips depend on, at a time between those of states that are kept.
struct NearBlocks {
    static constexpr int most = 2 * model::ChainLayout{.rigid = true}.probe_halo() + 1;
    double numbers[most * model::max_link_block];

    [[nodiscard]] double* place(const model::ChainLayout& layout, int from_link) noexcept {
        return numbers + (layout.probe_halo() + from_link) * layout.link_block();
    }
};

inline void show(const model::TipProbe& probe, model::TipIndicator* tips) noexcept {
    for (int tip = 0; tip < model::tips_per_link; ++tip) tips[tip] = {probe.depth[tip], probe.slip[tip]};
}

/// The four tips of a link whose state is given.
inline void indicate(const Workspace& w, const double* state, const model::SheaveMotion* sheaves, model::TipIndicator* tips,
                     model::TipProbe& probe) noexcept {
    w.variator.chain().probe(state, sheaves, w.parameters.detail.stick_slip, probe);
    show(probe, tips);
}

/// Whether a tip may change in this step: it will have kept its phase for the dwell time. The answer does not depend on cuts of the step.
[[nodiscard]] inline bool may_change(const Workspace& w, int tip) noexcept {
    return w.step.search_until - w.tips.changed[at(tip)] >= w.step.dwell;
}

/// Faster than sound in steel (5.9 km/s): no chain does that, so the integration has become unstable, long before anything is infinite.
inline constexpr double fastest_pin = 1e4;  // m/s
/// Whether the state behind the links is finite at the step's end.
[[nodiscard]] Fault check_tail(const Workspace& workspace) noexcept;
/// The first fault in a state of the whole chain: not finite, too fast, or tips where contact cannot be described. state [unknowns]
[[nodiscard]] Fault find_fault(const Workspace& workspace, const double* state) noexcept;

/// State behind the links at the step's end, as workspace.step.row combines it; with slopes from states also those, at both ends.
void close_tail(Workspace& workspace) noexcept;

/// Stage state of the segment and its halo, forces, slope of its links.
void evaluate_segment(void* workspace, int segment) noexcept;
/// Losses and stored energies of its links at the step's start, kinetic ones too, into workspace.links.accounts; on
/// workspace.pulleys.observed_sheaves.
void observe_segment(void* workspace, int segment) noexcept;
/// Result of the step for its links; their tips at the step's end.
void detect_segment(void* workspace, int segment) noexcept;
/// Earliest transition of its tips.
void locate_segment(void* workspace, int segment) noexcept;
/// State of its links at theta; its tips take the phase that is due there.
void truncate_segment(void* workspace, int segment) noexcept;

}  // namespace cvtflow::tasks
