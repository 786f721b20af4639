#include "tasks/method/friction/kick_record.hpp"

#include <algorithm>
#include <type_traits>

#include "tasks/step/assembly/segment_tasks.hpp"

namespace cvtflow::tasks {

namespace {

template <class Number>
constexpr bool relative = std::is_same_v<Number, float>;

/// Velocities of a segment's links at the step's start.
void take_velocities(const Workspace& w, const SegmentColumns& columns, int segment, model::Columns& to) noexcept {
    const model::ChainLayout& layout = w.layout();
    const int size = layout.link_size(), shift = columns.shift(segment);
    for (int link = w.partition[segment].first; link < w.partition[segment].last; ++link) {
        const double* v = w.states[0] + layout.link_begin(link) + size;
        for (int row = 0; row < size; ++row) *to.at(row, link + shift) = v[row];
    }
}

}  // namespace

template <class Number>
void record_kick(Workspace& w, const model::FrictionOperator& friction, const model::ContactDrift& drift, const SegmentColumns& columns,
                 int segment, const KickColumns<Number>& to, std::vector<model::LinkLoad>& normal_loads) {
    const Segment& own = w.partition[segment];
    double* window = w.windows[at(segment)].data();
    fill_window(w, own, window);
    const model::ChainRange range{own.first, own.last, window, w.pulleys.sheaves, w.tips.phases.data(), columns.shift(segment), false};
    model::LinkLoad* loads = normal_loads.data() + own.first;
    if constexpr (relative<Number>) {
        const double* start = w.states[0] + w.layout().link_begin(own.first);
        friction.record(range, drift, {start, to.contacts, to.frictionless, to.start}, loads);
    } else {
        friction.record(range, drift, to.contacts, to.frictionless, loads);
        take_velocities(w, columns, segment, to.start);
    }
    for (int row = 0; row < 3 * model::tips_per_link; ++row) std::fill_n(to.impulses.at(row, SegmentColumns::first), own.size(), Number(0));
}

template <class Number>
void react_to_kick(Workspace& w, const SegmentColumns& columns, int segment, const model::ContactFieldOf<Number>& contacts,
                   const model::ColumnsOf<Number>& impulses, const std::vector<model::LinkLoad>& normal_loads) noexcept {
    const Segment& own = w.partition[segment];
    for (int link = own.first; link < own.last; ++link) {
        const int column = link + columns.shift(segment);
        w.links.loads[at(link)] = normal_loads[at(link)];
        model::SheaveLoad& load = w.links.loads[at(link)].load;
        const model::TipArms& p = contacts.arms[at(link)];
        for (int corner = 0; corner < model::tips_per_link; ++corner) {
            if (w.tips.phases[at(model::tips_per_link * link + corner)] == model::Phase::free) continue;
            const double fx = *impulses.at(3 * corner, column), fy = *impulses.at(3 * corner + 1, column),
                         fz = *impulses.at(3 * corner + 2, column);
            load.add(corner % 2, -fx, -fy, -fz, p.x[corner], p.y[corner], p.z[corner]);
        }
    }
    if (w.layout().pulley_size != 0) w.add_up(own);
}

template <class Number>
void end_kick(Workspace& w, const SegmentColumns& columns, int segment, const model::ColumnsOf<Number>& velocities) noexcept {
    const model::ChainLayout& layout = w.layout();
    const Segment& own = w.partition[segment];
    const int size = layout.link_size(), shift = columns.shift(segment);
    const double half = 0.5 * w.step.h;
    // Velocities that others count from: still in the window that record_kick() has filled.
    const double* counted_from = w.windows[at(segment)].data() + layout.halo() * layout.link_block() + size;
    for (int link = own.first; link < own.last; ++link, counted_from += layout.link_block()) {
        const double* __restrict from = w.states[0] + layout.link_begin(link);
        double* __restrict to = w.end_state + layout.link_begin(link);
        for (int row = 0; row < size; ++row) {
            to[size + row] = *velocities.at(row, link + shift);
            if constexpr (relative<Number>) to[size + row] += counted_from[row];
        }
        for (int k = 0; k < size; ++k) to[k] = from[k] + half * (from[size + k] + to[size + k]);
    }
}

std::vector<int> near_segments(const Workspace& w, int segment) {
    const model::ChainLayout& layout = w.layout();
    const Segment& own = w.partition[segment];
    std::vector<int> near{segment};
    for (int s = 0; s < w.partition.size(); ++s) {
        const Segment& other = w.partition[s];
        const auto holds = [&](int link) { return layout.wrapped(link) >= other.first && layout.wrapped(link) < other.last; };
        if (s != segment && (holds(own.first - 1) || holds(own.last))) near.push_back(s);
    }
    return near;
}

#define CVTFLOW_KICKS(Number)                                                                                                     \
    template void record_kick(Workspace&, const model::FrictionOperator&, const model::ContactDrift&, const SegmentColumns&, int, \
                              const KickColumns<Number>&, std::vector<model::LinkLoad>&);                                         \
    template void react_to_kick(Workspace&, const SegmentColumns&, int, const model::ContactFieldOf<Number>&,                     \
                                const model::ColumnsOf<Number>&, const std::vector<model::LinkLoad>&) noexcept;                   \
    template void end_kick(Workspace&, const SegmentColumns&, int, const model::ColumnsOf<Number>&) noexcept;
CVTFLOW_KICKS(double)
CVTFLOW_KICKS(float)
#undef CVTFLOW_KICKS

}  // namespace cvtflow::tasks
