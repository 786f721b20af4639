#include "tasks/step/assembly/segment_tasks.hpp"

#include <algorithm>
#include <cstring>

#include "engine/event/interpolant.hpp"
#include "tasks/step/assembly/near_blocks.hpp"
#include "tasks/step/assembly/tip_states.hpp"
#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

namespace {

using model::Phase;
using model::TipIndicator;

[[nodiscard]] model::SheaveMotion* sheaves_at(Workspace& w, double theta, double* tail, model::SheaveMotion* sheaves) noexcept {
    const model::ChainLayout& layout = w.layout();
    w.interpolant().evaluate(theta, layout.pulley_begin(), layout.pulley_begin() + layout.pulley_block(), tail);
    w.variator.pulleys().motions(tail, sheaves);
    return sheaves;
}

/// Tips of one link at a share of the step.
class LinkAt {
public:
    LinkAt(Workspace& w, int link) noexcept : w_(w), link_(link) {}

    [[nodiscard]] const TipIndicator* tips(double theta) noexcept {
        const double* state = near_at(w_, link_, theta, blocks_);
        model::SheaveMotion sheaves[4];
        double tail[2 * 36];
        model::TipProbe probe;
        indicate(w_, state, sheaves_at(w_, theta, tail, sheaves), tips_, probe);
        return tips_;
    }

private:
    Workspace& w_;
    int link_;
    NearBlocks blocks_;
    TipIndicator tips_[model::tips_per_link];
};

/// Tips of a segment's links at a share of the step, side by side: to workspace.tips.probes.
void probe_segment(Workspace& w, int segment, double theta, const model::SheaveMotion* sheaves) noexcept {
    const Segment& own = w.partition[segment];
    w.variator.chain().probe_links(blocks_at(w, segment, theta), own.size(), sheaves, w.parameters.detail.stick_slip,
                                   w.tips.probes.data() + own.first);
}

/// Earliest transition of one tip that may change, if any; probes of the links in the middle of the step must be there.
[[nodiscard]] Transition locate_tip(Workspace& w, int link, int corner) noexcept {
    const int tip = model::tips_per_link * link + corner;
    const Phase phase = w.tips.phases[at(tip)];
    double end = 1.0;
    Phase to = w.rule.next(phase, w.tips.after[at(tip)]);
    if (to == phase) {  // perhaps there and back within the step
        end = 0.5;
        const model::TipProbe& middle = w.tips.probes[at(link)];
        to = w.rule.next(phase, {middle.depth[corner], middle.slip[corner]});
        if (to == phase) return {};
    }
    const double from = w.rule.due(phase, to, w.tips.before[at(tip)]);
    if (from > 0.0) return {0.0, tip, to};  // was due already, but had been put off
    LinkAt state(w, link);
    const auto gap = [&](double theta) noexcept { return w.rule.due(phase, to, state.tips(theta)[corner]); };
    return {engine::locate(gap, 0.0, end, from, gap(end), 1e-9).theta, tip, to};
}

/// Gives every tip of a link the phase that is due at the cut.
void change_phases(Workspace& w, int link, const TipIndicator* tips, SegmentResult& verdict) noexcept {
    const double now = w.step.time + w.step.theta * w.step.h;
    for (int corner = 0; corner < model::tips_per_link; ++corner) {
        const std::size_t tip = at(model::tips_per_link * link + corner);
        Phase to = w.rule.next(w.tips.phases[tip], tips[corner]);
        if (to == w.tips.phases[tip] && w.step.secant && static_cast<int>(tip) == w.step.due.tip)
            to = w.step.due.to;  // retaken: there but for the error of the search
        if (to == w.tips.phases[tip] || !may_change(w, static_cast<int>(tip))) continue;
        w.tips.phases[tip] = to;
        w.tips.changed[tip] = now;
        ++verdict.detected;
    }
}

}  // namespace

void evaluate_segment(void* workspace, int segment) noexcept {
    auto& w = *static_cast<Workspace*>(workspace);
    const model::ChainLayout& layout = w.layout();
    const Segment& own = w.partition[segment];
    double* window = w.windows[at(segment)].data();
    if (w.step.evaluate_end) {
        copy_window(w, own, w.end_state, window);
    } else {
        fill_window(w, own, window);
        if (w.step.row.keep >= 0) {
            std::memcpy(w.states[at(w.step.row.keep)] + layout.link_begin(own.first), window + layout.halo() * layout.link_block(),
                        at(own.size() * layout.link_block()) * sizeof(double));
        }
    }
    const model::ChainRange range{own.first, own.last, window, w.pulleys.sheaves, w.tips.phases.data()};
    double* slope = w.step.slope_out + layout.link_begin(own.first);
    if (layout.ledger) {
        w.variator.chain().observed_slopes(range, slope, w.links.loads.data() + own.first, cleared_accounts(w, own));
    } else {
        w.variator.chain().slopes(range, slope, w.links.loads.data() + own.first);
    }
    if (layout.pulley_size != 0) w.add_up(own);
}

void locate_segment(void* workspace, int segment) noexcept {
    auto& w = *static_cast<Workspace*>(workspace);
    const Segment& own = w.partition[segment];
    SegmentResult& verdict = w.segment_results[at(segment)];
    constexpr double middle = 0.5;
    model::SheaveMotion sheaves[4];
    double tail[2 * 36];
    probe_segment(w, segment, middle, sheaves_at(w, middle, tail, sheaves));
    for (int link = own.first; link < own.last; ++link) {
        for (int corner = 0; corner < model::tips_per_link; ++corner) {
            if (!may_change(w, model::tips_per_link * link + corner)) continue;
            const Transition found = locate_tip(w, link, corner);
            if (found.theta < verdict.first.theta) verdict.first = found;
        }
    }
}

void truncate_segment(void* workspace, int segment) noexcept {
    auto& w = *static_cast<Workspace*>(workspace);
    const model::ChainLayout& layout = w.layout();
    const Segment& own = w.partition[segment];
    SegmentResult& verdict = w.segment_results[at(segment)];
    w.interpolant().evaluate(w.step.theta, layout.link_begin(own.first), layout.link_begin(own.last - 1) + layout.link_block(),
                             w.cut_state + layout.link_begin(own.first));
    probe_segment(w, segment, w.step.theta, w.pulleys.sheaves);
    for (int link = own.first; link < own.last; ++link) {
        TipIndicator* tips = w.tips.after.data() + model::tips_per_link * link;
        show(w.tips.probes[at(link)], tips);
        change_phases(w, link, tips, verdict);
    }
}

}  // namespace cvtflow::tasks
