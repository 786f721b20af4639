#include "tasks/method/friction/additive/additive_method.hpp"

#include <algorithm>
#include <utility>

#include "tasks/method/friction/index.hpp"
#include "tasks/step/assembly/segment_tasks.hpp"

namespace cvtflow::tasks {

namespace {

constexpr engine::Term start{0, 1.0}, kept{1, 1.0};

}  // namespace

AdditiveMethod::AdditiveMethod(Workspace& workspace, AdditiveTable table) : FrictionImplicit(workspace), table_(std::move(table)) {
    for (int stage = 0; stage < table_.stages(); ++stage) {
        const double weight = table_.weights[at(stage)];
        if (weight != 0.0) weights_.push_back({stage + 1, weight});
        if (!table_.embedded.empty() && weight != table_.embedded[at(stage)])
            error_.push_back({stage + 1, weight - table_.embedded[at(stage)]});
    }
    const int size = w_.layout().link_size();
    for (int group = 0; group < solve_.groups(); ++group) {
        stages_.push_back({model::LaneRows(size), {}});
        for (int stage = 0; stage < table_.stages(); ++stage) stages_.back().friction.emplace_back(size);
    }
}

std::optional<engine::PlanStep> AdditiveMethod::error_row() const noexcept {
    if (error_.empty()) return {};
    return engine::PlanStep{{}, error_, -1, -1, 0.0};
}

NextCycle AdditiveMethod::begin() {
    stage_ = 0;
    std::copy(w_.states[0] + w_.layout().pulley_begin(), w_.states[0] + w_.layout().size(), w_.pulleys.tail.data());
    if (w_.layout().pulley_size != 0) w_.variator.pulleys().motions(w_.pulleys.tail.data(), w_.pulleys.sheaves);
    return evaluate({&start, 1});
}

/// The right-hand side of the stage at hand; the tail is at its state already.
NextCycle AdditiveMethod::evaluate(std::span<const engine::Term> states) noexcept {
    at_ = At::evaluate;
    w_.step.evaluate_end = false;
    w_.step.row = {states, {}, -1, stage_ + 1, table_.times[at(stage_)]};
    w_.step.slope_out = slope(stage_);
    return evaluate_cycle;
}

NextCycle AdditiveMethod::next() {
    switch (at_) {
        case At::evaluate: return after_evaluation();
        case At::stage: at_ = At::record; return record_cycle;
        case At::record: at_ = At::gather; return gather_cycle;
        case At::gather: return after_gathering();
        case At::solve: return after_solve(solve_.next());
        case At::finish: return evaluate({&kept, 1});
    }
    return NextCycle::failed();
}

NextCycle AdditiveMethod::after_evaluation() {
    close_evaluation(w_, w_.step.time + table_.times[at(stage_)] * w_.step.h, w_.pulleys.tail.data(),
                     w_.variator.sheave_forces(w_.tips.phases.data(), w_.links.loads.data()), slope(stage_));
    if (stage_ == 0) {  // friction of the first stage is not solved for
        at_ = At::record;
        return record_cycle;
    }
    if (stage_ + 1 < table_.stages()) return start_stage();
    w_.step.row = {{&start, 1}, weights_, -1, -1, 1.0};
    return NextCycle::done();
}

NextCycle AdditiveMethod::after_gathering() {
    if (stage_ == 0) return start_stage();
    at_ = At::solve;
    return solve_.begin(w_.step.h);
}

NextCycle AdditiveMethod::after_solve(NextCycle cycle) {
    if (!cycle.is_done()) return cycle;
    at_ = At::finish;
    return finish_cycle;
}

NextCycle AdditiveMethod::start_stage() {
    ++stage_;
    const model::ChainLayout& layout = w_.layout();
    for (int k = 0; k < w_.tail_size(); ++k) {
        double sum = 0.0;
        for (int other = 0; other < stage_; ++other)
            sum += table_.explicit_part[at(stage_)][at(other)] * slope(other)[layout.pulley_begin() + k];
        w_.pulleys.tail[at(k)] = w_.states[0][layout.pulley_begin() + k] + w_.step.h * sum;
    }
    if (layout.pulley_size != 0) w_.variator.pulleys().motions(w_.pulleys.tail.data(), w_.pulleys.sheaves);
    at_ = At::stage;
    return stage_cycle;
}

/// Coordinates of the stage at hand, its velocities without its own friction, and predicted ones.
void AdditiveMethod::stage(int number) noexcept {
    const int size = w_.layout().link_size(), numbers = size * model::slip_lanes;
    Stages& own = stages_[at(number)];
    const std::vector<double>&explicit_row = table_.explicit_part[at(stage_)], &implicit_row = table_.implicit_part[at(stage_)];
    double* friction = own.explicit_velocity.at(0);  // first: what is implicit of friction instead of explicit
    std::fill_n(friction, numbers, 0.0);
    for (int other = 0; other < stage_; ++other) {
        const double weight = implicit_row[at(other)] - explicit_row[at(other)], *past = own.friction[at(other)].at(0);
        for (int k = 0; k < numbers; ++k) friction[k] += weight * past[k];
    }
    const double step = w_.step.h * table_.gamma;
    for (const auto& [link, lane] : solve_.group(number).links) {
        const int q = w_.layout().link_begin(link);
        const double* from = w_.states[0] + q;
        double* to = stage_state() + q;
        std::fill_n(to, 2 * size, 0.0);
        for (int other = 0; other < stage_; ++other) {
            const double weight = explicit_row[at(other)], *past = slope(other) + q;
            for (int k = 0; k < 2 * size; ++k) to[k] += weight * past[k];
        }
        for (int k = 0; k < size; ++k) {
            double& velocity = own.explicit_velocity.at(k)[lane];
            velocity = from[size + k] + w_.step.h * (to[size + k] + velocity);
            to[k] = from[k] + w_.step.h * to[k];
            to[size + k] = velocity + step * own.friction[at(stage_ - 1)].at(k)[lane];
        }
    }
}

void AdditiveMethod::record(int segment) noexcept {
    record_window(segment, window_of(w_, stage_ == 0 ? w_.states[0] : stage_state(), segment), {});
}

void AdditiveMethod::gather(int number) noexcept {
    model::SlipGroup& g = solve_.group(number);
    solve_.space().gather(field_, w_.tips.phases.data(), table_.gamma * w_.step.h, g);
    if (stage_ > 1) return;
    read(predicts_from_start() ? w_.states[0] : stage_state(), w_.layout().link_size(), number, g.velocity);
    solve_.space().slips(0.0, g, g.own);
}

/// The first stage that is solved starts from its prediction, unless friction of the stage before is nothing that the implicit part uses:
/// that friction is then explicit and may be far off.
bool AdditiveMethod::predicts_from_start() const noexcept { return stage_ == 0 || (stage_ == 1 && table_.implicit_part[1][0] == 0.0); }

/// Friction at the first stage; the slips of the explicit velocities for the solve of any other, which starts from the solution of the
/// stage before.
void AdditiveMethod::base(int number) noexcept {
    model::SlipGroup& g = solve_.group(number);
    Stages& own = stages_[at(number)];
    const int numbers = w_.layout().link_size() * model::slip_lanes;
    if (stage_ <= 1) solve_.assemble(number, g.slip);
    if (stage_ == 0) {
        solve_.space().forces(g);
        solve_.space().accelerate(g);
        std::copy_n(g.acceleration.at(0), numbers, own.friction[0].at(0));
        return;
    }
    std::copy_n(own.explicit_velocity.at(0), numbers, g.velocity.at(0));
    solve_.space().slips(0.0, g, g.predicted);
}

/// Velocities and friction of the stage that has been solved.
void AdditiveMethod::finish(int number) noexcept {
    model::SlipGroup& g = solve_.group(number);
    const model::ChainLayout& layout = w_.layout();
    const double step = w_.step.h * table_.gamma;
    solve_.settle(number);
    solve_.space().accelerate(g);
    std::copy_n(g.acceleration.at(0), layout.link_size() * model::slip_lanes, stages_[at(number)].friction[at(stage_)].at(0));
    for (const auto& [link, lane] : g.links) {
        double* v = stage_state() + layout.link_begin(link) + layout.link_size();
        for (int k = 0; k < layout.link_size(); ++k) v[k] = g.velocity.at(k)[lane] + step * g.acceleration.at(k)[lane];
    }
}

}  // namespace cvtflow::tasks
