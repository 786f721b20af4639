#pragma once
/// What detection, location and cutting of transitions read of the tips.

#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

[[nodiscard]] inline std::size_t at(int index) noexcept { return static_cast<std::size_t>(index); }

inline void show(const model::TipProbe& probe, model::TipIndicator* tips) noexcept {
    for (int tip = 0; tip < model::tips_per_link; ++tip) tips[tip] = {probe.depth[tip], probe.slip[tip]};
}

/// The four tips of a link whose state is given.
inline void indicate(const Workspace& w, const double* state, const model::SheaveMotion* sheaves, model::TipIndicator* tips,
                     model::TipProbe& probe) noexcept {
    w.variator.chain().probe(state, sheaves, w.parameters.detail.stick_slip, probe);
    show(probe, tips);
}

/// Whether a tip may change in this step: it will have kept its phase for the dwell time. The same answer however the step is cut.
[[nodiscard]] inline bool may_change(const Workspace& w, int tip) noexcept {
    return w.step.search_until - w.tips.changed[at(tip)] >= w.step.dwell;
}

}  // namespace cvtflow::tasks
