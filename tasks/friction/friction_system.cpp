#include "tasks/friction/friction_system.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "tasks/assembly/segment_tasks.hpp"
#include "tasks/friction/index.hpp"

namespace cvtflow::tasks {

namespace {

}  // namespace

FrictionSystem::FrictionSystem(const Workspace& w, int states, int slopes)
    : friction_(w.variator.chain(), w.parameters.detail.stick_slip), field_(w.variator.chain()) {
    const int rows = w.layout().link_size();
    const int columns = w.layout().links + 2;
    for (int slot = 0; slot < states; ++slot) states_.emplace_back(rows, columns);
    for (int slot = 0; slot < slopes; ++slot) slopes_.emplace_back(rows, columns);
    for (const model::Columns& slot : states_) state_views_.push_back(slot.data());
    for (const model::Columns& slot : slopes_) slope_views_.push_back(slot.data());
    for (model::Columns* field : {&base_, &base_before_, &mode_, &image_}) *field = model::Columns(rows, columns);
    impulses_ = model::Columns(3 * model::tips_per_link, columns);
    restart();
    normal_loads_.resize(at(w.layout().links));
    repartition(w.partition);
}

void FrictionSystem::restart() noexcept {
    const model::ChainLayout& layout = friction_.chain().layout();
    for (int row = 0; row < layout.link_size(); ++row) {   // a mode without symmetry, to begin with
        for (int link = 0; link < layout.links; ++link) *mode_.at(row, link + 1) = std::sin(1.0 + 0.7 * row + 2.399 * link);
    }
}

void FrictionSystem::repartition(const Partition& partition) {
    const int links = friction_.chain().layout().links;
    while (segments_.size() < at(partition.size())) {   // each for as many links as a segment can have: borders move without allocation
        segments_.push_back({model::Columns(friction_.chain().layout().link_size(), links + 2), std::vector<double>(at(friction_.scratch_size(links)), 0.0)});
    }
}

model::FrictionRange FrictionSystem::range_of(const Workspace& w, double time, const model::Columns& velocity, int segment) noexcept {
    const Segment& own = w.partition[segment];
    double* scratch = segments_[at(segment)].scratch.data();
    while (reinterpret_cast<std::uintptr_t>(scratch) % 64 != 0) ++scratch;   // on a cache line: scratch_size() leaves room
    return {own.first, own.last, velocity.at(0, own.first), velocity.stride(), scratch, w.phases.data(), time};
}

/// Ghost columns next to a segment's own, where it holds the link that they repeat.
void FrictionSystem::repeat(const Workspace& w, model::Columns& field, int segment) noexcept {
    const Segment& own = w.partition[segment];
    const int links = w.layout().links;
    for (int row = 0; row < w.layout().link_size(); ++row) {
        if (own.first == 0) *field.at(row, links + 1) = *field.at(row, 1);
        if (own.last == links) *field.at(row, 0) = *field.at(row, links);
    }
}

void FrictionSystem::push(Workspace& w, const model::ContactDrift& drift, int segment) noexcept {
    const Segment& own = w.partition[segment];
    double* window = w.windows[at(segment)].data();
    fill_window(w, own, window);
    friction_.record_and_push({own.first, own.last, window, w.sheaves, w.phases.data()}, drift, field_, base_, normal_loads_.data() + own.first);
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

/// A row's velocities of a segment's links and their neighbours: where they are.
const model::Columns& FrictionSystem::combine(const engine::PlanStep& row, double h, const Workspace& w, int segment) noexcept {
    const Segment& own = w.partition[segment];
    const engine::SlotView slots{state_views_.data(), slope_views_.data()};
    model::Columns& window = segments_[at(segment)].window;
    const int stride = window.stride();
    if (own.size() == w.layout().links) {
        const bool straight = row.keep >= 0 && std::none_of(row.states.begin(), row.states.end(), [&](const engine::Term& term) { return term.slot == row.keep; });
        model::Columns& to = straight ? states_[at(row.keep)] : window;
        constexpr int begin = -model::Columns::before_first;   // a cache line
        engine::combine(row, h, slots, begin, w.layout().link_size() * stride, to.data() + begin);
        if (straight) return to;
    } else {
        for (int component = 0; component < w.layout().link_size(); ++component) {
            const int begin = component * stride + own.first;
            engine::combine(row, h, slots, begin, begin + own.size() + 2, window.at(component, own.first));
        }
    }
    if (row.keep >= 0) keep(w, window, states_[at(row.keep)], segment);
    return window;
}

void FrictionSystem::keep(const Workspace& w, const model::Columns& window, model::Columns& slot, int segment) noexcept {
    const Segment& own = w.partition[segment];
    for (int component = 0; component < w.layout().link_size(); ++component) {
        std::memcpy(slot.at(component, own.first + 1), window.at(component, own.first + 1), at(own.size()) * sizeof(double));
    }
    repeat(w, slot, segment);
}

void FrictionSystem::stage(const Workspace& w, const engine::PlanStep& row, double h, double lean, double weight, int segment) noexcept {
    const model::Columns& velocity = combine(row, h, w, segment);
    model::Columns& slope = slopes_[at(row.slope)];
    const model::FrictionBase base{&base_, &base_before_, lean};
    friction_.slopes(field_, range_of(w, row.time - 0.5, velocity, segment), &base, slope, weight, weight != 0.0 ? &impulses_ : nullptr);
    repeat(w, slope, segment);
}

void FrictionSystem::result(const Workspace& w, const engine::PlanStep& row, double h, int slot, int segment) noexcept {
    const Segment& own = w.partition[segment];
    const engine::SlotView slots{state_views_.data(), slope_views_.data()};
    for (int component = 0; component < w.layout().link_size(); ++component) {
        const int begin = component * states_[0].stride() + 1 + own.first;
        engine::combine(row, h, slots, begin, begin + own.size(), states_[at(slot)].at(component, own.first + 1));
    }
}

void FrictionSystem::react(Workspace& w, int segment) const noexcept {
    const Segment& own = w.partition[segment];
    for (int link = own.first; link < own.last; ++link) {
        w.loads[at(link)] = normal_loads_[at(link)];
        model::SheaveLoad& load = w.loads[at(link)].load;
        const model::TipArms& p = field_.arms[at(link)];
        for (int corner = 0; corner < model::tips_per_link; ++corner) {
            if (w.phases[at(model::tips_per_link * link + corner)] == model::Phase::free) continue;
            const int side = corner % 2;
            const double fx = *impulses_.at(3 * corner, link + 1), fy = *impulses_.at(3 * corner + 1, link + 1), fz = *impulses_.at(3 * corner + 2, link + 1);
            load.fx[side] -= fx;
            load.fy[side] -= fy;
            load.fz[side] -= fz;
            load.mx[side] -= p.y[corner] * fz - p.z[corner] * fy;
            load.my[side] -= p.z[corner] * fx - p.x[corner] * fz;
            load.mz[side] -= p.x[corner] * fy - p.y[corner] * fx;
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

void FrictionSystem::load(std::span<const double> memory) noexcept {
    const model::ChainLayout& at = friction_.chain().layout();
    const auto links = static_cast<std::size_t>(at.links);
    for (model::Columns* field : {&base_, &mode_}) {
        for (int row = 0; row < at.link_size(); ++row) {
            std::copy_n(memory.begin(), links, field->at(row, 1));
            memory = memory.subspan(links);
        }
    }
}

}  // namespace cvtflow::tasks
