#pragma once
/// Declared accesses of tasks to fields over links: what the race check reads.

#include <algorithm>
#include <vector>

#include "tasks/step/step_graph.hpp"

namespace cvtflow::tasks {

/// Accesses of a segment to fields over links: own range, and own range with the layout's halo on each side (cyclic).
class LinkAccesses {
public:
    LinkAccesses(const Workspace& w, int segment) : layout_(w.layout()), own_(w.partition[segment]), segment_(segment) {}

    LinkAccesses& own(Field field, bool write) {
        add(field, own_.first, own_.last, write);
        return *this;
    }
    LinkAccesses& with_halo(Field field) { return with_halo(field, layout_.halo()); }
    /// With as many neighbours as contact of its tips depends on.
    LinkAccesses& with_near(Field field) { return with_halo(field, layout_.probe_halo()); }
    /// Pins strictly inside the segment, numbered as the link behind them.
    LinkAccesses& inner_pins(Field field, bool write) {
        if (own_.size() > 1) add(field, own_.first + 1, own_.last, write);
        return *this;
    }
    /// The pin between this segment and the one before.
    LinkAccesses& first_pin(Field field, bool write) {
        add(field, own_.first, own_.first + 1, write);
        return *this;
    }
    LinkAccesses& segment(Field field, bool write) {
        add(field, segment_, segment_ + 1, write);
        return *this;
    }
    [[nodiscard]] std::vector<engine::Access> list() const { return list_; }

private:
    LinkAccesses& with_halo(Field field, int halo) {
        own(field, false);
        for (int k = 0; k < std::min(halo, layout_.links - own_.size()); ++k) {
            neighbour(field, layout_.wrapped(own_.first - 1 - k));
            neighbour(field, layout_.wrapped(own_.last + k));
        }
        return *this;
    }
    void neighbour(Field field, int link) { add(field, link, link + 1, false); }
    void add(Field field, int begin, int end, bool write) { list_.push_back({static_cast<int>(field), begin, end, write}); }

    const model::ChainLayout& layout_;
    Segment own_;
    int segment_;
    std::vector<engine::Access> list_;
};

[[nodiscard]] inline std::vector<engine::Access> detect_accesses(const Workspace& w, int s) {
    return LinkAccesses(w, s)
        .with_near(Field::states_read)
        .with_near(Field::slopes_read)
        .own(Field::secant, true)
        .own(Field::phase, false)
        .own(Field::before, false)
        .own(Field::end_state, true)
        .own(Field::after, true)
        .own(Field::link_error, true)
        .segment(Field::window, true)
        .segment(Field::verdict, true)
        .list();
}
[[nodiscard]] inline std::vector<engine::Access> locate_accesses(const Workspace& w, int s) {
    return LinkAccesses(w, s)
        .with_near(Field::states_read)
        .with_near(Field::slopes_read)
        .with_near(Field::end_state)
        .own(Field::phase, false)
        .own(Field::before, false)
        .own(Field::after, false)
        .segment(Field::window, true)
        .segment(Field::verdict, true)
        .list();
}
[[nodiscard]] inline std::vector<engine::Access> truncate_accesses(const Workspace& w, int s) {
    return LinkAccesses(w, s)
        .with_near(Field::states_read)
        .with_near(Field::slopes_read)
        .with_near(Field::end_state)
        .own(Field::after, true)
        .own(Field::cut_state, true)
        .own(Field::phase, true)
        .segment(Field::window, true)
        .segment(Field::verdict, true)
        .list();
}

[[nodiscard]] inline std::vector<engine::Access> observe_accesses(const Workspace& w, int s) {
    return LinkAccesses(w, s)
        .with_halo(Field::states_read)
        .own(Field::phase, false)
        .own(Field::load, true)
        .own(Field::account, true)
        .own(Field::cut_state, true)
        .segment(Field::window, true)
        .list();
}

/// Observation of one segment at the step's start: the same in every assembly.
void add_observe_task(engine::TaskGraph& graph, const Workspace& workspace, int segment);
/// What profiles call the three cycles about transitions.
inline constexpr const char* transition_stage = "transition";

/// Detection, location and truncation of one segment: the same in every assembly.
void add_transition_tasks(engine::TaskGraph& graph, const Workspace& workspace, int segment);

}  // namespace cvtflow::tasks
