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
FrictionSystem<Number>::Fields::Fields(const model::FrictionOperator& friction, int columns) : width(columns), contacts(friction.chain()) {
    const model::ChainLayout& layout = friction.chain().layout();
    contacts.make_columns(width);
    for (Columns& slot : states) slot = Columns(layout.link_size(), width);
    for (Columns& each : base) each = Columns(layout.link_size(), width);
    for (Columns* field : {&result, &first_slope, &mode, &image}) *field = Columns(layout.link_size(), width);
    impulses = Columns(3 * model::tips_per_link, width);
    scratch.resize(at(friction.template scratch_size<Number>(width)), Number(0));
}

template <class Number>
FrictionSystem<Number>::FrictionSystem(const Workspace& w)
    : friction_(w.variator.chain(), w.parameters.detail.stick_slip), columns_(w.layout().halo()) {
    const int rows = w.layout().link_size(), halo = w.layout().halo();
    const model::ContactComponents components = model::ContactFieldOf<Number>(w.variator.chain()).components;
    for (SegmentEdges<Number>& edges : edges_) edges = SegmentEdges<Number>(rows, halo);
    mode_edges_ = SegmentEdges<Number>(rows, halo);
    contact_edges_ = SegmentEdges<Number>(components.count(), halo);
    moving_.resize(kept_fields * at(rows * w.layout().links));
    normal_loads_.resize(at(w.layout().links));
    columns_.lay_out(w.partition);
    make_room();
    restart();
}

template <class Number>
void FrictionSystem<Number>::restart() noexcept {
    for (int row = 0; row < friction_.chain().layout().link_size(); ++row) {  // a mode without symmetry, to begin with
        for_links(*this, [&](Fields& fields, int link, int column) {
            *fields.mode.at(row, column) = static_cast<Number>(model::portable_sin(1.0 + 0.7 * row + 2.399 * link));
        });
    }
}

/// Fields and edges for all segments. Those of whole lines serve when borders move a little.
template <class Number>
void FrictionSystem<Number>::make_room() {
    constexpr int line = Columns::line;
    const int segments = columns_.segments();
    for (int s = 0; s < segments; ++s) {
        const int width = (columns_.count(s) + line - 1) / line * line;
        if (at(s) == fields_.size()) {
            fields_.emplace_back(friction_, width);
        } else if (fields(s).width < width) {
            fields(s) = Fields(friction_, width);
        }
    }
    for (SegmentEdges<Number>& edges : edges_) edges.make_room(segments);
    mode_edges_.make_room(segments);
    contact_edges_.make_room(segments);
}

template <class Number>
void FrictionSystem<Number>::repartition(const Partition& partition) {
    const auto each = [&](const auto& visit) {
        Number* number = moving_.data();
        for (std::size_t k = 0; k < kept_fields; ++k) {
            for (int row = 0; row < friction_.chain().layout().link_size(); ++row)
                for_links(*this, [&](Fields& fields, int, int column) { visit(*number++, *kept(fields)[k]->at(row, column)); });
        }
    };
    each([](Number& room, const Number& own) { room = own; });
    columns_.lay_out(partition);
    make_room();
    each([](const Number& room, Number& own) { own = room; });
}

template <class Number>
model::FrictionRangeOf<Number> FrictionSystem<Number>::range_of(const Workspace& w, double time, const Columns& velocity,
                                                                int segment) noexcept {
    const Segment& own = w.partition[segment];
    return {own.first,
            own.last,
            velocity.at(0, SegmentColumns::first - 1),
            velocity.stride(),
            fields(segment).scratch.data(),
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
    Fields& f = fields(segment);
    if constexpr (relative) {
        const double* start = w.states[0] + w.layout().link_begin(own.first);
        friction_.record(range, drift, {start, f.contacts, f.base[now_], f.states[0]}, loads);
    } else {
        friction_.record(range, drift, f.contacts, f.base[now_], loads);
        take(w, w.states[0], segment);
    }
    edges_[0].give(columns_, f.states[0], segment);
    contact_edges_.give(columns_, f.contacts.columns, segment);
    for (int row = 0; row < 3 * model::tips_per_link; ++row) std::fill_n(f.impulses.at(row, SegmentColumns::first), own.size(), Number(0));
}

/// Velocities of a state into slot 0.
template <class Number>
void FrictionSystem<Number>::take(const Workspace& w, const double* state, int segment) noexcept {
    const model::ChainLayout& layout = w.layout();
    const int size = layout.link_size(), shift = columns_.shift(segment);
    Columns& start = fields(segment).states[0];
    for (int link = w.partition[segment].first; link < w.partition[segment].last; ++link) {
        const double* v = state + layout.link_begin(link) + size;
        for (int row = 0; row < size; ++row) *start.at(row, link + shift) = static_cast<Number>(v[row]);
    }
}

template <class Number>
void FrictionSystem<Number>::stage(const Workspace& w, const KickRow& row, double h, double extrapolation, int segment) noexcept {
    Fields& f = fields(segment);
    const model::FrictionBaseOf<Number> base{&f.base[now_], &f.base[1 - now_], extrapolation};
    model::VelocityRowOf<Number> next;
    for (const engine::Term& term : row.next.states) next.add(f.states[at(term.slot)], term.factor);
    for (const engine::Term& term : row.next.slopes) {
        if (term.slot == row.here.slope) {
            next.slope_weight = h * term.factor;
        } else {
            next.add(f.first_slope, h * term.factor);
        }
    }
    next.to = row.next.keep >= 0 ? &f.states[at(row.next.keep)] : &f.result;
    const bool first = row.here.keep < 0;
    const std::size_t here = first ? 0 : at(row.here.keep);
    edges_[here].take(columns_, f.states[here], segment);
    if (first) contact_edges_.take(columns_, f.contacts.columns, segment);
    friction_.slopes(f.contacts, range_of(w, row.here.time - 0.5, f.states[here], segment),
                     {&base, row.keeps_slope ? &f.first_slope : nullptr, &next, row.weight, row.weight != 0.0 ? &f.impulses : nullptr});
    if (row.next.keep >= 0) edges_[at(row.next.keep)].give(columns_, *next.to, segment);
}

template <class Number>
void FrictionSystem<Number>::react(Workspace& w, int segment) const noexcept {
    const Segment& own = w.partition[segment];
    const Fields& f = fields(segment);
    for (int link = own.first; link < own.last; ++link) {
        const int column = link + columns_.shift(segment);
        w.links.loads[at(link)] = normal_loads_[at(link)];
        model::SheaveLoad& load = w.links.loads[at(link)].load;
        const model::TipArms& p = f.contacts.arms[at(link)];
        for (int corner = 0; corner < model::tips_per_link; ++corner) {
            if (w.tips.phases[at(model::tips_per_link * link + corner)] == model::Phase::free) continue;
            const double fx = *f.impulses.at(3 * corner, column), fy = *f.impulses.at(3 * corner + 1, column),
                         fz = *f.impulses.at(3 * corner + 2, column);
            load.add(corner % 2, -fx, -fy, -fz, p.x[corner], p.y[corner], p.z[corner]);
        }
    }
}

template <class Number>
void FrictionSystem<Number>::give(const Workspace& w, double* state, int segment) const noexcept {
    const model::ChainLayout& layout = w.layout();
    const Segment& own = w.partition[segment];
    const int size = layout.link_size();
    const Columns& result = fields(segment).result;
    // Velocities that those of stages count from: still in the window that record() has filled.
    const double* counted_from = w.windows[at(segment)].data() + layout.halo() * layout.link_block() + size;
    for (int link = own.first; link < own.last; ++link, counted_from += layout.link_block()) {
        double* v = state + layout.link_begin(link) + size;
        for (int row = 0; row < size; ++row) {
            v[row] = *result.at(row, link + columns_.shift(segment));
            if constexpr (relative) v[row] += counted_from[row];
        }
    }
}

template <class Number>
double FrictionSystem<Number>::spectral_radius(const Workspace& w, int iterations) noexcept {
    const int rows = w.layout().link_size(), segments = columns_.segments();
    for (int s = 0; s < segments; ++s) contact_edges_.take(columns_, fields(s).contacts.columns, s);
    double radius = 0.0;
    for (int k = 0; k < iterations; ++k) {
        double before = 0.0, after = 0.0;
        for (int s = 0; s < segments; ++s) mode_edges_.give(columns_, fields(s).mode, s);
        for (int s = 0; s < segments; ++s) {
            Fields& f = fields(s);
            mode_edges_.take(columns_, f.mode, s);
            friction_.steepest(f.contacts, range_of(w, 0.0, f.mode, s), f.image);
        }
        for (int row = 0; row < rows; ++row) {
            for_links(*this, [&](const Fields& f, int, int column) {
                before += square(*f.mode.at(row, column));
                after += square(*f.image.at(row, column));
            });
        }
        radius = std::sqrt(after / before);
        if (radius == 0.0) return 0.0;
        const double scale = 1.0 / std::sqrt(after);
        for (int row = 0; row < rows; ++row)
            for_links(*this,
                      [&](Fields& f, int, int column) { *f.mode.at(row, column) = static_cast<Number>(scale * *f.image.at(row, column)); });
    }
    return radius;
}

template <class Number>
void FrictionSystem<Number>::save(std::vector<double>& memory) const {
    for (std::size_t k = 0; k < saved_fields; ++k) {
        for (int row = 0; row < friction_.chain().layout().link_size(); ++row)
            for_links(*this, [&](const Fields& f, int, int column) { memory.push_back(*kept(f)[k]->at(row, column)); });
    }
}

template <class Number>
void FrictionSystem<Number>::load(std::span<const double> memory) {
    for (std::size_t k = 0; k < saved_fields; ++k) {
        for (int row = 0; row < friction_.chain().layout().link_size(); ++row) {
            const std::span<const double> numbers = taken(memory, at(friction_.chain().layout().links));
            for_links(*this,
                      [&](Fields& f, int link, int column) { *kept(f)[k]->at(row, column) = static_cast<Number>(numbers[at(link)]); });
        }
    }
}

template class FrictionSystem<double>;
template class FrictionSystem<float>;

}  // namespace cvtflow::tasks
