#include "tasks/method/friction/friction_system.hpp"

#include <algorithm>
#include <cmath>

#include "model/basis/portable_math.hpp"
#include "tasks/method/friction/index.hpp"
#include "tasks/step/assembly/segment_tasks.hpp"
#include "tasks/step/method_memory.hpp"

namespace cvtflow::tasks {

namespace {

[[nodiscard]] double square(double x) noexcept { return x * x; }

}  // namespace

template <class Number>
FrictionSystem<Number>::FrictionSystem(const Workspace& w)
    : friction_(w.variator.chain(), w.parameters.detail.stick_slip),
      field_(w.variator.chain()),
      columns_(w.layout().halo(), Columns::line),
      columns_before_(columns_) {
    const int rows = w.layout().link_size(), halo = w.layout().halo();
    for (SegmentEdges<Number>& edges : edges_) edges = SegmentEdges<Number>(rows, halo);
    mode_edges_ = SegmentEdges<Number>(rows, halo);
    contact_edges_ = SegmentEdges<Number>(field_.components.count(), halo);
    normal_loads_.resize(at(w.layout().links));
    row_.resize(at(w.layout().links));
    columns_.lay_out(w.partition);
    repartition(w.partition);
    restart();
}

/// Columns of all fields whose numbers do not outlast a step.
template <class Number>
void FrictionSystem<Number>::make_columns() {
    const int rows = friction_.chain().layout().link_size();
    for (Columns& slot : states_) slot = Columns(rows, width_);
    for (Columns* field : {&result_, &first_slope_, &image_}) *field = Columns(rows, width_);
    impulses_ = Columns(3 * model::tips_per_link, width_);
    field_.make_columns(width_);
}

/// A field that outlasts a step to where its links lie now.
template <class Number>
void FrictionSystem<Number>::move(Columns& field, bool grows) {
    const int rows = friction_.chain().layout().link_size();
    Columns wider;
    if (grows) wider = Columns(rows, width_);  // of the shape of all others
    Columns& to = grows ? wider : field;
    for (int row = 0; row < rows && field.stride() != 0; ++row) {
        for_links(columns_before_, [&](int link, int column) { row_[at(link)] = *field.at(row, column); });
        for_links(columns_, [&](int link, int column) { *to.at(row, column) = row_[at(link)]; });
    }
    if (grows) field = std::move(wider);
}

template <class Number>
void FrictionSystem<Number>::restart() noexcept {
    for (int row = 0; row < friction_.chain().layout().link_size(); ++row) {  // a mode without symmetry, to begin with
        for_links(columns_, [&](int link, int column) {
            *mode_.at(row, column) = static_cast<Number>(model::portable_sin(1.0 + 0.7 * row + 2.399 * link));
        });
    }
}

template <class Number>
void FrictionSystem<Number>::repartition(const Partition& partition) {
    std::swap(columns_, columns_before_);
    columns_.lay_out(partition);
    const bool grows = columns_.count() > width_;
    if (grows) width_ = columns_.count();
    for (Columns* field : {&base_, &base_before_, &mode_}) move(*field, grows);
    if (grows) make_columns();
    for (SegmentEdges<Number>& edges : edges_) edges.make_room(partition.size());
    mode_edges_.make_room(partition.size());
    contact_edges_.make_room(partition.size());
    const auto size = at(friction_.template scratch_size<Number>(friction_.chain().layout().links));  // borders move without allocation
    while (scratch_.size() < at(partition.size())) scratch_.emplace_back(size, Number(0));
}

template <class Number>
model::FrictionRangeOf<Number> FrictionSystem<Number>::range_of(const Workspace& w, double time, const Columns& velocity,
                                                                int segment) noexcept {
    const Segment& own = w.partition[segment];
    return {own.first,
            own.last,
            velocity.at(0, columns_.first(segment) - 1),
            velocity.stride(),
            scratch_[at(segment)].data(),
            w.tips.phases.data(),
            time,
            columns_.shift(segment)};
}

template <class Number>
void FrictionSystem<Number>::record(Workspace& w, const model::ContactDrift& drift, int segment) noexcept {
    const Segment& own = w.partition[segment];
    double* window = w.windows[at(segment)].data();
    fill_window(w, own, window);
    const model::ChainRange range{own.first, own.last, window, w.pulleys.sheaves, w.tips.phases.data(), columns_.shift(segment), false};
    model::LinkLoad* loads = normal_loads_.data() + own.first;
    if constexpr (relative) {
        const double* start = w.states[0] + w.layout().link_begin(own.first);
        friction_.record(range, drift, {start, field_, base_, states_[0]}, loads);
    } else {
        friction_.record(range, drift, field_, base_, loads);
        take(w, w.states[0], segment);
    }
    edges_[0].give(columns_, states_[0], segment);
    contact_edges_.give(columns_, field_.columns, segment);
    for (int row = 0; row < 3 * model::tips_per_link; ++row) std::fill_n(impulses_.at(row, columns_.first(segment)), own.size(), Number(0));
}

/// Velocities of a state into slot 0.
template <class Number>
void FrictionSystem<Number>::take(const Workspace& w, const double* state, int segment) noexcept {
    const model::ChainLayout& layout = w.layout();
    const int size = layout.link_size(), shift = columns_.shift(segment);
    for (int link = w.partition[segment].first; link < w.partition[segment].last; ++link) {
        const double* v = state + layout.link_begin(link) + size;
        for (int row = 0; row < size; ++row) *states_[0].at(row, link + shift) = static_cast<Number>(v[row]);
    }
}

template <class Number>
void FrictionSystem<Number>::stage(const Workspace& w, const KickRow& row, double h, double extrapolation, int segment) noexcept {
    const model::FrictionBaseOf<Number> base{&base_, &base_before_, extrapolation};
    model::VelocityRowOf<Number> next;
    for (const engine::Term& term : row.next.states) next.add(states_[at(term.slot)], term.factor);
    for (const engine::Term& term : row.next.slopes) {
        if (term.slot == row.here.slope) {
            next.slope_weight = h * term.factor;
        } else {
            next.add(first_slope_, h * term.factor);
        }
    }
    next.to = row.next.keep >= 0 ? &states_[at(row.next.keep)] : &result_;
    const bool first = row.here.keep < 0;
    const std::size_t here = first ? 0 : at(row.here.keep);
    edges_[here].take(columns_, states_[here], segment);
    if (first) contact_edges_.take(columns_, field_.columns, segment);
    friction_.slopes(field_, range_of(w, row.here.time - 0.5, states_[here], segment),
                     {&base, row.keeps_slope ? &first_slope_ : nullptr, &next, row.weight, row.weight != 0.0 ? &impulses_ : nullptr});
    if (row.next.keep >= 0) edges_[at(row.next.keep)].give(columns_, *next.to, segment);
}

template <class Number>
void FrictionSystem<Number>::react(Workspace& w, int segment) const noexcept {
    const Segment& own = w.partition[segment];
    for (int link = own.first; link < own.last; ++link) {
        const int column = link + columns_.shift(segment);
        w.links.loads[at(link)] = normal_loads_[at(link)];
        model::SheaveLoad& load = w.links.loads[at(link)].load;
        const model::TipArms& p = field_.arms[at(link)];
        for (int corner = 0; corner < model::tips_per_link; ++corner) {
            if (w.tips.phases[at(model::tips_per_link * link + corner)] == model::Phase::free) continue;
            const double fx = *impulses_.at(3 * corner, column), fy = *impulses_.at(3 * corner + 1, column),
                         fz = *impulses_.at(3 * corner + 2, column);
            load.add(corner % 2, -fx, -fy, -fz, p.x[corner], p.y[corner], p.z[corner]);
        }
    }
}

template <class Number>
void FrictionSystem<Number>::give(const Workspace& w, double* state, int segment) const noexcept {
    const model::ChainLayout& layout = w.layout();
    const Segment& own = w.partition[segment];
    const int size = layout.link_size();
    // Velocities that those of stages count from: still in the window that record() has filled.
    const double* counted_from = w.windows[at(segment)].data() + layout.halo() * layout.link_block() + size;
    for (int link = own.first; link < own.last; ++link, counted_from += layout.link_block()) {
        double* v = state + layout.link_begin(link) + size;
        for (int row = 0; row < size; ++row) {
            v[row] = *result_.at(row, link + columns_.shift(segment));
            if constexpr (relative) v[row] += counted_from[row];
        }
    }
}

template <class Number>
double FrictionSystem<Number>::spectral_radius(const Workspace& w, int iterations) noexcept {
    const int rows = w.layout().link_size(), segments = columns_.segments();
    for (int s = 0; s < segments; ++s) contact_edges_.take(columns_, field_.columns, s);
    double radius = 0.0;
    for (int k = 0; k < iterations; ++k) {
        double before = 0.0, after = 0.0;
        for (int s = 0; s < segments; ++s) mode_edges_.give(columns_, mode_, s);
        for (int s = 0; s < segments; ++s) {
            mode_edges_.take(columns_, mode_, s);
            friction_.steepest(field_, range_of(w, 0.0, mode_, s), image_);
        }
        for (int row = 0; row < rows; ++row) {
            for_links(columns_, [&](int, int column) {
                before += square(*mode_.at(row, column));
                after += square(*image_.at(row, column));
            });
        }
        radius = std::sqrt(after / before);
        if (radius == 0.0) return 0.0;
        const double scale = 1.0 / std::sqrt(after);
        for (int row = 0; row < rows; ++row) {
            for_links(columns_, [&](int, int column) { *mode_.at(row, column) = static_cast<Number>(scale * *image_.at(row, column)); });
        }
    }
    return radius;
}

template <class Number>
void FrictionSystem<Number>::save(std::vector<double>& memory) const {
    for (const Columns* field : {&base_, &mode_}) {
        for (int row = 0; row < friction_.chain().layout().link_size(); ++row)
            for_links(columns_, [&](int, int column) { memory.push_back(*field->at(row, column)); });
    }
}

template <class Number>
void FrictionSystem<Number>::load(std::span<const double> memory) {
    for (Columns* field : {&base_, &mode_}) {
        for (int row = 0; row < friction_.chain().layout().link_size(); ++row) {
            const std::span<const double> numbers = taken(memory, row_.size());
            for_links(columns_, [&](int link, int column) { *field->at(row, column) = static_cast<Number>(numbers[at(link)]); });
        }
    }
}

template class FrictionSystem<double>;
template class FrictionSystem<float>;

}  // namespace cvtflow::tasks
