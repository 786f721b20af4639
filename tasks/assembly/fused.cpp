#include <string>

#include "tasks/assembly/segment_tasks.hpp"
#include "tasks/step_graph.hpp"

namespace cvtflow::tasks {

namespace {

using engine::Access;

/// Accesses of a segment to fields over links: own range, and own range with one neighbour on each side (cyclic).
class LinkAccesses {
public:
    LinkAccesses(const Workspace& w, int segment) : links_(w.layout().links), own_(w.partition[segment]), segment_(segment) {}

    LinkAccesses& own(Field field, bool write) {
        add(field, own_.first, own_.last, write);
        return *this;
    }
    LinkAccesses& with_halo(Field field) {
        own(field, false);
        if (own_.size() == links_) return *this;
        neighbour(field, own_.first == 0 ? links_ - 1 : own_.first - 1);
        neighbour(field, own_.last == links_ ? 0 : own_.last);
        return *this;
    }
    LinkAccesses& segment(Field field, bool write) {
        add(field, segment_, segment_ + 1, write);
        return *this;
    }
    [[nodiscard]] std::vector<Access> list() const { return list_; }

private:
    void neighbour(Field field, int link) { add(field, link, link + 1, false); }
    void add(Field field, int begin, int end, bool write) { list_.push_back({static_cast<int>(field), begin, end, write}); }

    int links_;
    Segment own_;
    int segment_;
    std::vector<Access> list_;
};

}  // namespace

engine::TaskGraph fused_graph(const Workspace& w) {
    engine::TaskGraph graph;
    for (int s = 0; s < w.partition.size(); ++s) {
        const std::string number = "[" + std::to_string(s) + "]";
        // Slots that a stage reads are never the ones it writes: validate(StagePlan) sees to that.
        graph.add({"force" + number, evaluate_cycle, evaluate_segment, s,
                   LinkAccesses(w, s).with_halo(Field::states_read).with_halo(Field::slopes_read).with_halo(Field::end_state).own(Field::slope_written, true)
                       .own(Field::state_kept, true).own(Field::load, true).own(Field::account, true).own(Field::phase, false).segment(Field::window, true).list()});
        graph.add({"detect" + number, detect_cycle, detect_segment, s,
                   LinkAccesses(w, s).own(Field::states_read, false).own(Field::slopes_read, false).own(Field::phase, false).own(Field::before, false)
                       .own(Field::end_state, true).own(Field::after, true).segment(Field::verdict, true).list()});
        graph.add({"locate" + number, locate_cycle, locate_segment, s,
                   LinkAccesses(w, s).own(Field::states_read, false).own(Field::slopes_read, false).own(Field::end_state, false).own(Field::phase, false)
                       .own(Field::before, false).own(Field::after, false).segment(Field::verdict, true).list()});
        graph.add({"truncate" + number, truncate_cycle, truncate_segment, s,
                   LinkAccesses(w, s).own(Field::states_read, false).own(Field::slopes_read, false).own(Field::end_state, false).own(Field::after, true)
                       .own(Field::cut_state, true).own(Field::phase, true).segment(Field::verdict, true).list()});
    }
    graph.freeze();
    return graph;
}

}  // namespace cvtflow::tasks
