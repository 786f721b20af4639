#include "bench/study/stability/frozen_step.hpp"

#include <algorithm>
#include <cmath>

#include "bench/study/error_measure.hpp"
#include "engine/method/catalogue.hpp"
#include "engine/method/compiled_plan.hpp"
#include "model/observe/observation.hpp"

namespace cvtflow::bench {

using namespace tasks;

namespace {

/// Solution whose errors are measured.
struct Solution {
    std::vector<double> positions, velocities, axial_force, tension;
};

Solution solution_of(const model::Variator& variator, double t, const std::vector<double>& state, const FrozenStart& start) {
    const model::ChainLayout& at = variator.layout();
    model::Observer observer(variator);
    const model::Observation& seen = observer.observe(t, state.data(), start.phases.data());
    Solution solution{{}, {}, seen.tip_axial, seen.tension};
    for (int link = 0; link < at.links; ++link) {
        const double* q = state.data() + at.link_begin(link);
        solution.positions.insert(solution.positions.end(), q, q + at.link_size());
        solution.velocities.insert(solution.velocities.end(), q + at.link_size(), q + at.link_block());
    }
    return solution;
}

/// Pointers to `count` vectors of `size`.
std::vector<double*> slots(std::vector<std::vector<double>>& memory, int count, int size) {
    memory.assign(static_cast<std::size_t>(count), std::vector<double>(static_cast<std::size_t>(size)));
    std::vector<double*> pointers;
    for (auto& slot : memory) pointers.push_back(slot.data());
    return pointers;
}

}  // namespace

FrozenStepper::FrozenStepper(const model::Variator& variator, const engine::StagePlan& plan, std::span<const model::Phase> phases)
    : variator_(variator),
      plan_(plan),
      phases_(phases),
      state_slots_(slots(states_, plan_.state_slots(), variator.layout().size())),
      slope_slots_(slots(slopes_, plan_.slope_slots(), variator.layout().size())),
      stage_(static_cast<std::size_t>(variator.layout().size())),
      scratch_(variator.layout()) {}

void FrozenStepper::step(double t, double h) {
    const int size = variator_.layout().size();
    const engine::SlotView view{state_slots_.data(), slope_slots_.data()};
    for (int stage = 0; stage < plan_.stages(); ++stage) {
        const engine::PlanStep row = plan_.stage(stage);
        engine::combine(row, h, view, 0, size, stage_.data());
        if (row.keep >= 0) std::copy(stage_.begin(), stage_.end(), state_slots_[static_cast<std::size_t>(row.keep)]);
        double* slope = slope_slots_[static_cast<std::size_t>(row.slope)];
        model::right_hand_side(variator_, drift_.empty() ? t + row.time * h : held_time_, stage_.data(), phases_.data(), slope, scratch_);
        for (std::size_t k = 0; k < drift_.size(); ++k) slope[k] -= drift_[k];
    }
    engine::combine(plan_.result(), h, view, 0, size, stage_.data());
    std::copy(stage_.begin(), stage_.end(), state_slots_[0]);
}

void FrozenStepper::hold(double t, const std::vector<double>& state) {
    drift_.resize(state.size());
    held_time_ = t;
    model::right_hand_side(variator_, t, state.data(), phases_.data(), drift_.data(), scratch_);
}

void FrozenStepper::advance(double t, double h, int steps, std::vector<double>& state) {
    std::copy(state.begin(), state.end(), state_slots_[0]);
    for (int number = 0; number < steps; ++number) step(t + number * h, h);
    std::copy_n(state_slots_[0], state.size(), state.begin());
}

LocalError error_of(const model::Variator& variator, const FrozenStart& start, double h, const std::vector<double>& state,
                    const std::vector<double>& reference) {
    const Solution is = solution_of(variator, start.time + h, state, start);
    const Solution should = solution_of(variator, start.time + h, reference, start);
    return {h, relative_error(is.positions, should.positions), relative_error(is.velocities, should.velocities),
            relative_error(is.axial_force, should.axial_force), relative_error(is.tension, should.tension)};
}

int reference_steps(double h, int refinement) noexcept {
    constexpr double longest = 12.5e-9;  // [s]
    return std::max(refinement, static_cast<int>(std::ceil(h / longest * (1.0 - 1e-12))));
}

std::vector<LocalError> local_errors(const model::Variator& variator, const engine::StagePlan& plan, const FrozenStart& start,
                                     std::span<const double> steps, int refinement) {
    FrozenStepper method(variator, plan, start.phases);
    FrozenStepper fine(variator, *engine::find_method("rk4"), start.phases);
    std::vector<LocalError> errors;
    for (const double h : steps) {
        std::vector<double> state = start.state, reference = start.state;
        const int fine_steps = reference_steps(h, refinement);
        method.advance(start.time, h, 1, state);
        fine.advance(start.time, h / fine_steps, fine_steps, reference);
        errors.push_back(error_of(variator, start, h, state, reference));
    }
    return errors;
}

}  // namespace cvtflow::bench
