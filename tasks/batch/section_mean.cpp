#include "tasks/batch/section_mean.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "model/force/pulley_inputs.hpp"
#include "tasks/batch/start_states.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

namespace {

/// Time since a pin has crossed the middle between the shafts [s].
[[nodiscard]] double since_middle(const Workspace& w, const double* state, int pin) noexcept {
    const model::ChainLayout& at = w.layout();
    const double* q = state + at.link_begin(pin) + at.x(model::End::rear, 0);
    return (*q - 0.5 * w.parameters.pulley.centre_distance) / q[at.link_size()];
}

}  // namespace

void SectionMean::clear(int repeats) noexcept {
    repeats_ = repeats;
    pin_ = -1;
    next_ = repeats > 0 ? 0.0 : std::numeric_limits<double>::infinity();
    count_ = 0;
}

void SectionMean::add(double time, const Workspace& w) {
    const double period = w.pin_period();
    if (w.layout().pulley_size == 0 || !(period > 0.0)) {
        next_ = std::numeric_limits<double>::infinity();
        return;
    }
    const double* const state = w.state();
    const double back = pin_ < 0 ? period : since_middle(w, state, pin_);
    if (!(std::abs(back) < 0.1 * period)) return find(time, w);
    keep(time, back, w);
    const int next = w.layout().wrapped(pin_ + 1);
    pin_ = w.layout().wrapped(pin_ + (since_middle(w, state, next) < back ? repeats_ : -repeats_));
    next_ = time - back + repeats_ * period;
}

/// The pin of the upper strand that crosses its middle next.
void SectionMean::find(double time, const Workspace& w) noexcept {
    const double* state = w.state();
    const model::ChainLayout& at = w.layout();
    const double near = 2.0 * repeats_ * w.pin_period();
    double soonest = near;
    pin_ = -1;
    for (int pin = 0; pin < at.links; pin += repeats_) {
        const double until = -since_middle(w, state, pin);
        if (state[at.link_begin(pin) + at.y(model::End::rear, 0)] <= 0.0 || !(until > 0.0 && until < soonest)) continue;
        soonest = until;
        pin_ = pin;
    }
    next_ = time + (pin_ < 0 ? 0.25 * w.pin_period() : soonest);
}

/// @param back time since the section [s]
void SectionMean::keep(double time, double back, const Workspace& w) {
    const model::ChainLayout& at = w.layout();
    const auto size = static_cast<std::size_t>(at.size());
    const double* from = w.state();
    states_.resize(kept * size);
    double* const to = states_.data() + count_++ % kept * size;
    const auto move_back = [back](const double* block, int half, double* target) {
        for (int k = 0; k < half; ++k) target[k] = block[k] - back * block[half + k];
        std::copy(block + half, block + 2 * half, target + half);
    };
    phases_.resize(w.tips.phases.size());
    for (int link = 0; link < at.links; ++link) {
        const int source = at.wrapped(pin_ + link);
        move_back(from + at.link_begin(source), at.link_size(), to + at.link_begin(link));
        std::copy_n(w.tips.phases.begin() + model::tips_per_link * source, model::tips_per_link,
                    phases_.begin() + model::tips_per_link * link);
    }
    move_back(from + at.pulley_begin(), at.pulley_size, to + at.pulley_begin());
    std::copy(from + at.control_begin(), from + at.size(), to + at.control_begin());
    turn_shaft(to, w.parameters, 0, -w.parameters.drive.speed.integral(time - back));
}

bool SectionMean::put(engine::SavedState& saved, const model::ChainLayout& at) const {
    const std::size_t size = static_cast<std::size_t>(at.size()), mean = static_cast<std::size_t>(at.control_begin());
    const std::size_t sections = std::min(count_, kept);
    if (sections == 0 || saved.state.size() != size) return false;
    std::fill_n(saved.state.begin(), mean, 0.0);
    for (std::size_t section = 0; section < sections; ++section) {
        const double* of = states_.data() + section * size;
        for (std::size_t k = 0; k < mean; ++k) saved.state[k] += of[k] / static_cast<double>(sections);
    }
    std::ranges::transform(phases_, saved.phases.begin(), [](model::Phase phase) { return static_cast<std::uint8_t>(phase); });
    return true;
}

}  // namespace cvtflow::tasks
