
#include "tasks/step/workspace.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "model/basis/portable_math.hpp"
#include "model/parameters/chain_layout.hpp"
#include "tasks/step/step_graph.hpp"

namespace cvtflow::tasks {

namespace {

model::PhaseRule rule_of(const model::Parameters& p) {
    model::PhaseRule rule;
    rule.saturation_speed = p.tip.friction.saturation_speed;
    rule.stick_slip = p.detail.stick_slip;
    return rule;
}

void add_up_group(Workspace& w, int group) noexcept {
    w.variator.add_up(group, w.tips.phases.data(), w.links.loads.data(), w.links.sums[at(group)],
                      w.links.sums[at(w.variator.sums() + group)]);
}

}  // namespace

Workspace::Workspace(const model::Parameters& p, const engine::StagePlan& stage_plan, Partition parts)
    : parameters(p), variator(p), plan(stage_plan), rule(rule_of(p)) {
    const std::size_t size = static_cast<std::size_t>(layout().size());
    const std::size_t stride = (size + 7) / 8 * 8;  // every slot begins on a new cache line
    const std::size_t arrays = static_cast<std::size_t>(plan.state_slots() + plan.slope_slots()) + 3;
    memory_.assign(arrays * stride, 0.0);
    double* next = memory_.data();
    const auto take = [&] { return std::exchange(next, next + stride); };
    for (int slot = 0; slot < plan.state_slots(); ++slot) states.push_back(take());
    for (int slot = 0; slot < plan.slope_slots(); ++slot) slopes.push_back(take());
    end_state = take();
    end_slope = take();
    cut_state = take();

    const std::size_t count = static_cast<std::size_t>(layout().links);
    links.loads.resize(count);
    links.sums.resize(static_cast<std::size_t>(2 * variator.sums()));
    links.split_sums.reserve(static_cast<std::size_t>(variator.sums()));
    links.errors.resize(count);
    step.error_scale.velocity = p.tip.friction.saturation_speed;
    links.accounts.resize(model::account_parts * count);
    links.contacts.resize(count);
    tips.phases.assign(model::tips_per_link * count, model::Phase::free);
    tips.phases_before = tips.phases;
    tips.before.assign(tips.phases.size(), {});
    tips.after.assign(tips.phases.size(), {});
    tips.probes.assign(tips.phases.size() / model::tips_per_link, {});
    tips.changed.assign(tips.phases.size(), -1e300);
    repartition(std::move(parts));
    pulleys.tail.resize(static_cast<std::size_t>(tail_size()));
    further = further_memory(*this);
}

const double* Workspace::state() const noexcept {
    if (columns_have_state_) columns_->write(states[0]);
    return states[0];
}

const double* Workspace::tail() const noexcept {
    double* const tail = states[0] + layout().pulley_begin();
    if (columns_have_state_) columns_->write_tail(tail);
    return tail;
}

model::RigidState& Workspace::columns() {
    if (!columns_) columns_ = std::make_unique<model::RigidState>(variator.chain().rigid()->model());
    return *columns_;
}

void Workspace::adopt(const model::Parameters& other) {
    columns_.reset();
    columns_have_state_ = links.observed = false;
    variator.adopt(parameters, other);
    parameters = other;
    rule = rule_of(other);
    tips.phases.assign(tips.phases.size(), model::Phase::free);
    tips.before.assign(tips.before.size(), {});
    tips.changed.assign(tips.changed.size(), -1e300);
}

void Workspace::repartition(Partition parts) {
    partition = std::move(parts);
    segment_results.resize(static_cast<std::size_t>(partition.size()));
    windows.resize(static_cast<std::size_t>(partition.size()));
    for (int s = 0; s < partition.size(); ++s)
        windows[static_cast<std::size_t>(s)].resize(
            static_cast<std::size_t>((partition[s].size() + 2 * layout().halo()) * layout().link_block()));
    links.split_sums.clear();
    for (int s = 1; s < partition.size(); ++s) {
        const int group = partition[s].first / model::links_per_sum;
        const bool splits = partition[s].first % model::links_per_sum != 0;
        if (splits && (links.split_sums.empty() || links.split_sums.back() != group)) links.split_sums.push_back(group);
    }
}

void add_up(Workspace& w, const Segment& bounds) noexcept {
    constexpr int size = model::links_per_sum;
    const int last = bounds.last == w.layout().links ? w.variator.sums() : bounds.last / size;
    for (int group = (bounds.first + size - 1) / size; group < last; ++group) add_up_group(w, group);
}

model::SheaveForces sheave_forces(Workspace& w) noexcept {
    if (w.layout().pulley_size == 0) return {};
    if (w.sums_missing) return w.variator.sheave_forces(w.tips.phases.data(), w.links.loads.data());
    for (const int group : w.links.split_sums) add_up_group(w, group);
    return w.variator.sheave_forces(w.tips.phases.data(), w.links.sums.data());
}

double Workspace::pin_period() const noexcept {
    if (!columns_have_state_) return model::pin_period(parameters.chain, layout(), states[0]);
    return pin_period(columns_->instant().sums().speed / layout().links);
}

double Workspace::pin_period(double speed) const noexcept {
    return speed > 0.0 ? model::chain_length(parameters.chain) / (layout().links * speed) : 0.0;
}

std::array<double, 3> Workspace::rear_half(int pin) const noexcept {
    const model::ChainLayout& at = layout();
    if (columns_have_state_) {
        const auto& at_pin = columns_->columns.state_position;
        return {at_pin.middle.x[pin], at_pin.middle.y[pin], at_pin.z[pin]};
    }
    const double* block = states[0] + at.link_begin(pin);
    return {block[at.x(model::End::rear, 0)], block[at.y(model::End::rear, 0)], block[at.z(model::End::rear)]};
}

std::array<double, 2> shaft_momentum(const Workspace& w) noexcept {
    if (w.layout().pulley_size == 0) return {};
    const double* block = w.tail();
    return {w.variator.pulleys().momentum(block, 0), w.variator.pulleys().momentum(block, 1)};
}

std::size_t Workspace::bytes() const noexcept {
    const auto of = [](const auto&... vectors) { return ((vectors.size() * sizeof(vectors[0])) + ...); };
    std::size_t bytes = sizeof(*this);
    for (const auto& window : windows) bytes += of(window);
    if (columns_) bytes += columns_->bytes();
    return bytes + of(memory_, pulleys.tail, links.loads, links.sums, links.accounts, links.contacts, links.errors, tips.phases,
                      tips.phases_before, tips.before, tips.after, tips.probes, tips.changed, segment_results);
}

Partition Partition::equal(int links, int segments, int grain) {
    if (segments < 1 || segments > links) {
        throw std::invalid_argument("run.segments: " + std::to_string(segments) + " segments for " + std::to_string(links) +
                                    " links; give 1 to " + std::to_string(links));
    }
    Partition partition;
    const int unit = segments <= (links + grain - 1) / grain ? grain : 1, units = (links + unit - 1) / unit;
    for (int s = 0; s < segments; ++s) {
        const auto cut = [&](int k) { return std::min(links, unit * static_cast<int>(static_cast<long>(units) * k / segments)); };
        partition.segments_.push_back({cut(s), cut(s + 1)});
    }
    return partition;
}

Partition Partition::at(const std::vector<int>& cuts) {
    Partition partition;
    for (std::size_t s = 1; s < cuts.size(); ++s) {
        if (cuts[s] <= cuts[s - 1]) throw std::invalid_argument("partition: borders must increase");
        partition.segments_.push_back({cuts[s - 1], cuts[s]});
    }
    if (partition.segments_.empty() || cuts.front() != 0)
        throw std::invalid_argument("partition: borders must begin with 0 and end with the number of links");
    return partition;
}

}  // namespace cvtflow::tasks
