/// Detection after every step: soundness of the state, depth of every tip, transitions that are due.

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "tasks/step/step_graph.hpp"
#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

namespace {

using model::Phase;
using model::TipIndicator;

/// time [s], value [unit of what is limited], limit [the same unit]
void report(SegmentResult& result, FaultKind kind, double time, int pin, double value, double limit) noexcept {
    if (!result.fault) result.fault = {kind, time, pin, value, limit};
}

/// Whether all numbers are within ±limit; false for NaN. By their bits, which are in the order of magnitudes: that takes vectors on every
/// instruction set, and every detect cycle checks every link. numbers [unit of the limit], limit [the same unit, not negative]
[[nodiscard]] bool within(const double* numbers, int size, double limit) noexcept {
    constexpr std::uint64_t magnitude = std::numeric_limits<std::uint64_t>::max() >> 1;
    const auto largest = std::bit_cast<std::uint64_t>(limit);
    std::uint64_t beyond = 0;  // its first bit: some difference was negative
    for (int k = 0; k < size; ++k) beyond |= largest - (std::bit_cast<std::uint64_t>(numbers[k]) & magnitude);
    return beyond <= magnitude;
}

/// Whether a tip could have changed and changed back inside the step, judged on the parabola through both ends and the first slope.
[[nodiscard]] bool grazes(const Workspace& w, int tip, const TipIndicator& middle) noexcept {
    const Phase phase = w.tips.phases[at(tip)];
    return w.rule.next(phase, w.tips.before[at(tip)]) == phase && w.rule.next(phase, middle) != phase;
}

constexpr double near = 2e-7;  // m: an elastic oscillation of 1e6 1/s covers less in the longest useful step

/// Whether all tips of a link are free and far from contact, so that nothing can be due.
[[nodiscard]] bool is_far(const Workspace& w, int link, const model::TipProbe& probe) noexcept {
    bool far = true;
    for (int tip = 0; tip < model::tips_per_link; ++tip)
        far = far && w.tips.phases[at(model::tips_per_link * link + tip)] == Phase::free && probe.depth[tip] < -near;
    return far;
}

/// Tips so close to contact that they can cross and return within a step.
[[nodiscard]] bool near_contact(const Workspace& w, int link) noexcept {
    const int first = model::tips_per_link * link;
    for (int tip = first; tip < first + model::tips_per_link; ++tip) {
        if (std::abs(w.tips.before[at(tip)].depth) < near && std::abs(w.tips.after[at(tip)].depth) < near) return true;
    }
    return false;
}

/// @param end states at the step's end, of the link and of its neighbours beside it
void check_middle(Workspace& w, int link, const double* end, SegmentResult& result) noexcept {
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
        if (!w.step.slopes_from_states()) return slope[k];
        return k < size ? start[size + k] : (end[k] - start[k]) / w.step.h;
    };
    for (int k = 0; k < layout.link_block(); ++k)
        middle.place(layout, 0)[k] = 0.75 * start[k] + 0.25 * end[k] + 0.25 * w.step.h * slope_at(k);
    TipIndicator tips[model::tips_per_link];
    model::TipProbe probe;
    indicate(w, middle.place(layout, 0), w.pulleys.end_sheaves, tips, probe);
    for (int tip = 0; tip < model::tips_per_link; ++tip) {
        const int number = model::tips_per_link * link + tip;
        if (may_change(w, number) && grazes(w, number, tips[tip])) result.pending = true;
    }
}

/// Transitions due at the step's end, among the tips of one link.
void find_due(Workspace& w, int link, SegmentResult& result) noexcept {
    const int first = model::tips_per_link * link;
    for (int tip = first; tip < first + model::tips_per_link; ++tip) {
        if (w.rule.next(w.tips.phases[at(tip)], w.tips.after[at(tip)]) == w.tips.phases[at(tip)]) continue;
        if (may_change(w, tip)) {
            result.pending = true;
        } else {
            ++result.suppressed;
        }
    }
}

template <int size>
void secants_of_links(Workspace& w, const Segment& bounds) noexcept {
    const double h = w.step.h;
    for (int link = bounds.first; link < bounds.last; ++link) {
        const int begin = w.layout().link_begin(link);
        const double* __restrict from = w.states[0] + begin + size;
        const double* __restrict to = w.end_state + begin + size;
        std::memcpy(w.end_slope + begin, to, size * sizeof(double));
        double* __restrict mean = w.end_slope + begin + size;
        for (int k = 0; k < size; ++k) mean[k] = (to[k] - from[k]) / h;
    }
}

/// Slopes of a segment's links at the end of a step from its states at both ends: velocities, and the mean acceleration. (Those at the
/// start are needed only if a transition is due: TransitionSearch::complete_start_slopes.)
void make_secants(Workspace& w, const Segment& bounds) noexcept {
    switch (w.layout().link_size()) {
        case 8: return secants_of_links<8>(w, bounds);
        case 12: return secants_of_links<12>(w, bounds);
        case 16: return secants_of_links<16>(w, bounds);
        default: return secants_of_links<20>(w, bounds);
    }
}

/// Local error of each link of a segment: the maximum does not depend on the segments.
/// @param errors room for one link
void estimate_errors(Workspace& w, const Segment& bounds, double* errors) noexcept {
    const model::ChainLayout& layout = w.layout();
    for (int link = bounds.first; link < bounds.last; ++link) {
        const int begin = layout.link_begin(link);
        engine::combine(w.step.error_row, w.step.h, w.slots(), begin, begin + layout.link_block(), errors);
        w.links.errors[at(link)] = w.step.error_scale.norm(errors, layout.link_size());
    }
}

/// Whether a link's block [q | v] is finite and its motion that of a chain.
void check_motion(const Workspace& w, int link, const double* block, SegmentResult& result) noexcept {
    const int size = w.layout().link_size();
    if (within(block, size, std::numeric_limits<double>::max()) && within(block + size, size, fastest_pin)) return;
    double largest = 0.0;
    bool finite = true;
    for (int k = 0; k < 2 * size; ++k) finite = finite && std::isfinite(block[k]);
    for (int k = size; k < 2 * size; ++k) largest = std::max(largest, std::abs(block[k]));
    if (!finite) return report(result, FaultKind::non_finite, w.step.time + w.step.h, link, 0.0, 0.0);
    report(result, FaultKind::blow_up, w.step.time + w.step.h, link, largest, fastest_pin);
}

/// Whether a link's tips are where contact can be described.
void check_contact(const Workspace& w, int link, const model::TipProbe& probe, SegmentResult& result) noexcept {
    const auto& pulley = w.parameters.pulley;
    const double now = w.step.time + w.step.h;
    bool touching = false;
    for (int tip = 0; tip < model::tips_per_link; ++tip) {
        if (w.tips.phases[at(model::tips_per_link * link + tip)] == model::Phase::free) continue;
        touching = true;
        if (probe.depth[tip] > w.parameters.tip.deepest)
            report(result, FaultKind::penetration, now, link, probe.depth[tip], w.parameters.tip.deepest);
    }
    if (probe.radius < pulley.innermost) report(result, FaultKind::left_sheave, now, link, probe.radius, pulley.innermost);
    if (touching && probe.radius > pulley.outermost) report(result, FaultKind::left_sheave, now, link, probe.radius, pulley.outermost);
}

}  // namespace

void close_tail(Workspace& w) noexcept {
    const model::ChainLayout& layout = w.layout();
    const int begin = layout.pulley_begin(), half = layout.pulley_size;
    engine::combine(w.step.row, w.step.h, w.slots(), begin, layout.size(), w.end_state + begin);
    if (!w.step.slopes_from_states()) return;
    for (int k = begin; k < layout.size(); ++k) {  // velocities, and one mean acceleration
        const double mean = (w.end_state[k] - w.states[0][k]) / w.step.h;
        const bool position = k < begin + half;
        w.slopes[0][k] = position ? w.states[0][k + half] : mean;
        w.end_slope[k] = position ? w.end_state[k + half] : mean;
    }
}

Fault check_tail(const Workspace& w) noexcept {
    const double* tail = w.end_state + w.layout().pulley_begin();
    for (int k = 0; k < w.tail_size(); ++k) {
        if (!std::isfinite(tail[k])) return {FaultKind::non_finite, w.step.time + w.step.h, {}, 0.0, 0.0};
    }
    return {};
}

Fault find_fault(const Workspace& w, const double* state) noexcept {
    const model::ChainLayout& layout = w.layout();
    SegmentResult result;
    for (int link = 0; link < layout.links && !result.fault; ++link) check_motion(w, link, state + layout.link_begin(link), result);
    if (result.fault || layout.pulley_size == 0) return result.fault;
    model::SheaveMotion sheaves[4];
    w.variator.pulleys().motions(state + layout.pulley_begin(), sheaves);
    for (int link = 0; link < layout.links && !result.fault; ++link) {
        model::NeighbourWindow near;
        model::TipProbe probe;
        w.variator.chain().probe(near.of(layout, state, link), sheaves, false, probe);
        check_contact(w, link, probe, result);
    }
    return result.fault;
}

void detect_segment(void* workspace, int segment) noexcept {
    auto& w = *static_cast<Workspace*>(workspace);
    const model::ChainLayout& layout = w.layout();
    const Segment& bounds = w.partition[segment];
    SegmentResult& result = w.segment_results[at(segment)];
    result = {};
    engine::combine(w.step.row, w.step.h, w.slots(), layout.link_begin(bounds.first),
                    layout.link_begin(bounds.last - 1) + layout.link_block(), w.end_state + layout.link_begin(bounds.first));
    if (w.step.slopes_from_states()) make_secants(w, bounds);
    if (w.step.estimate_error) estimate_errors(w, bounds, w.windows[at(segment)].data());
    // States of the links beside it may not be written yet by other segments: they are combined once more.
    const int halo = layout.probe_halo();
    const double* end =
        halo == 0 ? w.end_state + layout.link_begin(bounds.first) : fill_window(w, segment, halo) + halo * layout.link_block();
    if (layout.pulley_size != 0) {
        w.variator.chain().probe_links(end, bounds.size(), w.pulleys.end_sheaves, w.parameters.detail.stick_slip,
                                       w.tips.probes.data() + bounds.first);
    }
    const bool sound = within(w.end_state + layout.link_begin(bounds.first), bounds.size() * layout.link_block(), fastest_pin);
    for (int link = bounds.first; link < bounds.last; ++link) {
        if (!sound) check_motion(w, link, w.end_state + layout.link_begin(link), result);
        if (layout.pulley_size == 0 || result.fault) continue;
        const model::TipProbe& probe = w.tips.probes[at(link)];
        show(probe, w.tips.after.data() + model::tips_per_link * link);
        check_contact(w, link, probe, result);
        if (is_far(w, link, probe)) continue;
        find_due(w, link, result);
        if (near_contact(w, link)) check_middle(w, link, end + (link - bounds.first) * layout.link_block(), result);
    }
}

}  // namespace cvtflow::tasks
