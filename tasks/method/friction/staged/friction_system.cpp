#include "tasks/method/friction/staged/friction_system.hpp"

#include <algorithm>
#include <cmath>

#include "model/basis/portable_math.hpp"
#include "tasks/method/friction/kick_record.hpp"
#include "tasks/step/step_method.hpp"

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
FrictionSystem<Number>::FrictionSystem(const Workspace& w) : friction_(w.variator.chain(), w.parameters.detail.stick_slip) {
    const int rows = w.layout().link_size();
    const model::ContactComponents components = model::ContactFieldOf<Number>(w.variator.chain()).components;
    for (SegmentEdges<Number>& edges : edges_) edges = SegmentEdges<Number>(rows);
    mode_edges_ = SegmentEdges<Number>(rows);
    contact_edges_ = SegmentEdges<Number>(components.count());
    moving_.resize(kept_fields * at(rows * w.layout().links));
    normal_loads_.resize(at(w.layout().links));
    columns_.lay_out(w.partition);
    make_room();
    restart();
}

template <class Number>
std::size_t FrictionSystem<Number>::bytes() const noexcept {
    std::size_t bytes = sizeof(*this) + normal_loads_.size() * sizeof(model::LinkLoad) + contact_edges_.bytes() + mode_edges_.bytes();
    for (const SegmentEdges<Number>& each : edges_) bytes += each.bytes();
    for (const Fields& f : fields_) {
        bytes += f.contacts.bytes() + f.scratch.size() * sizeof(Number);
        for (const Columns& each : f.states) bytes += each.bytes();
        for (const Columns* each : {&f.base[0], &f.base[1], &f.result, &f.first_slope, &f.impulses, &f.mode, &f.image})
            bytes += each->bytes();
    }
    return bytes;
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
    Fields& f = fields(segment);
    record_kick<Number>(w, friction_, drift, columns_, segment, {f.contacts, f.base[now_], f.states[0], f.impulses}, normal_loads_);
    edges_[0].give(columns_, f.states[0], segment);
    contact_edges_.give(columns_, f.contacts.columns, segment);
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
void FrictionSystem<Number>::finish(Workspace& w, int segment) const noexcept {
    const Fields& f = fields(segment);
    react_to_kick(w, columns_, segment, f.contacts, f.impulses, normal_loads_);
    end_kick(w, columns_, segment, f.result);
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
            friction_.all_sticking(f.contacts, range_of(w, 0.0, f.mode, s), f.image);
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
            const std::span<const double> numbers = pop_front(memory, at(friction_.chain().layout().links));
            for_links(*this,
                      [&](Fields& f, int link, int column) { *kept(f)[k]->at(row, column) = static_cast<Number>(numbers[at(link)]); });
        }
    }
}

template class FrictionSystem<double>;
template class FrictionSystem<float>;

}  // namespace cvtflow::tasks
