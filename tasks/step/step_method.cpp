#include "tasks/step/step_method.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "tasks/step/step_graph.hpp"

namespace cvtflow::tasks {

std::span<const double> pop_front(std::span<const double>& memory, std::size_t count) {
    if (memory.size() < count) throw std::invalid_argument("the memory of the method is incomplete");
    const std::span<const double> numbers = memory.first(count);
    memory = memory.subspan(count);
    return numbers;
}

int pop_integer(std::span<const double>& memory, int first, int last) {
    const double number = pop_front(memory, 1)[0];
    if (!(number >= first && number <= last) || number != std::floor(number))
        throw std::invalid_argument("the memory of the method contains an invalid count");
    return static_cast<int>(number);
}

void close_evaluation(Workspace& w, double time, const double* tail, const model::SheaveForces& chain, double* slope) noexcept {
    ++w.step.evaluations;
    w.variator.close(time, tail, chain, w.links.accounts.data(), slope + w.layout().pulley_begin());
}

void close_evaluation(Workspace& w) noexcept {
    close_evaluation(w, w.step.time + w.step.row.time * w.step.h, w.pulleys.tail.data(), sheave_forces(w), w.step.slope_out);
}

CycleSequence StageMethod::step() {
    slope_at_ = slope_now();
    bring_slope();
    const bool again = w_.step.time == std::exchange(begun_, w_.step.time);
    if (choice_ != nullptr) plan_ = &choice_->choose(again);
    for (int stage = slope_at_ == SlopeAt::start && plan_->stages() > 1 ? 1 : 0; stage < plan_->stages(); ++stage) {
        prepare_stage(plan_->stage(stage));
        co_yield evaluate_cycle;
        close_evaluation(w_);
    }
    w_.step.row = plan_->result();
    slope_at_ = plan_->last_is_result() ? SlopeAt::last : SlopeAt::nowhere;
    co_return {};
}

/// The last stage's slope into slot 0, by name only.
void StageMethod::bring_slope() noexcept {
    if (slope_at_ != SlopeAt::last) return;
    std::swap(w_.slopes[0], w_.slopes[static_cast<std::size_t>(plan_->stage(plan_->stages() - 1).slope)]);
    slope_at_ = SlopeAt::start;
}

void StageMethod::restart() noexcept {
    StageMethod::phases_changed();
    plan_ = &w_.plan;
    if (choice_ != nullptr) choice_->restart();
}

/// The slope at the state, if it is known.
void StageMethod::save(std::vector<double>& memory) const {
    memory.clear();
    if (choice_ != nullptr) choice_->save(memory);
    if (slope_now() == SlopeAt::nowhere) return;
    const int slot = slope_now() == SlopeAt::start ? 0 : plan_->stage(plan_->stages() - 1).slope;
    const double* slope = w_.slopes[static_cast<std::size_t>(slot)];
    memory.insert(memory.end(), slope, slope + w_.layout().size());
}

void StageMethod::load(std::span<const double> memory) {
    if (memory.empty()) return;
    if (choice_ != nullptr) memory = choice_->load(memory);
    if (memory.empty()) return;
    const auto slope = pop_front(memory, static_cast<std::size_t>(w_.layout().size()));
    std::copy(slope.begin(), slope.end(), w_.slopes[0]);
    slope_at_ = SlopeAt::start;
}

/// The pulleys at a stage, and what its evaluate cycle combines.
void StageMethod::prepare_stage(const engine::PlanStep& stage) {
    w_.step.evaluate_end = false;
    w_.step.row = stage;
    w_.step.slope_out = w_.slopes[static_cast<std::size_t>(w_.step.row.slope)];
    const model::ChainLayout& at = w_.layout();
    engine::combine(w_.step.row, w_.step.h, w_.slots(), at.pulley_begin(), at.size(), w_.pulleys.tail.data());
    if (w_.step.row.keep >= 0)
        std::copy(w_.pulleys.tail.begin(), w_.pulleys.tail.end(),
                  w_.states[static_cast<std::size_t>(w_.step.row.keep)] + at.pulley_begin());
    if (at.pulley_size != 0) w_.variator.pulleys().motions(w_.pulleys.tail.data(), w_.pulleys.sheaves);
}

}  // namespace cvtflow::tasks
