#include "tasks/method/friction/sweep/sweep_leapfrog.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "tasks/method/friction/kick_record.hpp"
#include "tasks/step/step_graph.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

namespace {

/// Passes of the sweeps' cycles; three is a step of two sweeps.
constexpr std::array passes_of_cycles{1, 3, 4, 8};

enum SweepCycle : int { contact_cycle = method_cycles, first_sweep_cycle };

/// Share of their last change by which forces are ahead where the next step begins. More diverges, less makes tips late.
constexpr double ahead = 0.5;

/// Steps whose lengths differ by less have the same length; the time is rounded.
constexpr double same_length = 1e-6;

/// Sweeps of a step. A force is late by what a sweep has not followed, and that does not shrink with the speed at which it saturates: two
/// sweeps at a tenth of the usual speeds have twice the error of tips, five the same. Two at the usual speeds would do but for small slips
/// (`overdrive` at a reversed 25 N m: off by 1.4 % of 6e-4), so there are three (decision 96).
constexpr double sweeps_at_usual_speeds = 2.0, min_sweeps = 3.0, max_sweeps = 12.0, power_of_slowness = 0.4;

[[nodiscard]] double wanted_sweeps(const model::Parameters& parameters) {
    const model::Parameters usual;
    const double slowness = std::max({usual.tip.friction.saturation_speed / parameters.tip.friction.saturation_speed,
                                      usual.joint.friction.saturation_speed / parameters.joint.friction.saturation_speed,
                                      usual.plate.friction.saturation_speed / parameters.plate.friction.saturation_speed});
    return sweeps_at_usual_speeds * std::pow(slowness, power_of_slowness) - 0.1;
}

[[nodiscard]] int sweeps_for(const model::Parameters& parameters) {
    return static_cast<int>(std::ceil(std::clamp(wanted_sweeps(parameters), min_sweeps, max_sweeps)));
}

}  // namespace

std::string_view missing_for_sweeps(const model::Parameters& parameters) noexcept {
    if (parameters.detail.pins == model::PinDetail::rigid) return "";
    return parameters.detail.friction == model::FrictionLaw::piecewise ? "" : "detail.friction = \"piecewise\"";
}

bool sweeps_suit(const model::Parameters& parameters) {
    return missing_for_sweeps(parameters).empty() && !parameters.detail.stick_slip && wanted_sweeps(parameters) <= max_sweeps;
}

template <class Number>
SweepLeapfrog<Number>::SweepLeapfrog(Workspace& workspace)
    : w_(workspace), frame_(workspace), system_(workspace), sweeps_(sweeps_for(workspace.parameters)) {}

template <class Number>
void SweepLeapfrog<Number>::add_tasks(engine::TaskGraph& graph) {
    for (int s = 0; s < w_.partition.size(); ++s)
        graph.add({"record[" + std::to_string(s) + "]", contact_cycle, engine::code_of<&SweepLeapfrog::record>(*this), s,
                   LinkAccesses(w_, s)
                       .with_halo(Field::states_read)
                       .with_halo(Field::slopes_read)
                       .own(Field::phase, false)
                       .segment(Field::window, true)
                       .own(Field::contact, true)
                       .own(Field::force, true)
                       .list()});
    for (std::size_t k = 0; k < passes_of_cycles.size(); ++k)
        add_passes(graph, first_sweep_cycle + static_cast<int>(k), passes_of_cycles[k]);
    add_booking(graph);
}

/// The losses that the laws have at the state observed are replaced by what the last step's forces have done.
template <class Number>
void SweepLeapfrog<Number>::add_booking(engine::TaskGraph& graph) {
    const int others = graph.size();
    engine::Access accounts{static_cast<int>(Field::account), 0, w_.layout().links, true};
    const int booking = graph.add({"book", observe_cycle, engine::code_of<&SweepLeapfrog::book>(*this), 0, {accounts}});
    for (int task = 0; task < others; ++task) {
        if (graph.task(task).cycle == observe_cycle) graph.order(task, booking);
    }
}

/// Passes one after the other: a segment's waits for the pass before of itself and of those whose velocities it reads. What it hands over
/// has two places in turn, so that a pass writes not what its neighbours read meanwhile.
template <class Number>
void SweepLeapfrog<Number>::add_passes(engine::TaskGraph& graph, int cycle, int passes) {
    const int segments = w_.partition.size(), first = graph.size();
    for (int item = 0; item < passes * segments; ++item) {
        const int pass = item / segments, s = item % segments;
        const bool even = pass % 2 == 0;
        graph.add({"friction[" + std::to_string(s) + "]" + (passes == 1 ? "" : ", pass " + std::to_string(pass)), cycle,
                   engine::code_of<&SweepLeapfrog::sweep>(*this), item,
                   LinkAccesses(w_, s)
                       .with_halo(Field::contact)
                       .with_halo(even ? Field::velocity_read : Field::velocity_kept)
                       .own(Field::phase, false)
                       .own(even ? Field::velocity_kept : Field::velocity_read, true)
                       .own(Field::force, true)
                       .own(Field::impulse, true)
                       .own(Field::states_read, false)
                       .segment(Field::window, false)
                       .own(Field::state_kept, true)
                       .own(Field::end_state, true)
                       .own(Field::load, true)
                       .list()});
    }
    for (int s = 0; s < segments; ++s) {
        for (const int near : near_segments(w_, s)) {
            for (int pass = 1; pass < passes; ++pass) graph.order(first + (pass - 1) * segments + near, first + pass * segments + s);
        }
    }
}

template <class Number>
void SweepLeapfrog<Number>::restart() noexcept {
    frame_.restart();
    system_.restart();
    cold_ = true;
    nominal_ = begun_length_ = 0.0;
}

template <class Number>
NextCycle SweepLeapfrog<Number>::begin() {
    if (frame_.is_new()) {
        cold_ = !frame_.continues();
        if (w_.step.h > nominal_ || std::abs(w_.step.h - begun_length_) < same_length * begun_length_) nominal_ = w_.step.h;
        begun_length_ = w_.step.h;
        frame_.turn_over();
        system_.turn_over();
    }
    frame_.begin();
    system_.begin(w_.step.h, nominal_);
    w_.step.end_state_ready = true;
    pass_ = 0;
    passes_ = 1 + (cold_ ? first_sweeps : sweeps_);
    state_ = w_.layout().ledger ? State::evaluating : State::recording;
    if (w_.layout().ledger) return evaluate_cycle;  // accounts need the forces with friction
    return contact_cycle;
}

template <class Number>
NextCycle SweepLeapfrog<Number>::next() {
    if (state_ == State::evaluating) {
        state_ = State::recording;
        return contact_cycle;
    }
    state_ = State::sweeping;
    if (pass_ < passes_) return next_passes();
    frame_.end(w_.sheave_forces());
    system_.end();
    return NextCycle::done();
}

/// As many of the passes that are left as a cycle has.
template <class Number>
NextCycle SweepLeapfrog<Number>::next_passes() {
    std::size_t k = passes_of_cycles.size() - 1;
    while (passes_of_cycles[k] > passes_ - pass_) --k;
    begun_ = pass_;
    pass_ += passes_of_cycles[k];
    return first_sweep_cycle + static_cast<int>(k);
}

template <class Number>
void SweepLeapfrog<Number>::save(std::vector<double>& memory) const {
    memory.assign({nominal_, begun_length_});
    frame_.save(memory);
    system_.save(memory);
}

template <class Number>
void SweepLeapfrog<Number>::load(std::span<const double> memory) {
    if (memory.empty()) return;
    const auto lengths = pop_front(memory, 2);
    nominal_ = lengths[0];
    begun_length_ = lengths[1];
    system_.load(frame_.load(memory));
}

template <class Number>
void SweepLeapfrog<Number>::record(int segment) noexcept {
    system_.record(w_, frame_.drift(), segment);
}

template <class Number>
void SweepLeapfrog<Number>::sweep(int item) noexcept {
    const int segments = w_.partition.size(), segment = item % segments, pass = begun_ + item / segments;
    const bool closing = pass + 1 == passes_;
    const model::SweepPart part = pass == 0 ? model::SweepPart::opening : closing ? model::SweepPart::closing : model::SweepPart::middle;
    system_.sweep(w_, part, cold_ ? 0.0 : ahead, pass, segment);
    if (closing) system_.finish(w_, segment);
}

template <class Number>
void SweepLeapfrog<Number>::book(int /*item*/) noexcept {
    system_.book(w_);
}

template class SweepLeapfrog<double>;
template class SweepLeapfrog<float>;

}  // namespace cvtflow::tasks
