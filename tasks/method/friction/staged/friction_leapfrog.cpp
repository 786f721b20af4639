#include "tasks/method/friction/staged/friction_leapfrog.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "tasks/method/friction/kick_record.hpp"
#include "tasks/step/step_graph.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

namespace {

/// Stages of the kicks' cycles; a kick of eleven stages is cycles of eight, two and one.
constexpr std::array stages_of_kicks{1, 2, 4, 8};

/// In the order in which a step runs them, which is also the order of the report.
enum FrictionCycle : int {
    contact_cycle = method_cycles,
    first_kick_cycle,
    finish_kick_cycle = first_kick_cycle + static_cast<int>(stages_of_kicks.size())
};

/// The spectrum changes with the tension: steps between two estimates.
constexpr long steps_between_estimates = 64;
constexpr int first_iterations = 50, next_iterations = 4;

/// The first link with an unknown that is not finite, if there is one.
[[nodiscard]] std::optional<int> first_not_finite(const Workspace& w) noexcept {
    const model::ChainLayout& at = w.layout();
    for (int link = 0; link < at.links; ++link) {
        const double* begin = w.states[0] + at.link_begin(link);
        if (!std::all_of(begin, begin + 2 * at.link_size(), [](double x) { return std::isfinite(x); })) return link;
    }
    return {};
}

}  // namespace

template <class Number>
FrictionLeapfrog<Number>::FrictionLeapfrog(Workspace& workspace, Kick kick)
    : w_(workspace), frame_(workspace), system_(workspace), tables_(kick) {}

template <class Number>
void FrictionLeapfrog<Number>::add_tasks(engine::TaskGraph& graph) {
    const auto name = [](const char* stage, int segment) { return stage + ("[" + std::to_string(segment) + "]"); };
    for (int s = 0; s < w_.partition.size(); ++s)
        graph.add({name("record", s), contact_cycle, engine::code_of<&FrictionLeapfrog::record>(*this), s,
                   LinkAccesses(w_, s)
                       .with_halo(Field::states_read)
                       .with_halo(Field::slopes_read)
                       .own(Field::phase, false)
                       .segment(Field::window, true)
                       .own(Field::contact, true)
                       .own(Field::velocity_read, true)
                       .own(Field::force, true)
                       .list()});
    for (std::size_t kick = 0; kick < stages_of_kicks.size(); ++kick)
        add_kick(graph, first_kick_cycle + static_cast<int>(kick), stages_of_kicks[kick]);
    for (int s = 0; s < w_.partition.size(); ++s)
        graph.add({name("finish", s), finish_kick_cycle, engine::code_of<&FrictionLeapfrog::finish>(*this), s,
                   LinkAccesses(w_, s)
                       .own(Field::velocity_read, false)
                       .own(Field::impulse, false)
                       .own(Field::contact, false)
                       .own(Field::phase, false)
                       .own(Field::states_read, false)
                       .segment(Field::window, false)
                       .own(Field::state_kept, true)
                       .own(Field::end_state, true)
                       .own(Field::load, true)
                       .list()});
}

/// Stages one after the other: a segment's waits for the stage before of itself and of those whose velocities it reads. No two rows in
/// succession have the same slot, so what a stage writes is not what its neighbours read meanwhile.
template <class Number>
void FrictionLeapfrog<Number>::add_kick(engine::TaskGraph& graph, int cycle, int stages) {
    static_assert(stages_of_kicks.back() == max_stages_together);
    const int segments = w_.partition.size(), first = graph.size();
    for (int item = 0; item < stages * segments; ++item) {
        const int stage = item / segments, s = item % segments;
        const bool even = stage % 2 == 0;
        graph.add({"friction[" + std::to_string(s) + "]" + (stages == 1 ? "" : ", stage " + std::to_string(stage)), cycle,
                   engine::code_of<&FrictionLeapfrog::stage>(*this), item,
                   LinkAccesses(w_, s)
                       .with_halo(Field::contact)
                       .with_halo(even ? Field::velocity_read : Field::velocity_kept)
                       .own(Field::force, false)
                       .own(Field::phase, false)
                       .own(even ? Field::velocity_kept : Field::velocity_read, true)
                       .own(Field::velocity_slope, true)
                       .own(Field::impulse, true)
                       .list()});
    }
    for (int s = 0; s < segments; ++s) {
        for (const int near : near_segments(w_, s)) {
            for (int stage = 1; stage < stages; ++stage) graph.order(first + (stage - 1) * segments + near, first + stage * segments + s);
        }
    }
}

template <class Number>
void FrictionLeapfrog<Number>::restart() noexcept {
    frame_.restart();
    steps_ = 0;
    system_.restart();
}

template <class Number>
NextCycle FrictionLeapfrog<Number>::begin() {
    if (frame_.is_new()) {
        frame_.turn_over();
        system_.turn_over();
    }
    frame_.begin();
    w_.step.end_state_ready = true;
    if (!w_.layout().ledger) {
        state_ = State::recording;
        return contact_cycle;
    }
    state_ = State::evaluating;  // accounts need the forces with friction
    return evaluate_cycle;
}

template <class Number>
NextCycle FrictionLeapfrog<Number>::next() {
    switch (state_) {
        case State::evaluating: state_ = State::recording; return contact_cycle;
        case State::recording: return start_kick();
        case State::finishing: frame_.end(w_.sheave_forces()); return NextCycle::done();
        case State::stages: break;
    }
    if (stage_ < table_->plan.stages()) return start_stages();
    state_ = State::finishing;
    return finish_kick_cycle;
}

template <class Number>
NextCycle FrictionLeapfrog<Number>::start_kick() {
    if (steps_ % steps_between_estimates == 0) radius_ = system_.spectral_radius(w_, steps_ == 0 ? first_iterations : next_iterations);
    ++steps_;
    table_ = tables_.reaching(margin * radius_ * w_.step.h);
    if (table_ == nullptr) {
        fault_ = std::isfinite(radius_)
                     ? Fault{FaultKind::too_stiff, w_.step.time, {}, radius_ * w_.step.h, tables_.longest_reach() / margin}
                     : Fault{FaultKind::non_finite, w_.step.time, first_not_finite(w_), 0.0, 0.0};
        return NextCycle::failed();
    }
    state_ = State::stages;
    stage_ = 0;
    return start_stages();
}

/// As many of the stages that are left as a cycle has.
template <class Number>
NextCycle FrictionLeapfrog<Number>::start_stages() {
    const int left = table_->plan.stages() - stage_;
    std::size_t kick = stages_of_kicks.size() - 1;
    while (stages_of_kicks[kick] > left) --kick;
    for (int k = 0; k < stages_of_kicks[kick]; ++k, ++stage_) {
        const KickRow row = table_->row(stage_);
        together_[static_cast<std::size_t>(k)] = {row, table_->extrapolation(row.here.time, frame_.rise())};
    }
    return first_kick_cycle + static_cast<int>(kick);
}

template <class Number>
void FrictionLeapfrog<Number>::save(std::vector<double>& memory) const {
    memory.assign({radius_, static_cast<double>(steps_)});
    frame_.save(memory);
    system_.save(memory);
}

template <class Number>
void FrictionLeapfrog<Number>::load(std::span<const double> memory) {
    if (memory.empty()) return;
    radius_ = pop_front(memory, 1)[0];
    steps_ = pop_integer(memory, 0, std::numeric_limits<int>::max());
    system_.load(frame_.load(memory));
}

template <class Number>
void FrictionLeapfrog<Number>::record(int segment) noexcept {
    system_.record(w_, frame_.drift(), segment);
}

template <class Number>
void FrictionLeapfrog<Number>::stage(int item) noexcept {
    const int segments = w_.partition.size();
    const Stage& stage = together_[static_cast<std::size_t>(item / segments)];
    system_.stage(w_, stage.row, w_.step.h, stage.extrapolation, item % segments);
}

template <class Number>
void FrictionLeapfrog<Number>::finish(int segment) noexcept {
    system_.finish(w_, segment);
}

template class FrictionLeapfrog<double>;
template class FrictionLeapfrog<float>;

}  // namespace cvtflow::tasks
