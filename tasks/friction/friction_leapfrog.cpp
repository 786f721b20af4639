#include "tasks/friction/friction_leapfrog.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

#include "engine/method/catalogue.hpp"
#include "engine/method/composition.hpp"
#include "engine/method/tableau.hpp"
#include "tasks/assembly/link_accesses.hpp"
#include "tasks/step_graph.hpp"

namespace cvtflow::tasks {

namespace {

enum FrictionCycle : int { record_cycle = method_cycles, subtract_cycle, stage_cycle, finish_cycle };

constexpr int result_slot = 6;   ///< velocity slot of the result

constexpr int fewest_stages = 2, most_stages = 60;

[[nodiscard]] FrictionLeapfrog& method_of(void* workspace) noexcept {
    return *static_cast<FrictionLeapfrog*>(static_cast<Workspace*>(workspace)->method);
}

/// Change of a sheave's velocities.
model::SheaveMotion change_of(const model::SheaveMotion& now, const model::SheaveMotion& before, double factor) noexcept {
    model::SheaveMotion change{};
    change.vx = factor * (now.vx - before.vx);
    change.vy = factor * (now.vy - before.vy);
    change.vz = factor * (now.vz - before.vz);
    change.spin_x = factor * (now.spin_x - before.spin_x);
    change.spin_y = factor * (now.spin_y - before.spin_y);
    change.spin_z = factor * (now.spin_z - before.spin_z);
    return change;
}

/// First-order Chebyshev, so strongly damped that what is stiff is gone after one step.
engine::StagePlan damped_chebyshev(int stages, double damping) {
    const double w0 = 1.0 + damping / (static_cast<double>(stages) * stages);
    std::vector<double> t{1.0, w0}, d{0.0, 1.0};
    for (std::size_t j = 2; j <= static_cast<std::size_t>(stages); ++j) {
        t.push_back(2.0 * w0 * t[j - 1] - t[j - 2]);
        d.push_back(2.0 * t[j - 1] + 2.0 * w0 * d[j - 1] - d[j - 2]);
    }
    const double w1 = t.back() / d.back();
    engine::StagePlan plan{.name = "chebyshev-s" + std::to_string(stages), .description = {}, .source = {}, .state_slots = 4, .slope_slots = 1, .stages = {}, .result = {}, .error = {}};
    const auto slot = [](int j) { return j == 0 ? 0 : 1 + (j - 1) % 3; };
    const auto combination = [&](int j) {   // Y_j
        engine::Combination c;
        if (j == 0) return engine::Combination{{{0, 1.0}}, {}};
        if (j == 1) return engine::Combination{{{0, 1.0}}, {{0, w1 / w0}}};
        const auto i = static_cast<std::size_t>(j);
        c.states = {{slot(j - 1), 2.0 * w0 * t[i - 1] / t[i]}, {slot(j - 2), -t[i - 2] / t[i]}};
        c.slopes = {{j == 1 ? 0 : (j - 1) % 2 + 1, 2.0 * w1 * t[i - 1] / t[i]}};
        return c;
    };
    plan.slope_slots = 3;
    for (int j = 0; j < stages; ++j) {
        const engine::Combination c = combination(j);
        plan.stages.push_back({c.states, c.slopes, j == 0 ? -1 : slot(j), j == 0 ? 0 : j % 2 + 1});
    }
    plan.result = combination(stages);
    return plan;
}

}  // namespace

FrictionLeapfrog::FrictionLeapfrog(Workspace& workspace) : w_(workspace), system_(workspace, 7, 5) {
    const char* damping = std::getenv("CVT_EPS");
    for (int stages = fewest_stages; stages <= most_stages; ++stages) {
        const char* second = std::getenv("CVT_EPS2");
        const auto plan = second != nullptr ? *engine::make_method("rkc-s" + std::to_string(stages) + "-e" + second) : damping == nullptr ? *engine::make_method("rkc-s" + std::to_string(stages)) : damped_chebyshev(stages, std::atof(damping));
        static const int sub = std::getenv("CVT_SUB") ? std::atoi(std::getenv("CVT_SUB")) : 1;
        const auto all = sub > 1 ? engine::repeated(plan, sub) : plan;
        tables_.emplace_back(all);
        weights_.push_back(engine::unroll(all).weights);
    }
}

void FrictionLeapfrog::add_tasks(engine::TaskGraph& graph) const {
    for (int s = 0; s < w_.partition.size(); ++s) {
        const std::string number = "[" + std::to_string(s) + "]";
        graph.add({"record" + number, record_cycle, [](void* w, int segment) noexcept { method_of(w).record(segment); }, s, {}});
        graph.add({"subtract" + number, subtract_cycle, [](void* w, int segment) noexcept { method_of(w).subtract(segment); }, s, {}});
        graph.add({"friction" + number, stage_cycle, [](void* w, int segment) noexcept { method_of(w).stage(segment); }, s, {}});
        graph.add({"finish" + number, finish_cycle, [](void* w, int segment) noexcept { method_of(w).finish(segment); }, s, {}});
    }
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

int FrictionLeapfrog::begin() {
    if (w_.time != begun_ || !continues_) {   // else the same step once more, only shorter
        extrapolate();
        system_.turn_over();
        std::copy(std::begin(w_.sheaves), std::end(w_.sheaves), sheaves_before_);
        length_before_ = continues_ ? length_ : 0.0;
        begun_ = w_.time;
    }
    length_ = w_.h;
    static const bool plain = std::getenv("CVT_PLAIN") != nullptr;
    rise_ = length_before_ > 0.0 && !plain ? 2.0 * length_ / (length_ + length_before_) : 0.0;
    static const engine::Term from{0, 1.0}, along{1, 0.5};
    w_.evaluate_end = false;
    w_.row = {{&from, 1}, {&along, 1}, -1, 2, 0.5};
    w_.slope_out = w_.slopes[2];
    const model::ChainLayout& at = w_.layout();
    engine::combine(w_.row, w_.h, w_.slots(), at.pulley_begin(), at.size(), w_.tail.data());
    if (at.pulley_size != 0) w_.variator.pulleys().motions(w_.tail.data(), w_.sheaves);
    drift_.step = std::getenv("CVT_NODRIFT") ? 0.0 : w_.h;
    for (int k = 0; k < 4; ++k) drift_.change[k] = change_of(w_.sheaves[k], sheaves_before_[k], std::getenv("CVT_NODRIFT") ? 0.0 : rise_);
    state_ = State::evaluating;
    return evaluate_cycle;
}

int FrictionLeapfrog::next() {
    switch (state_) {
        case State::evaluating: state_ = State::recording; return record_cycle;
        case State::recording: state_ = State::subtracting; return subtract_cycle;
        case State::subtracting: return start_kick();
        case State::finishing: return end_step();
        case State::stages: break;
    }
    if (stage_ + 1 < tables_[table_].stages()) {
        set_row(stage_ + 1);
        return stage_cycle;
    }
    row_ = tables_[table_].result();
    state_ = State::finishing;
    return finish_cycle;
}

int FrictionLeapfrog::start_kick() {
    choose_table();
    state_ = State::stages;
    set_row(0);
    return stage_cycle;
}

void FrictionLeapfrog::set_row(int stage) {
    stage_ = stage;
    row_ = tables_[table_].stage(stage);
    weight_ = weights_[table_][static_cast<std::size_t>(stage)];
    static const double m = std::getenv("CVT_M") ? std::atof(std::getenv("CVT_M")) : 1.0;
    double centre = 0.0;
    for (int k = 0; k < tables_[table_].stages(); ++k) centre += weights_[table_][static_cast<std::size_t>(k)] * tables_[table_].stage(k).time;
    lean_ = m * rise_ * (row_.time - centre) * 0.5 / (1.0 - centre);
}

int FrictionLeapfrog::end_step() {
    const model::ChainLayout& at = w_.layout();
    const int begin = at.pulley_begin();
    const int half = at.pulley_size;
    close_evaluation(w_, w_.time + 0.5 * w_.h, w_.tail.data(), w_.slopes[2]);
    for (int k = begin + half; k < at.size(); ++k) w_.states[1][k] = w_.states[0][k] + w_.h * w_.slopes[2][k];
    for (int k = begin; k < begin + half; ++k) w_.states[1][k] = w_.states[0][k] + 0.5 * w_.h * (w_.states[0][k + half] + w_.states[1][k + half]);
    continues_ = true;
    static const engine::Term end{1, 1.0};
    w_.row = {{&end, 1}, {}, -1, -1, 1.0};
    return done;
}

void FrictionLeapfrog::choose_table() {
    if (steps_++ % 64 == 0) {
        radius_ = system_.spectral_radius(w_, steps_ == 1 ? 50 : 4);
        static const bool say = std::getenv("CVT_SAY") != nullptr;
        if (say && steps_ % 640 == 1) std::fprintf(stderr, "radius %.3e h %.3e\n", radius_, w_.h);
    }
    static const double factor = std::getenv("CVT_Z") ? std::atof(std::getenv("CVT_Z")) : 1.0;
    static const double damping = std::getenv("CVT_EPS") ? std::atof(std::getenv("CVT_EPS")) : 0.0;
    static const int sub = std::getenv("CVT_SUB") ? std::atoi(std::getenv("CVT_SUB")) : 1;
    const double z = 1.1 * factor * radius_ * w_.h / sub;
    static const double second = std::getenv("CVT_EPS2") ? std::atof(std::getenv("CVT_EPS2")) : 0.0;
    const int stages = second > 0.0 ? 1 + static_cast<int>(std::ceil(std::sqrt(0.5 * z * std::sqrt(2.0 * second)))) : damping > 0.0 ? 1 + static_cast<int>(std::ceil(std::sqrt(0.5 * z * std::sqrt(2.0 * damping) / std::tanh(std::sqrt(2.0 * damping)))))
                                     : 1 + static_cast<int>(std::ceil(std::sqrt(1.0 + 1.54 * z)));
    table_ = static_cast<std::size_t>(std::clamp(stages, fewest_stages, most_stages) - fewest_stages);
}

void FrictionLeapfrog::record(int segment) noexcept {
    system_.record(w_, drift_, segment);
    system_.load(w_, w_.slopes[2], segment);
    system_.begin_from(w_, w_.states[0], segment);
}

void FrictionLeapfrog::subtract(int segment) noexcept { system_.subtract(w_, segment); }

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
