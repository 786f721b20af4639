#include "tasks/method/friction/implicit_leapfrog.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tasks/method/friction/index.hpp"
#include "tasks/step/assembly/segment_tasks.hpp"
#include "tasks/step/method_memory.hpp"

namespace cvtflow::tasks {

double DirkTable::weight(int stage) const noexcept {
    return stage + 1 < static_cast<int>(times.size()) ? weights.back()[at(stage)] : gamma;
}

double DirkTable::centre() const noexcept {
    double sum = 0.0;
    for (std::size_t stage = 0; stage < times.size(); ++stage) sum += weight(static_cast<int>(stage)) * times[stage];
    return sum;
}

double DirkTable::extrapolation(int stage, double rise) const noexcept {
    const double mean = centre();
    return mean < 1.0 ? 0.5 * rise * (times[at(stage)] - mean) / (1.0 - mean) : 0.0;
}

DirkTable backward_euler() { return {1, 1.0, {1.0}, {{}}}; }

DirkTable sdirk2() {
    const double gamma = 1.0 - std::sqrt(0.5);
    return {2, gamma, {gamma, 1.0}, {{}, {1.0 - gamma}}};
}

ImplicitLeapfrog::ImplicitLeapfrog(Workspace& workspace, DirkTable table)
    : FrictionImplicit(workspace), frame_(workspace), table_(std::move(table)) {
    const int size = w_.layout().link_size(), slips = solve_.space().contacts().slips();
    for (int k = 0; k < solve_.groups(); ++k) {
        kicks_.push_back({model::LaneRows(size),
                          model::LaneRows(size),
                          model::LaneRows(size),
                          {},
                          model::LaneRows(slips),
                          model::LaneRows(2 * model::tips_per_link)});
        for (std::size_t stage = 0; stage < table_.times.size(); ++stage) kicks_.back().slopes.emplace_back(size);
    }
}

NextCycle ImplicitLeapfrog::begin() {
    if (frame_.is_new()) {
        frame_.turn_over();
        for (Kick& kick : kicks_) std::swap(kick.base, kick.before);
    }
    frame_.begin();
    stage_ = 0;
    at_ = w_.layout().ledger ? At::evaluate : At::record;
    if (w_.layout().ledger) return evaluate_cycle;  // accounts need the forces with friction
    return record_cycle;
}

NextCycle ImplicitLeapfrog::next() {
    switch (at_) {
        case At::evaluate: at_ = At::record; return record_cycle;
        case At::record: at_ = At::gather; return gather_cycle;
        case At::gather:
        case At::stage: at_ = At::solve; return solve_.begin(w_.step.h);
        case At::solve: return after_solve(solve_.next());
        case At::finish: frame_.end(w_.variator.sheave_forces(w_.tips.phases.data(), w_.links.loads.data())); return NextCycle::done();
    }
    return NextCycle::failed();
}

NextCycle ImplicitLeapfrog::after_solve(NextCycle cycle) {
    if (!cycle.is_done()) return cycle;
    if (stage_ + 1 == static_cast<int>(table_.times.size())) {
        at_ = At::finish;
        return finish_cycle;
    }
    ++stage_;
    at_ = At::stage;
    return stage_cycle;
}

/// Contacts and all other forces in the middle of the step.
void ImplicitLeapfrog::record(int segment) noexcept {
    double* window = w_.windows[at(segment)].data();
    fill_window(w_, w_.partition[segment], window);
    record_window(segment, window, frame_.drift());
}

/// Contacts, and the slips of the velocities with which the other forces were evaluated and of those with which the step begins.
void ImplicitLeapfrog::gather(int number) noexcept {
    model::SlipGroup& g = solve_.group(number);
    model::LaneRows& start = kicks_[at(number)].start;
    solve_.space().gather(field_, w_.tips.phases.data(), table_.gamma * w_.step.h, g);
    read(w_.states[0], w_.layout().link_size(), number, start);
    std::copy_n(start.at(0), model::slip_lanes * w_.layout().link_size(), g.velocity.at(0));
    solve_.space().slips(-0.5, g, g.link_slip_at_start);
    read(w_.slopes[1], w_.layout().link_size(), number, g.velocity);
    for (int row = 0; row < w_.layout().link_size(); ++row) {
        for (int lane = 0; lane < model::slip_lanes; ++lane)
            g.velocity.at(row)[lane] = start.at(row)[lane] + 0.5 * w_.step.h * g.velocity.at(row)[lane];
    }
    solve_.space().slips(0.0, g, g.own);
}

/// All forces but friction; then the first stage.
void ImplicitLeapfrog::base(int number) noexcept {
    model::SlipGroup& g = solve_.group(number);
    Kick& kick = kicks_[at(number)];
    solve_.assemble(number, g.slip);
    solve_.assemble(number, kick.begun, &model::SlipGroup::link_slip_at_start);
    guess(number,
          std::min(2.0 * table_.times[0], 1.0));  // slips at hand belong to the middle; beyond it they are no better when extrapolated
    for (int row = 0; row < w_.layout().link_size(); ++row) {
        for (const auto& [link, lane] : g.links) kick.base.at(row)[lane] = *frictionless_.at(row, link + 1);
    }
    std::fill_n(kick.impulses.at(0), 2 * model::tips_per_link * model::slip_lanes, 0.0);
    predict(number);
}

/// Where the solve of a stage starts: slips at hand, as many times as far from those where the step begins.
void ImplicitLeapfrog::guess(int number, double share) noexcept {
    double* slip = solve_.group(number).slip.at(0);
    const double* begun = kicks_[at(number)].begun.at(0);
    for (int k = 0; k < solve_.space().contacts().slips() * model::slip_lanes; ++k) slip[k] = begun[k] + share * (slip[k] - begun[k]);
}

/// Velocities of the stage at hand before its friction acts, and their slips.
void ImplicitLeapfrog::predict(int number) noexcept {
    model::SlipGroup& g = solve_.group(number);
    Kick& kick = kicks_[at(number)];
    const double share = table_.extrapolation(stage_, frame_.rise()), h = w_.step.h, step = h * table_.gamma;
    const int numbers = w_.layout().link_size() * model::slip_lanes;
    const double *now = kick.base.at(0), *before = kick.before.at(0), *start = kick.start.at(0);
    double *slope = kick.slopes[at(stage_)].at(0), *velocity = g.velocity.at(0);
    std::fill_n(velocity, numbers, 0.0);
    for (int other = 0; other < stage_; ++other) {
        const double weight = table_.weights[at(stage_)][at(other)];
        const double* past = kick.slopes[at(other)].at(0);
        for (int k = 0; k < numbers; ++k) velocity[k] += weight * past[k];
    }
    for (int k = 0; k < numbers; ++k) {
        slope[k] = now[k] + share * (now[k] - before[k]);
        velocity[k] = start[k] + h * velocity[k] + step * slope[k];
    }
    solve_.space().slips(table_.times[at(stage_)] - 0.5, g, g.predicted);
}

/// Friction of a stage that has been solved: its accelerations, and its part of the impulses.
void ImplicitLeapfrog::end_stage(int number) noexcept {
    model::SlipGroup& g = solve_.group(number);
    Kick& kick = kicks_[at(number)];
    const int solved = at_ == At::finish ? stage_ : stage_ - 1;
    solve_.settle(number);
    solve_.space().accelerate(g);
    for (int row = 0; row < w_.layout().link_size(); ++row) {
        for (int lane = 0; lane < model::slip_lanes; ++lane) kick.slopes[at(solved)].at(row)[lane] += g.acceleration.at(row)[lane];
    }
    const double weight = table_.weight(solved);
    for (int row = 0; row < 2 * model::tips_per_link; ++row) {
        for (int lane = 0; lane < model::slip_lanes; ++lane)
            kick.impulses.at(row)[lane] += weight * g.force.at(2 * model::SlipContacts::first_tip + row)[lane];
    }
}

void ImplicitLeapfrog::stage(int number) noexcept {
    end_stage(number);
    guess(number, table_.times[at(stage_)] / table_.times[at(stage_ - 1)]);
    predict(number);
}

void ImplicitLeapfrog::finish(int number) noexcept {
    end_stage(number);
    react(number);
    const model::SlipGroup& g = solve_.group(number);
    const model::ChainLayout& layout = w_.layout();
    const double step = w_.step.h * table_.gamma;
    for (const auto& [link, lane] : g.links) {
        const int q = layout.link_begin(link), v = q + layout.link_size();
        for (int k = 0; k < layout.link_size(); ++k) {
            w_.states[1][v + k] = g.velocity.at(k)[lane] + step * g.acceleration.at(k)[lane];
            w_.states[1][q + k] = w_.states[0][q + k] + 0.5 * w_.step.h * (w_.states[0][v + k] + w_.states[1][v + k]);
        }
    }
}

/// Loads of a group's links: of the normal forces, and the mean reaction of the tips' friction.
void ImplicitLeapfrog::react(int number) noexcept {
    model::SlipGroup& g = solve_.group(number);
    const model::LaneRows& impulses = kicks_[at(number)].impulses;
    for (const auto& [link, lane] : g.links) {
        w_.links.loads[at(link)] = normal_loads_[at(link)];
        model::SheaveLoad& load = w_.links.loads[at(link)].load;
        const model::TipArms& p = field_.arms[at(link)];
        for (int corner = 0; corner < model::tips_per_link; ++corner) {
            if (w_.tips.phases[at(model::tips_per_link * link + corner)] == model::Phase::free) continue;
            const int row = model::SlipGroup::Tip::count * corner + model::SlipGroup::Tip::tangent;
            const double first = impulses.at(2 * corner)[lane], second = impulses.at(2 * corner + 1)[lane];
            const auto along = [&, k = lane](int axis) {
                return g.tips.at(row + axis)[k] * first + g.tips.at(row + 3 + axis)[k] * second;
            };                                                                                          // clang 14 captures no binding
            load.add(corner % 2, along(0), along(1), along(2), p.x[corner], p.y[corner], p.z[corner]);  // on the sheave
        }
    }
}

void ImplicitLeapfrog::save(std::vector<double>& memory) const {
    memory.clear();
    frame_.save(memory);
    const int numbers = w_.layout().link_size() * model::slip_lanes;
    for (const Kick& kick : kicks_) memory.insert(memory.end(), kick.base.at(0), kick.base.at(0) + numbers);
}

void ImplicitLeapfrog::load(std::span<const double> memory) {
    if (memory.empty()) return;
    memory = frame_.load(memory);
    const auto numbers = static_cast<std::size_t>(w_.layout().link_size() * model::slip_lanes);
    for (Kick& kick : kicks_) {
        std::ranges::copy(pop_front(memory, numbers), kick.base.at(0));
    }
}

}  // namespace cvtflow::tasks
