#include "tasks/step/step_graph.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>

#include "engine/event/interpolant.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

namespace {

FurtherAssembly& further_assembly() {
    static FurtherAssembly none{nullptr, nullptr};
    return none;
}

/// One task per segment and cycle, joints at segment borders computed by both neighbours: a single synchronisation per evaluation.
engine::TaskGraph fused_graph(const Workspace& w) {
    engine::TaskGraph graph;
    for (int s = 0; s < w.partition.size(); ++s) {
        const std::string number = "[" + std::to_string(s) + "]";
        // Slots that a stage reads are never the ones it writes: bench/method/analysis/order.hpp checks that.
        graph.add({"force" + number, evaluate_cycle, evaluate_segment, s,
                   LinkAccesses(w, s)
                       .with_halo(Field::states_read)
                       .with_halo(Field::slopes_read)
                       .with_halo(Field::end_state)
                       .inside(Field::slope_written, true)
                       .inside(Field::state_kept, true)
                       .inside(Field::load, true)
                       .inside(Field::account, true)
                       .inside(Field::phase, false)
                       .segment(Field::window, true)
                       .list(),
                   "all forces (fused)"});
        add_transition_tasks(graph, w, s);
        add_observe_task(graph, w, s);
    }
    return graph;
}

}  // namespace

void add_assembly(const FurtherAssembly& staged) { further_assembly() = staged; }

bool has_assembly(Assembly kind) noexcept { return kind == Assembly::fused || further_assembly().graph != nullptr; }

std::unique_ptr<AssemblyMemory> further_memory(Workspace& w) {
    return further_assembly().memory == nullptr ? nullptr : further_assembly().memory(w);
}

engine::TaskGraph step_graph(const Workspace& w, const AssemblyOptions& options, StepMethod* method) {
    if (!has_assembly(options.kind)) throw std::invalid_argument("assembly \"staged\" belongs to the laboratory: cvtflow-lab");
    engine::TaskGraph graph = options.kind == Assembly::fused ? fused_graph(w) : further_assembly().graph(w, options);
    if (method != nullptr) method->add_tasks(graph);
    graph.freeze();
    return graph;
}

void add_transition_tasks(engine::TaskGraph& graph, const Workspace& w, int s, bool detect) {
    const std::string number = "[" + std::to_string(s) + "]";
    const auto accesses = [&] {
        return LinkAccesses(w, s)
            .with_near(Field::states_read)
            .with_near(Field::slopes_read)
            .segment(Field::window, true)
            .segment(Field::result, true);
    };
    if (detect)
        graph.add({"detect" + number, detect_cycle, detect_segment, s,
                   accesses()
                       .inside(Field::secant, true)
                       .inside(Field::phase, false)
                       .inside(Field::before, false)
                       .inside(Field::end_state, true)
                       .inside(Field::after, true)
                       .inside(Field::link_error, true)
                       .list(),
                   transition_stage});
    graph.add(
        {"locate" + number, locate_cycle, locate_segment, s,
         accesses().with_near(Field::end_state).inside(Field::phase, false).inside(Field::before, false).inside(Field::after, false).list(),
         transition_stage});
    graph.add(
        {"truncate" + number, truncate_cycle, truncate_segment, s,
         accesses().with_near(Field::end_state).inside(Field::after, true).inside(Field::cut_state, true).inside(Field::phase, true).list(),
         transition_stage});
}

void add_observe_task(engine::TaskGraph& graph, const Workspace& w, int s) {
    graph.add({"observe[" + std::to_string(s) + "]", observe_cycle, observe_segment, s,
               LinkAccesses(w, s)
                   .with_halo(Field::states_read)
                   .inside(Field::phase, false)
                   .inside(Field::load, true)
                   .inside(Field::account, true)
                   .inside(Field::cut_state, true)
                   .segment(Field::window, true)
                   .list()});
}

namespace {

using model::Phase;
using model::TipIndicator;

/// Calls put(first link, links, place in a window) for a segment's links and `halo` on each side of them.
template <class Put>
void for_each_run(const model::ChainLayout& layout, const Segment& bounds, int halo, const Put& put) noexcept {
    put(bounds.first, bounds.size(), halo);
    for (int k = 0; k < halo; ++k) {
        put(layout.wrapped(bounds.first + k - halo), 1, k);
        put(layout.wrapped(bounds.last + k), 1, halo + bounds.size() + k);
    }
}

/// Copies a segment's window out of a state vector, such as the end of the step.
const double* copy_window(Workspace& w, int segment, const double* state) noexcept {
    const model::ChainLayout& layout = w.layout();
    const int block = layout.link_block();
    double* window = w.windows[at(segment)].data();
    for_each_run(layout, w.partition[segment], layout.halo(), [&](int link, int links, int place) {
        std::memcpy(window + place * block, state + layout.link_begin(link), at(links * block) * sizeof(double));
    });
    return window;
}

/// The accounts of a segment's links, all zero.
[[nodiscard]] model::Account* cleared_accounts(Workspace& w, const Segment& bounds) noexcept {
    model::Account* accounts = w.links.accounts.data() + model::account_parts * bounds.first;
    std::fill(accounts, accounts + model::account_parts * bounds.size(), model::Account{});
    return accounts;
}

/// The motion of the four sheaves at a share of the step.
void sheaves_at(const Workspace& w, double theta, model::SheaveMotion* sheaves) noexcept {
    const model::ChainLayout& layout = w.layout();
    double tail[2 * 36];
    w.interpolant().evaluate(theta, layout.pulley_begin(), layout.control_begin(), tail);
    w.variator.pulleys().motions(tail, sheaves);
}

/// A tip of a link at a share of the step.
[[nodiscard]] TipIndicator tip_at(const Workspace& w, int link, int corner, double theta) noexcept {
    const model::ChainLayout& layout = w.layout();
    NearBlocks blocks;
    for (int from = -layout.probe_halo(); from <= layout.probe_halo(); ++from) {
        const int begin = layout.link_begin(layout.wrapped(link + from));
        w.interpolant().evaluate(theta, begin, begin + layout.link_block(), blocks.place(layout, from));
    }
    model::SheaveMotion sheaves[4];
    sheaves_at(w, theta, sheaves);
    TipIndicator tips[model::tips_per_link];
    model::TipProbe probe;
    indicate(w, blocks.place(layout, 0), sheaves, tips, probe);
    return tips[corner];
}

/// Tips of a segment's links at a share of the step, side by side: to workspace.tips.probes.
void probe_segment(Workspace& w, int segment, double theta, const model::SheaveMotion* sheaves) noexcept {
    const model::ChainLayout& layout = w.layout();
    const Segment& bounds = w.partition[segment];
    const int block = layout.link_block();
    double* window = w.windows[at(segment)].data();
    for_each_run(layout, bounds, layout.probe_halo(), [&](int link, int links, int place) {
        const int begin = layout.link_begin(link);
        w.interpolant().evaluate(theta, begin, begin + links * block, window + place * block);
    });
    w.variator.chain().probe_links(window + layout.probe_halo() * block, bounds.size(), sheaves, w.parameters.detail.stick_slip,
                                   w.tips.probes.data() + bounds.first);
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
    const auto gap = [&](double theta) noexcept { return w.rule.due(phase, to, tip_at(w, link, corner, theta)); };
    return {engine::locate(gap, 0.0, end, from, gap(end), 1e-9).theta, tip, to};
}

/// Gives every tip of a link the phase that is due at the cut.
void change_phases(Workspace& w, int link, const TipIndicator* tips, SegmentResult& result) noexcept {
    const double now = w.step.time + w.step.theta * w.step.h;
    for (int corner = 0; corner < model::tips_per_link; ++corner) {
        const std::size_t tip = at(model::tips_per_link * link + corner);
        Phase to = w.rule.next(w.tips.phases[tip], tips[corner]);
        if (to == w.tips.phases[tip] && w.step.slopes_from_states() && static_cast<int>(tip) == w.step.due.tip)
            to = w.step.due.to;  // retaken: there but for the error of the search
        if (to == w.tips.phases[tip] || !may_change(w, static_cast<int>(tip))) continue;
        w.tips.phases[tip] = to;
        w.tips.changed[tip] = now;
        ++result.detected;
    }
}

}  // namespace

void evaluate_segment(void* workspace, int segment) noexcept {
    auto& w = *static_cast<Workspace*>(workspace);
    const model::ChainLayout& layout = w.layout();
    const Segment& bounds = w.partition[segment];
    const double* window = w.step.evaluate_end ? copy_window(w, segment, w.end_state) : fill_window(w, segment, layout.halo());
    if (!w.step.evaluate_end && w.step.row.keep >= 0) {
        std::memcpy(w.states[at(w.step.row.keep)] + layout.link_begin(bounds.first), window + layout.halo() * layout.link_block(),
                    at(bounds.size() * layout.link_block()) * sizeof(double));
    }
    const model::ChainRange range{bounds.first, bounds.last, window, w.pulleys.sheaves, w.tips.phases.data()};
    double* slope = w.step.slope_out + layout.link_begin(bounds.first);
    if (layout.ledger) {
        w.variator.chain().observed_slopes(range, slope, w.links.loads.data() + bounds.first, cleared_accounts(w, bounds));
    } else {
        w.variator.chain().slopes(range, slope, w.links.loads.data() + bounds.first);
    }
    if (layout.pulley_size != 0) add_up(w, bounds);
}

void locate_segment(void* workspace, int segment) noexcept {
    auto& w = *static_cast<Workspace*>(workspace);
    const Segment& bounds = w.partition[segment];
    SegmentResult& result = w.segment_results[at(segment)];
    constexpr double middle = 0.5;
    model::SheaveMotion sheaves[4];
    sheaves_at(w, middle, sheaves);
    probe_segment(w, segment, middle, sheaves);
    for (int link = bounds.first; link < bounds.last; ++link) {
        for (int corner = 0; corner < model::tips_per_link; ++corner) {
            if (!may_change(w, model::tips_per_link * link + corner)) continue;
            const Transition found = locate_tip(w, link, corner);
            if (found.theta < result.first.theta) result.first = found;
        }
    }
}

void truncate_segment(void* workspace, int segment) noexcept {
    auto& w = *static_cast<Workspace*>(workspace);
    const model::ChainLayout& layout = w.layout();
    const Segment& bounds = w.partition[segment];
    SegmentResult& result = w.segment_results[at(segment)];
    w.interpolant().evaluate(w.step.theta, layout.link_begin(bounds.first), layout.link_begin(bounds.last - 1) + layout.link_block(),
                             w.cut_state + layout.link_begin(bounds.first));
    probe_segment(w, segment, w.step.theta, w.pulleys.sheaves);
    for (int link = bounds.first; link < bounds.last; ++link) {
        TipIndicator* tips = w.tips.after.data() + model::tips_per_link * link;
        show(w.tips.probes[at(link)], tips);
        change_phases(w, link, tips, result);
    }
}

const double* advance_window(Workspace& w, int segment, model::LinkAdvance* kernel, GhostLink* ghosts) noexcept {
    const model::ChainLayout& layout = w.layout();
    const int block = layout.link_block();
    const engine::Term& slope = w.step.row.slopes.front();
    const double *from = w.states[at(w.step.row.states.front().slot)], *along = w.slopes[at(slope.slot)];
    const double by = w.step.h * slope.factor;
    double* window = w.windows[at(segment)].data();
    for_each_run(layout, w.partition[segment], layout.halo(), [&](int link, int links, int place) {
        const int begin = layout.link_begin(link);
        double* const to = window + place * block;
        if (ghosts == nullptr || place == layout.halo()) return kernel(from + begin, along + begin, by, to, links);
        GhostLink& ghost = ghosts[place == 0 ? 0 : 1];
        kernel(ghost.start.data(), ghost.slope.data(), by, ghost.middle.data(), 1);
        std::ranges::copy(ghost.middle, to);
    });
    return window;
}

const double* fill_window(Workspace& w, int segment, int halo) noexcept {
    const model::ChainLayout& layout = w.layout();
    const int block = layout.link_block();
    double* window = w.windows[at(segment)].data();
    for_each_run(layout, w.partition[segment], halo, [&](int link, int links, int place) {
        const int begin = layout.link_begin(link);
        engine::combine(w.step.row, w.step.h, w.slots(), begin, begin + links * block, window + place * block);
    });
    return window;
}

void observe_segment(void* workspace, int segment) noexcept {
    auto& w = *static_cast<Workspace*>(workspace);
    const model::ChainLayout& layout = w.layout();
    const Segment& bounds = w.partition[segment];
    const model::ChainRange range{bounds.first, bounds.last, copy_window(w, segment, w.states[0]), w.pulleys.observed_sheaves,
                                  w.tips.phases.data()};
    model::Account* accounts = cleared_accounts(w, bounds);
    const int begin = layout.link_begin(bounds.first);
    double* slopes = layout.rigid ? w.cut_state + begin : nullptr;
    w.variator.chain().observed_slopes(range, slopes, w.links.loads.data() + bounds.first, accounts,
                                       w.links.observed ? w.links.contacts.data() + bounds.first : nullptr);
    w.variator.chain().book_kinetic(w.states[0] + begin, bounds.size(), accounts);
}

}  // namespace cvtflow::tasks
