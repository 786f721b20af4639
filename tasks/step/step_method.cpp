#include "tasks/step/step_method.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "tasks/step/step_graph.hpp"

namespace cvtflow::tasks {

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
void StageMethod::visit(engine::Archive& archive) {
    if (choice_ != nullptr) choice_->visit(archive);
    const SlopeAt at = slope_now();
    bool known = at != SlopeAt::nowhere;
    archive("slope_known", known);
    if (!known) return;
    const int slot = archive.reads() || at == SlopeAt::start ? 0 : plan_->stage(plan_->stages() - 1).slope;
    archive("slope", std::span(w_.slopes[static_cast<std::size_t>(slot)], static_cast<std::size_t>(w_.layout().size())));
    if (archive.reads()) slope_at_ = SlopeAt::start;
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
