#include "tasks/method/friction/friction_leapfrog.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "tasks/step/assembly/link_accesses.hpp"
#include "tasks/step/method_memory.hpp"
#include "tasks/step/step_graph.hpp"

namespace cvtflow::tasks {

namespace {

enum FrictionCycle : int { contact_cycle = method_cycles, kick_cycle, finish_kick_cycle };

/// The spectrum moves with the tension: it is looked at every so many steps.
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
    for (int s = 0; s < w_.partition.size(); ++s) {
        const std::string number = "[" + std::to_string(s) + "]";
        const auto own = [&] { return LinkAccesses(w_, s); };
        graph.add({"record" + number, contact_cycle, engine::code_of<&FrictionLeapfrog::record>(*this), s,
                   own()
                       .with_halo(Field::states_read)
                       .with_halo(Field::slopes_read)
                       .own(Field::phase, false)
                       .segment(Field::window, true)
                       .own(Field::contact, true)
                       .own(Field::velocity_read, true)
                       .own(Field::force, true)
                       .list()});
        graph.add({"friction" + number, kick_cycle, engine::code_of<&FrictionLeapfrog::stage>(*this), s,
                   own()
                       .with_halo(Field::contact)
                       .with_halo(Field::velocity_read)
                       .own(Field::force, false)
                       .own(Field::phase, false)
                       .own(Field::velocity_kept, true)
                       .own(Field::velocity_slope, true)
                       .own(Field::impulse, true)
                       .list()});
        graph.add({"finish" + number, finish_kick_cycle, engine::code_of<&FrictionLeapfrog::finish>(*this), s,
                   own()
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
    w_.step.links_ended = w_.layout().probe_halo() == 0;  // else tips depend on neighbours, whose results are combined with them
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
        case State::finishing: frame_.end(); return NextCycle::done();
        case State::stages: break;
    }
    if (stage_ + 1 < table_->plan.stages()) return start_stage(stage_ + 1);
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
    return start_stage(0);
}

template <class Number>
NextCycle FrictionLeapfrog<Number>::start_stage(int stage) {
    stage_ = stage;
    row_ = table_->row(stage);
    extrapolation_ = table_->extrapolation(row_.here.time, frame_.rise());
    return kick_cycle;
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
    radius_ = taken(memory, 1)[0];
    steps_ = whole_taken(memory, 0, std::numeric_limits<int>::max());
    system_.load(frame_.load(memory));
}

template <class Number>
void FrictionLeapfrog<Number>::record(int segment) noexcept {
    system_.record(w_, frame_.drift(), segment);
}

template <class Number>
void FrictionLeapfrog<Number>::stage(int segment) noexcept {
    system_.stage(w_, row_, w_.step.h, extrapolation_, segment);
}

template <class Number>
void FrictionLeapfrog<Number>::finish(int segment) noexcept {
    system_.react(w_, segment);
    double* end = w_.step.links_ended ? w_.end_state : w_.states[1];
    system_.give(w_, end, segment);
    const model::ChainLayout& at = w_.layout();
    const int size = at.link_size();
    const double half = 0.5 * w_.step.h;
    for (int link = w_.partition[segment].first; link < w_.partition[segment].last; ++link) {
        const double* __restrict from = w_.states[0] + at.link_begin(link);
        double* __restrict to = end + at.link_begin(link);
        for (int k = 0; k < size; ++k) to[k] = from[k] + half * (from[size + k] + to[size + k]);
    }
}

template class FrictionLeapfrog<double>;
template class FrictionLeapfrog<float>;

}  // namespace cvtflow::tasks
