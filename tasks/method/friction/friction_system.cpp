#include "tasks/method/friction/friction_system.hpp"

#include <algorithm>
#include <cmath>

#include "model/basis/portable_math.hpp"
#include "tasks/method/friction/index.hpp"
#include "tasks/step/assembly/segment_tasks.hpp"
#include "tasks/step/method_memory.hpp"

namespace cvtflow::tasks {

FrictionSystem::FrictionSystem(const Workspace& w)
    : friction_(w.variator.chain(), w.parameters.detail.stick_slip), field_(w.variator.chain()) {
    const int rows = w.layout().link_size();
    const int columns = w.layout().links + 2 * w.layout().halo();
    for (model::Columns& slot : states_) slot = model::Columns(rows, columns);
    for (model::Columns* field : {&result_, &first_slope_, &base_, &base_before_, &mode_, &image_}) *field = model::Columns(rows, columns);
    impulses_ = model::Columns(3 * model::tips_per_link, columns);
    restart();
    normal_loads_.resize(at(w.layout().links));
    repartition(w.partition);
}

void FrictionSystem::restart() noexcept {
    const model::ChainLayout& layout = friction_.chain().layout();
    for (int row = 0; row < layout.link_size(); ++row) {  // a mode without symmetry, to begin with
        for (int link = 0; link < layout.links; ++link) *mode_.at(row, link + 1) = model::portable_sin(1.0 + 0.7 * row + 2.399 * link);
    }
}

void FrictionSystem::repartition(const Partition& partition) {
    const auto size = at(friction_.scratch_size(friction_.chain().layout().links));  // borders move without allocation
    while (scratch_.size() < at(partition.size())) scratch_.emplace_back(size, 0.0);
}

model::FrictionRange FrictionSystem::range_of(const Workspace& w, double time, const model::Columns& velocity, int segment) noexcept {
    const Segment& own = w.partition[segment];
    return {own.first, own.last, velocity.at(0, own.first), velocity.stride(), scratch_[at(segment)].data(), w.tips.phases.data(), time};
}

/// Ghost columns next to a segment's own, where it holds the link that they repeat.
void FrictionSystem::repeat(const Workspace& w, model::Columns& field, int segment) noexcept {
    const Segment& own = w.partition[segment];
    const int links = w.layout().links, halo = w.layout().halo();
    for (int row = 0; row < w.layout().link_size(); ++row) {
        for (int link = own.first; link < std::min(halo, own.last); ++link) *field.at(row, link + 1 + links) = *field.at(row, link + 1);
        for (int link = std::max(links - halo, own.first); link < own.last; ++link)
            *field.at(row, link + 1 - links) = *field.at(row, link + 1);
    }
}

void FrictionSystem::push(Workspace& w, const model::ContactDrift& drift, int segment) noexcept {
    const Segment& own = w.partition[segment];
    double* window = w.windows[at(segment)].data();
    fill_window(w, own, window);
    friction_.record_and_push({own.first, own.last, window, w.pulleys.sheaves, w.tips.phases.data()}, drift, field_, base_,
                              normal_loads_.data() + own.first);
}

void FrictionSystem::begin_from(const Workspace& w, const double* state, int segment) noexcept {
    const model::ChainLayout& layout = w.layout();
    const int size = layout.link_size();
    for (int link = w.partition[segment].first; link < w.partition[segment].last; ++link) {
        const double* v = state + layout.link_begin(link) + size;
        for (int row = 0; row < size; ++row) *states_[0].at(row, link + 1) = v[row];
    }
    repeat(w, states_[0], segment);
    const Segment& own = w.partition[segment];
    for (int row = 0; row < 3 * model::tips_per_link; ++row) std::fill_n(impulses_.at(row, own.first + 1), own.size(), 0.0);
}

void FrictionSystem::stage(const Workspace& w, const KickRow& row, double h, double lean, int segment) noexcept {
    const model::FrictionBase base{&base_, &base_before_, lean};
    model::VelocityRow next;
    for (const engine::Term& term : row.next.states) next.add(states_[at(term.slot)], term.factor);
    for (const engine::Term& term : row.next.slopes) {
        if (term.slot == row.here.slope) {
            next.slope_weight = h * term.factor;
        } else {
            next.add(first_slope_, h * term.factor);
        }
    }
    next.to = row.next.keep >= 0 ? &states_[at(row.next.keep)] : &result_;
    const model::Columns& velocity = states_[row.here.keep >= 0 ? at(row.here.keep) : 0];
    friction_.slopes(field_, range_of(w, row.here.time - 0.5, velocity, segment),
                     {&base, row.keeps_slope ? &first_slope_ : nullptr, &next, row.weight, row.weight != 0.0 ? &impulses_ : nullptr});
    repeat(w, *next.to, segment);
}

void FrictionSystem::react(Workspace& w, int segment) const noexcept {
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

double FrictionSystem::spectral_radius(const Workspace& w, int iterations) noexcept {
    double radius = 0.0;
    for (int k = 0; k < iterations; ++k) {
        double before = 0.0, after = 0.0;
        for (int s = 0; s < w.partition.size(); ++s) repeat(w, mode_, s);
        for (int s = 0; s < w.partition.size(); ++s) {
            friction_.steepest(field_, range_of(w, 0.0, mode_, s), image_);
        }
        for (int row = 0; row < w.layout().link_size(); ++row) {
            for (int column = 1; column <= w.layout().links; ++column) {
                before += *mode_.at(row, column) * *mode_.at(row, column);
                after += *image_.at(row, column) * *image_.at(row, column);
            }
        }
        radius = std::sqrt(after / before);
        if (radius == 0.0) return 0.0;
        const double scale = 1.0 / std::sqrt(after);
        for (int row = 0; row < w.layout().link_size(); ++row) {
            for (int column = 1; column <= w.layout().links; ++column) *mode_.at(row, column) = scale * *image_.at(row, column);
        }
    }
    return radius;
}

void FrictionSystem::save(std::vector<double>& memory) const {
    const model::ChainLayout& at = friction_.chain().layout();
    for (const model::Columns* field : {&base_, &mode_}) {
        for (int row = 0; row < at.link_size(); ++row) memory.insert(memory.end(), field->at(row, 1), field->at(row, 1) + at.links);
    }
}

void FrictionSystem::load(std::span<const double> memory) {
    const model::ChainLayout& at = friction_.chain().layout();
    const auto links = static_cast<std::size_t>(at.links);
    for (model::Columns* field : {&base_, &mode_}) {
        for (int row = 0; row < at.link_size(); ++row) {
            std::ranges::copy(taken(memory, links), field->at(row, 1));
        }
    }
}

}  // namespace cvtflow::tasks
