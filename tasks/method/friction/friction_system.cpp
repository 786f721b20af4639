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
    : friction_(w.variator.chain(), w.parameters.detail.stick_slip), field_(w.variator.chain()) {
    const int rows = w.layout().link_size();
    const int columns = w.layout().links + 2 * w.layout().halo();
    for (Columns& slot : states_) slot = Columns(rows, columns);
    for (Columns* field : {&result_, &first_slope_, &base_, &base_before_, &mode_, &image_}) *field = Columns(rows, columns);
    impulses_ = Columns(3 * model::tips_per_link, columns);
    restart();
    normal_loads_.resize(at(w.layout().links));
    repartition(w.partition);
}

template <class Number>
void FrictionSystem<Number>::restart() noexcept {
    const model::ChainLayout& layout = friction_.chain().layout();
    for (int row = 0; row < layout.link_size(); ++row) {  // a mode without symmetry, to begin with
        for (int link = 0; link < layout.links; ++link)
            *mode_.at(row, link + 1) = static_cast<Number>(model::portable_sin(1.0 + 0.7 * row + 2.399 * link));
    }
}

template <class Number>
void FrictionSystem<Number>::repartition(const Partition& partition) {
    const auto size = at(friction_.template scratch_size<Number>(friction_.chain().layout().links));  // borders move without allocation
    while (scratch_.size() < at(partition.size())) scratch_.emplace_back(size, Number(0));
}

template <class Number>
model::FrictionRangeOf<Number> FrictionSystem<Number>::range_of(const Workspace& w, double time, const Columns& velocity,
                                                                int segment) noexcept {
    const Segment& own = w.partition[segment];
    return {own.first, own.last, velocity.at(0, own.first), velocity.stride(), scratch_[at(segment)].data(), w.tips.phases.data(), time};
}

/// Ghost columns next to a segment's own, where it holds the link that they repeat.
template <class Number>
void FrictionSystem<Number>::repeat(const Workspace& w, Columns& field, int segment) noexcept {
    const Segment& own = w.partition[segment];
    const int links = w.layout().links, halo = w.layout().halo();
    for (int row = 0; row < w.layout().link_size(); ++row) {
        for (int link = own.first; link < std::min(halo, own.last); ++link) *field.at(row, link + 1 + links) = *field.at(row, link + 1);
        for (int link = std::max(links - halo, own.first); link < own.last; ++link)
            *field.at(row, link + 1 - links) = *field.at(row, link + 1);
    }
}

template <class Number>
void FrictionSystem<Number>::push(Workspace& w, const model::ContactDrift& drift, int segment) noexcept {
    const Segment& own = w.partition[segment];
    double* window = w.windows[at(segment)].data();
    fill_window(w, own, window);
    const model::ChainRange range{own.first, own.last, window, w.pulleys.sheaves, w.tips.phases.data()};
    model::LinkLoad* loads = normal_loads_.data() + own.first;
    if constexpr (relative) {
        const double* start = w.states[0] + w.layout().link_begin(own.first);
        friction_.record_and_push(range, drift, {start, field_, base_, states_[0]}, loads);
    } else {
        friction_.record_and_push(range, drift, field_, base_, loads);
        take(w, w.states[0], segment);
    }
    repeat(w, states_[0], segment);
    for (int row = 0; row < 3 * model::tips_per_link; ++row) std::fill_n(impulses_.at(row, own.first + 1), own.size(), Number(0));
}

/// Velocities of a state into slot 0.
template <class Number>
void FrictionSystem<Number>::take(const Workspace& w, const double* state, int segment) noexcept {
    const model::ChainLayout& layout = w.layout();
    const int size = layout.link_size();
    for (int link = w.partition[segment].first; link < w.partition[segment].last; ++link) {
        const double* v = state + layout.link_begin(link) + size;
        for (int row = 0; row < size; ++row) *states_[0].at(row, link + 1) = static_cast<Number>(v[row]);
    }
}

template <class Number>
void FrictionSystem<Number>::stage(const Workspace& w, const KickRow& row, double h, double lean, int segment) noexcept {
    const model::FrictionBaseOf<Number> base{&base_, &base_before_, lean};
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
    const Columns& velocity = states_[row.here.keep >= 0 ? at(row.here.keep) : 0];
    friction_.slopes(field_, range_of(w, row.here.time - 0.5, velocity, segment),
                     {&base, row.keeps_slope ? &first_slope_ : nullptr, &next, row.weight, row.weight != 0.0 ? &impulses_ : nullptr});
    repeat(w, *next.to, segment);
}

template <class Number>
void FrictionSystem<Number>::react(Workspace& w, int segment) const noexcept {
    const Segment& own = w.partition[segment];
    for (int link = own.first; link < own.last; ++link) {
        w.links.loads[at(link)] = normal_loads_[at(link)];
        model::SheaveLoad& load = w.links.loads[at(link)].load;
        const model::TipArms& p = field_.arms[at(link)];
        for (int corner = 0; corner < model::tips_per_link; ++corner) {
            if (w.tips.phases[at(model::tips_per_link * link + corner)] == model::Phase::free) continue;
            const double fx = *impulses_.at(3 * corner, link + 1), fy = *impulses_.at(3 * corner + 1, link + 1),
                         fz = *impulses_.at(3 * corner + 2, link + 1);
            load.add(corner % 2, -fx, -fy, -fz, p.x[corner], p.y[corner], p.z[corner]);
        }
    }
}

template <class Number>
void FrictionSystem<Number>::give(const Workspace& w, double* state, int segment) const noexcept {
    const model::ChainLayout& layout = w.layout();
    const Segment& own = w.partition[segment];
    const int size = layout.link_size();
    // Velocities that those of stages count from: still in the window that push() has filled.
    const double* counted_from = w.windows[at(segment)].data() + layout.halo() * layout.link_block() + size;
    for (int link = own.first; link < own.last; ++link, counted_from += layout.link_block()) {
        double* v = state + layout.link_begin(link) + size;
        for (int row = 0; row < size; ++row) {
            v[row] = *result_.at(row, link + 1);
            if constexpr (relative) v[row] += counted_from[row];
        }
    }
}

template <class Number>
double FrictionSystem<Number>::spectral_radius(const Workspace& w, int iterations) noexcept {
    double radius = 0.0;
    for (int k = 0; k < iterations; ++k) {
        double before = 0.0, after = 0.0;
        for (int s = 0; s < w.partition.size(); ++s) repeat(w, mode_, s);
        for (int s = 0; s < w.partition.size(); ++s) {
            friction_.steepest(field_, range_of(w, 0.0, mode_, s), image_);
        }
        for (int row = 0; row < w.layout().link_size(); ++row) {
            for (int column = 1; column <= w.layout().links; ++column) {
                before += square(*mode_.at(row, column));
                after += square(*image_.at(row, column));
            }
        }
        radius = std::sqrt(after / before);
        if (radius == 0.0) return 0.0;
        const double scale = 1.0 / std::sqrt(after);
        for (int row = 0; row < w.layout().link_size(); ++row) {
            for (int column = 1; column <= w.layout().links; ++column)
                *mode_.at(row, column) = static_cast<Number>(scale * *image_.at(row, column));
        }
    }
    return radius;
}

template <class Number>
void FrictionSystem<Number>::save(std::vector<double>& memory) const {
    const model::ChainLayout& at = friction_.chain().layout();
    for (const Columns* field : {&base_, &mode_}) {
        for (int row = 0; row < at.link_size(); ++row) memory.insert(memory.end(), field->at(row, 1), field->at(row, 1) + at.links);
    }
}

template <class Number>
void FrictionSystem<Number>::load(std::span<const double> memory) {
    const model::ChainLayout& at = friction_.chain().layout();
    const auto links = static_cast<std::size_t>(at.links);
    for (Columns* field : {&base_, &mode_}) {
        for (int row = 0; row < at.link_size(); ++row) {
            std::ranges::transform(taken(memory, links), field->at(row, 1), [](double x) { return static_cast<Number>(x); });
        }
    }
}

template class FrictionSystem<double>;
template class FrictionSystem<float>;

}  // namespace cvtflow::tasks
