#include "tasks/friction/friction_leapfrog.hpp"

#include <algorithm>
#include <string>

#include "tasks/assembly/link_accesses.hpp"
#include "tasks/step_graph.hpp"

namespace cvtflow::tasks {

namespace {

enum FrictionCycle : int { push_cycle = method_cycles, stage_cycle, finish_cycle };

constexpr int result_slot = kick_state_slots;   ///< velocity slot of the result
/// The spectrum moves with the tension: it is looked at every so many steps, and taken with a margin in between.
constexpr long steps_between_estimates = 64;
constexpr int first_iterations = 50, next_iterations = 4;
constexpr double margin = 1.1;

[[nodiscard]] FrictionLeapfrog& method_of(void* workspace) noexcept {
    return *static_cast<FrictionLeapfrog*>(static_cast<Workspace*>(workspace)->method);
}

[[nodiscard]] model::SheaveMotion change_of(const model::SheaveMotion& now, const model::SheaveMotion& before, double factor) noexcept {
    model::SheaveMotion change{};
    change.vx = factor * (now.vx - before.vx);
    change.vy = factor * (now.vy - before.vy);
    change.vz = factor * (now.vz - before.vz);
    change.spin_x = factor * (now.spin_x - before.spin_x);
    change.spin_y = factor * (now.spin_y - before.spin_y);
    change.spin_z = factor * (now.spin_z - before.spin_z);
    return change;
}

}  // namespace

FrictionLeapfrog::FrictionLeapfrog(Workspace& workspace, Kick kick)
    : w_(workspace), system_(workspace, kick_state_slots + 1, kick_slope_slots), tables_(kick) {}

void FrictionLeapfrog::add_tasks(engine::TaskGraph& graph) {
    for (int s = 0; s < w_.partition.size(); ++s) {
        const std::string number = "[" + std::to_string(s) + "]";
        const auto own = [&] { return LinkAccesses(w_, s); };
        graph.add({"push" + number, push_cycle, [](void* w, int segment) noexcept { method_of(w).push(segment); }, s,
                   own().with_halo(Field::states_read).with_halo(Field::slopes_read).own(Field::phase, false).segment(Field::window, true).own(Field::contact, true)
                       .own(Field::velocity_read, true).own(Field::force, true).list()});
        graph.add({"friction" + number, stage_cycle, [](void* w, int segment) noexcept { method_of(w).stage(segment); }, s,
                   own().with_halo(Field::contact).with_halo(Field::velocity_read).with_halo(Field::velocity_slope_read).own(Field::force, true)
                       .own(Field::phase, false).own(Field::velocity_kept, true).own(Field::velocity_slope, true).own(Field::impulse, true).list()});
        graph.add({"finish" + number, finish_cycle, [](void* w, int segment) noexcept { method_of(w).finish(segment); }, s,
                   own().own(Field::velocity_read, false).own(Field::velocity_slope_read, false).own(Field::impulse, false).own(Field::contact, false)
                       .own(Field::phase, false).own(Field::states_read, false).own(Field::velocity_kept, true).own(Field::state_kept, true).own(Field::load, true).list()});
    }
}

void FrictionLeapfrog::restart() noexcept {
    continues_ = false;
    begun_ = -1e300;
    length_ = 0.0;
    steps_ = 0;
    system_.restart();
}

/// Slope slot 1: [v | mean acceleration of the step before], the acceleration zero where there is none.
void FrictionLeapfrog::extrapolate() {
    if (continues_) {
        std::swap(w_.slopes[1], w_.end_slope);   // made by the last detect cycle
        return;
    }
    const model::ChainLayout& at = w_.layout();
    std::fill_n(w_.slopes[1], at.size(), 0.0);
    for (int link = 0; link < at.links; ++link) {
        const int q = at.link_begin(link);
        std::copy_n(w_.states[0] + q + at.link_size(), at.link_size(), w_.slopes[1] + q);
    }
    std::copy_n(w_.states[0] + at.pulley_begin() + at.pulley_size, at.pulley_size, w_.slopes[1] + at.pulley_begin());
}

/// What the step before has left becomes history.
void FrictionLeapfrog::turn_over() {
    extrapolate();
    system_.turn_over();
    std::copy(std::begin(w_.sheaves), std::end(w_.sheaves), sheaves_before_);
    length_before_ = continues_ ? length_ : 0.0;
    begun_ = w_.time;
    continues_ = true;
}

int FrictionLeapfrog::begin() {
    if (w_.time != begun_ || !continues_) turn_over();   // else the same step once more, only shorter
    length_ = w_.h;
    rise_ = length_before_ > 0.0 ? 2.0 * length_ / (length_ + length_before_) : 0.0;
    static constexpr engine::Term from{0, 1.0}, along{1, 0.5};
    w_.evaluate_end = false;
    w_.row = {{&from, 1}, {&along, 1}, -1, 2, 0.5};
    w_.slope_out = w_.slopes[2];
    const model::ChainLayout& at = w_.layout();
    engine::combine(w_.row, w_.h, w_.slots(), at.pulley_begin(), at.size(), w_.tail.data());
    if (at.pulley_size != 0) w_.variator.pulleys().motions(w_.tail.data(), w_.sheaves);
    drift_.step = w_.h;
    for (int k = 0; k < 4; ++k) drift_.change[k] = change_of(w_.sheaves[k], sheaves_before_[k], rise_);
    if (!at.ledger) {
        state_ = State::pushing;
        return push_cycle;
    }
    state_ = State::evaluating;   // accounts need the forces with friction
    return evaluate_cycle;
}

int FrictionLeapfrog::next() {
    switch (state_) {
        case State::evaluating: state_ = State::pushing; return push_cycle;
        case State::pushing: return start_kick();
        case State::finishing: return end_step();
        case State::stages: break;
    }
    if (stage_ + 1 < table_->plan.stages()) return start_stage(stage_ + 1);
    row_ = table_->plan.result();
    state_ = State::finishing;
    return finish_cycle;
}

int FrictionLeapfrog::start_kick() {
    if (steps_ % steps_between_estimates == 0) radius_ = system_.spectral_radius(w_, steps_ == 0 ? first_iterations : next_iterations);
    ++steps_;
    table_ = tables_.reaching(margin * radius_ * w_.h);
    if (table_ == nullptr) {
        fault_ = {FaultKind::too_stiff, w_.time, -1, radius_ * w_.h, tables_.longest_reach() / margin};
        return failed;
    }
    state_ = State::stages;
    return start_stage(0);
}

int FrictionLeapfrog::start_stage(int stage) {
    stage_ = stage;
    row_ = table_->plan.stage(stage);
    weight_ = table_->weights[static_cast<std::size_t>(stage)];
    // From the mean of the stages to the end of the step: half a rise, and no impulse.
    lean_ = 0.5 * rise_ * (row_.time - table_->centre) / (1.0 - table_->centre);
    return stage_cycle;
}

int FrictionLeapfrog::end_step() {
    const model::ChainLayout& at = w_.layout();
    const int begin = at.pulley_begin();
    const int half = at.pulley_size;
    close_evaluation(w_, w_.time + 0.5 * w_.h, w_.tail.data(), w_.slopes[2]);
    for (int k = begin + half; k < at.size(); ++k) w_.states[1][k] = w_.states[0][k] + w_.h * w_.slopes[2][k];
    for (int k = begin; k < begin + half; ++k) w_.states[1][k] = w_.states[0][k] + 0.5 * w_.h * (w_.states[0][k + half] + w_.states[1][k + half]);
    static constexpr engine::Term end{1, 1.0};
    w_.row = {{&end, 1}, {}, -1, -1, 1.0};
    return done;
}

void FrictionLeapfrog::save(std::vector<double>& memory) const {
    memory.assign({continues_ ? 1.0 : 0.0, length_, radius_, static_cast<double>(steps_)});
    for (const model::SheaveMotion& s : w_.sheaves) memory.insert(memory.end(), {s.vx, s.vy, s.vz, s.spin_x, s.spin_y, s.spin_z});
    memory.insert(memory.end(), w_.end_slope, w_.end_slope + w_.layout().size());
    system_.save(memory);
}

void FrictionLeapfrog::load(std::span<const double> memory) {
    if (memory.empty()) return;
    continues_ = memory[0] != 0.0;
    length_ = memory[1];
    radius_ = memory[2];
    steps_ = static_cast<long>(memory[3]);
    begun_ = -1e300;
    memory = memory.subspan(4);
    for (model::SheaveMotion& s : w_.sheaves) {
        s.vx = memory[0], s.vy = memory[1], s.vz = memory[2];
        s.spin_x = memory[3], s.spin_y = memory[4], s.spin_z = memory[5];
        memory = memory.subspan(6);
    }
    const auto size = static_cast<std::size_t>(w_.layout().size());
    std::copy_n(memory.begin(), size, w_.end_slope);
    system_.load(memory.subspan(size));
}

void FrictionLeapfrog::push(int segment) noexcept {
    system_.push(w_, drift_, segment);
    system_.begin_from(w_, w_.states[0], segment);
}

void FrictionLeapfrog::stage(int segment) noexcept { system_.stage(w_, row_, w_.h, lean_, weight_, segment); }

void FrictionLeapfrog::finish(int segment) noexcept {
    system_.result(w_, row_, w_.h, result_slot, segment);
    system_.react(w_, segment);
    const model::ChainLayout& at = w_.layout();
    const model::Columns& velocity = system_.state(result_slot);
    for (int link = w_.partition[segment].first; link < w_.partition[segment].last; ++link) {
        const int q = at.link_begin(link);
        const int v = q + at.link_size();
        for (int k = 0; k < at.link_size(); ++k) {
            w_.states[1][v + k] = *velocity.at(k, link + 1);
            w_.states[1][q + k] = w_.states[0][q + k] + 0.5 * w_.h * (w_.states[0][v + k] + w_.states[1][v + k]);
        }
    }
}

}  // namespace cvtflow::tasks
