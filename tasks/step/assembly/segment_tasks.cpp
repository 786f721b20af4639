#include "tasks/step/assembly/segment_tasks.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "engine/event/locate.hpp"
#include "tasks/step/assembly/motion_check.hpp"
#include "tasks/step/assembly/near_blocks.hpp"
#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

namespace {

using model::Phase;
using model::TipIndicator;

[[nodiscard]] std::size_t at(int index) noexcept { return static_cast<std::size_t>(index); }

[[nodiscard]] model::SheaveMotion* sheaves_at(Workspace& w, double theta, double* tail, model::SheaveMotion* sheaves) noexcept {
    const model::ChainLayout& layout = w.layout();
    w.interpolant().evaluate(theta, layout.pulley_begin(), layout.pulley_begin() + layout.pulley_block(), tail);
    w.variator.pulleys().motions(tail, sheaves);
    return sheaves;
}

/// Tips of a link that there are: whole pins have none at the front.
[[nodiscard]] int tips_of(const Workspace& w) noexcept { return w.layout().whole ? model::tips_per_link / 2 : model::tips_per_link; }

void show(const model::TipProbe& probe, TipIndicator* tips) noexcept {
    for (int tip = 0; tip < model::tips_per_link; ++tip) tips[tip] = {probe.depth[tip], probe.slip[tip]};
}

/// The four tips of a link whose state is given.
void indicate(const Workspace& w, const double* state, const model::SheaveMotion* sheaves, TipIndicator* tips,
              model::TipProbe& probe) noexcept {
    w.variator.chain().probe(state, sheaves, w.parameters.detail.stick_slip, probe);
    show(probe, tips);
}

/// Whether a link's tips are where contact can be described.
void check_contact(const Workspace& w, int link, const model::TipProbe& probe, Verdict& verdict) noexcept {
    const auto& pulley = w.parameters.pulley;
    const double now = w.step.time + w.step.h;
    bool touching = false;
    for (int tip = 0; tip < tips_of(w); ++tip) {
        if (w.tips.phases[at(model::tips_per_link * link + tip)] == Phase::free) continue;
        touching = true;
        if (probe.depth[tip] > w.parameters.tip.deepest)
            report(verdict, FaultKind::penetration, now, link, probe.depth[tip], w.parameters.tip.deepest);
    }
    if (probe.radius < pulley.innermost) report(verdict, FaultKind::left_sheave, now, link, probe.radius, pulley.innermost);
    if (touching && probe.radius > pulley.outermost) report(verdict, FaultKind::left_sheave, now, link, probe.radius, pulley.outermost);
}

/// Whether a tip may change now: it has kept its phase for the dwell time.
[[nodiscard]] bool may_change(const Workspace& w, int tip) noexcept {
    return w.step.time + w.step.h - w.tips.changed[at(tip)] >= w.step.dwell;
}

/// Where inside the step a tip could have changed and changed back, judged on the parabola through both ends and the first slope.
[[nodiscard]] bool grazes(const Workspace& w, int tip, const TipIndicator& middle) noexcept {
    const Phase phase = w.tips.phases[at(tip)];
    return w.rule.next(phase, w.tips.before[at(tip)]) == phase && w.rule.next(phase, middle) != phase;
}

/// Tips so close to contact that they can cross and return within a step.
[[nodiscard]] bool near_contact(const Workspace& w, int link) noexcept {
    constexpr double near = 2e-7;  // m: an elastic oscillation of 1e6 1/s covers less in the longest useful step
    const int first = model::tips_per_link * link;
    for (int tip = first; tip < first + tips_of(w); ++tip) {
        if (std::abs(w.tips.before[at(tip)].depth) < near && std::abs(w.tips.after[at(tip)].depth) < near) return true;
    }
    return false;
}

/// @param end states at the step's end, of the link and of its neighbours beside it
void check_middle(Workspace& w, int link, const double* end, Verdict& verdict) noexcept {
    const model::ChainLayout& layout = w.layout();
    NearBlocks middle;
    const int size = layout.link_size();
    for (int from = -layout.probe_halo(); from <= layout.probe_halo(); ++from) {
        const double* before = w.states[0] + layout.link_begin(layout.wrapped(link + from));
        const double* after = end + from * layout.link_block();
        double* to = middle.place(layout, from);
        for (int k = 0; k < size; ++k) to[k] = 0.75 * before[k] + 0.25 * after[k] + 0.25 * w.step.h * before[size + k];
        for (int k = size; k < 2 * size; ++k) to[k] = 0.5 * (before[k] + after[k]);
    }
    const int begin = layout.link_begin(link);
    const double *start = w.states[0] + begin, *slope = w.slopes[0] + begin;
    const auto slope_at = [&](int k) noexcept {
        if (!w.step.secant) return slope[k];
        return k < size ? start[size + k] : (end[k] - start[k]) / w.step.h;
    };
    for (int k = 0; k < layout.link_block(); ++k)
        middle.place(layout, 0)[k] = 0.75 * start[k] + 0.25 * end[k] + 0.25 * w.step.h * slope_at(k);
    TipIndicator tips[model::tips_per_link];
    model::TipProbe probe;
    indicate(w, middle.place(layout, 0), w.pulleys.end_sheaves, tips, probe);
    for (int tip = 0; tip < model::tips_per_link; ++tip) {
        const int number = model::tips_per_link * link + tip;
        if (may_change(w, number) && grazes(w, number, tips[tip])) verdict.pending = true;
    }
}

/// Transitions due at the step's end, among the tips of one link.
void find_due(Workspace& w, int link, Verdict& verdict) noexcept {
    const int first = model::tips_per_link * link;
    for (int tip = first; tip < first + tips_of(w); ++tip) {
        if (w.rule.next(w.tips.phases[at(tip)], w.tips.after[at(tip)]) == w.tips.phases[at(tip)]) continue;
        if (may_change(w, tip)) {
            verdict.pending = true;
        } else {
            ++verdict.suppressed;
        }
    }
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
void change_phases(Workspace& w, int link, const TipIndicator* tips, Verdict& verdict) noexcept {
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

namespace {

/// Slopes of a segment's links at the end of a step from its states at both ends: velocities, and the mean acceleration. (Those at the
/// start are wanted only where a transition is due: StepController::make_start_secants.)
void make_secants(Workspace& w, const Segment& own) noexcept {
    const model::ChainLayout& layout = w.layout();
    const int half = layout.link_size();
    const double h = w.step.h;
    for (int link = own.first; link < own.last; ++link) {
        const int begin = layout.link_begin(link);
        const double* __restrict from = w.states[0] + begin + half;
        const double* __restrict to = w.end_state + begin + half;
        std::memcpy(w.end_slope + begin, to, at(half) * sizeof(double));
        double* __restrict mean = w.end_slope + begin + half;
        for (int k = 0; k < half; ++k) mean[k] = (to[k] - from[k]) / h;
    }
}

/// Local errors of a segment's links, each by itself: whoever asks for the largest gets the same however the chain is cut.
/// @param errors room for one link
void estimate_errors(Workspace& w, const Segment& own, double* errors) noexcept {
    const model::ChainLayout& layout = w.layout();
    for (int link = own.first; link < own.last; ++link) {
        const int begin = layout.link_begin(link);
        engine::combine(w.step.error_row, w.step.h, w.slots(), begin, begin + layout.link_block(), errors);
        w.links.errors[at(link)] = w.step.error_scale.norm(errors, layout.link_size());
    }
}

}  // namespace

void detect_segment(void* workspace, int segment) noexcept {
    auto& w = *static_cast<Workspace*>(workspace);
    const model::ChainLayout& layout = w.layout();
    const Segment& own = w.partition[segment];
    Verdict& verdict = w.verdicts[at(segment)];
    verdict = {};
    if (!w.step.links_ended) {
        engine::combine(w.step.row, w.step.h, w.slots(), layout.link_begin(own.first),
                        layout.link_begin(own.last - 1) + layout.link_block(), w.end_state + layout.link_begin(own.first));
    }
    if (w.step.secant) make_secants(w, own);
    if (w.step.estimate_error) estimate_errors(w, own, w.windows[at(segment)].data());
    const double* end = end_blocks(w, segment);
    if (layout.pulley_size != 0) {
        w.variator.chain().probe_links(end, own.size(), w.pulleys.end_sheaves, w.parameters.detail.stick_slip,
                                       w.tips.probes.data() + own.first);
    }
    for (int link = own.first; link < own.last; ++link) {
        check_motion(w, link, w.end_state + layout.link_begin(link), verdict);
        if (layout.pulley_size == 0 || verdict.fault) continue;
        const model::TipProbe& probe = w.tips.probes[at(link)];
        show(probe, w.tips.after.data() + model::tips_per_link * link);
        check_contact(w, link, probe, verdict);
        find_due(w, link, verdict);
        if (near_contact(w, link)) check_middle(w, link, end + (link - own.first) * layout.link_block(), verdict);
    }
}

void locate_segment(void* workspace, int segment) noexcept {
    auto& w = *static_cast<Workspace*>(workspace);
    const Segment& own = w.partition[segment];
    Verdict& verdict = w.verdicts[at(segment)];
    constexpr double middle = 0.5;
    model::SheaveMotion sheaves[4];
    double tail[2 * 36];
    probe_segment(w, segment, middle, sheaves_at(w, middle, tail, sheaves));
    for (int link = own.first; link < own.last; ++link) {
        for (int corner = 0; corner < tips_of(w); ++corner) {
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
    Verdict& verdict = w.verdicts[at(segment)];
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
