#include "tasks/method/friction/leapfrog_frame.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

namespace {

/// Velocities of a sheave.
template <class Motion>
[[nodiscard]] auto velocities_of(Motion& s) noexcept {
    return std::array{&s.vx, &s.vy, &s.vz, &s.spin_x, &s.spin_y, &s.spin_z};
}

}  // namespace

void LeapfrogFrame::restart() noexcept {
    continues_ = false;
    length_ = 0.0;
}

/// Slope slot 1: [v | mean acceleration of the step before], zero acceleration in the first step.
void LeapfrogFrame::extrapolate() {
    if (continues_) {
        std::swap(w_.slopes[1], w_.end_slope);  // made at the end of the last step
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

void LeapfrogFrame::begin() {
    extrapolate();
    std::copy(std::begin(w_.pulleys.sheaves), std::end(w_.pulleys.sheaves), sheaves_before_);
    const double length_before = continues_ ? length_ : 0.0;
    length_ = w_.step.h;
    continues_ = true;
    // Change of a velocity over the step, in units of the difference between its last two values; 0 without a step before.
    const double change_ratio = length_before > 0.0 ? 2.0 * length_ / (length_ + length_before) : 0.0;
    static constexpr engine::Term from{0, 1.0}, along{1, 0.5};
    w_.step.evaluate_end = false;
    w_.step.row = {{&from, 1}, {&along, 1}, -1, 2, 0.5};
    w_.step.slope_out = w_.slopes[2];
    const model::ChainLayout& at = w_.layout();
    engine::combine(w_.step.row, w_.step.h, w_.slots(), at.pulley_begin(), at.size(), w_.pulleys.tail.data());
    if (at.pulley_size != 0) w_.variator.pulleys().motions(w_.pulleys.tail.data(), w_.pulleys.sheaves);
    drift_.step = w_.step.h;
    for (std::size_t sheave = 0; sheave < 4; ++sheave) {
        const auto now = velocities_of(w_.pulleys.sheaves[sheave]), before = velocities_of(sheaves_before_[sheave]);
        for (std::size_t k = 0; k < 6; ++k) drift_.change[sheave][k] = change_ratio * (*now[k] - *before[k]);
    }
}

void LeapfrogFrame::end(const model::SheaveForces& chain) {
    const model::ChainLayout& at = w_.layout();
    const int begin = at.pulley_begin(), half = at.pulley_size;
    close_evaluation(w_, w_.step.time + 0.5 * w_.step.h, w_.pulleys.tail.data(), chain, w_.slopes[2]);
    for (int k = begin + half; k < at.size(); ++k) w_.states[1][k] = w_.states[0][k] + w_.step.h * w_.slopes[2][k];
    for (int k = begin; k < begin + half; ++k)
        w_.states[1][k] = w_.states[0][k] + 0.5 * w_.step.h * (w_.states[0][k + half] + w_.states[1][k + half]);
    static constexpr engine::Term end{1, 1.0};
    w_.step.row = {{&end, 1}, {}, -1, -1, 1.0};
}

void LeapfrogFrame::save(std::vector<double>& memory) const {
    memory.insert(memory.end(), {continues_ ? 1.0 : 0.0, length_});
    for (const model::SheaveMotion& s : w_.pulleys.sheaves)
        for (const double* velocity : velocities_of(s)) memory.push_back(*velocity);
    memory.insert(memory.end(), w_.end_slope, w_.end_slope + w_.layout().size());
}

std::span<const double> LeapfrogFrame::load(std::span<const double> memory) {
    const auto saved = pop_front(memory, 2);
    continues_ = saved[0] != 0.0;
    length_ = saved[1];
    for (model::SheaveMotion& s : w_.pulleys.sheaves)
        for (double* velocity : velocities_of(s)) *velocity = pop_front(memory, 1)[0];
    std::ranges::copy(pop_front(memory, static_cast<std::size_t>(w_.layout().size())), w_.end_slope);
    return memory;
}

}  // namespace cvtflow::tasks
