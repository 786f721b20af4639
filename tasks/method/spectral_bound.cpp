#include "tasks/method/spectral_bound.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "model/basis/portable_math.hpp"
#include "model/rigid/rigid_chain.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

namespace {

constexpr int cold_iterations = 150, warm_iterations = 15;
constexpr double converged = 3e-4;  ///< relative change of the estimate
constexpr int least_budget = 2;     ///< evaluations of an iteration: of the state, and of the moved one

/// Whether place k in the block of a rigid pin is x, y, p or q, in that of a link x or y.
[[nodiscard]] bool moves_in_waves(const model::ChainLayout& at, int k) noexcept {
    if (!at.rigid) return k < at.z(model::End::rear);
    for (const int wave : {0, 1, 3, 4}) {
        if (k == model::rigid_place(at, wave)) return true;
    }
    return false;
}

/// A direction with something of every mode; the same everywhere.
double seed(int index) { return model::portable_sin(1.0 + 2.399963 * index) + 0.3 * ((index % 2 == 0) ? 1.0 : -1.0); }

}  // namespace

SpectralMemory::SpectralMemory(const model::ChainLayout& layout)
    : rest_phases(static_cast<std::size_t>(model::tips_per_link * layout.links)), scratch(layout) {
    for (auto* field : {&base, &moved, &slope, &rest}) field->assign(static_cast<std::size_t>(layout.size()), 0.0);
}

SpectralBound::SpectralBound(const model::Variator& variator, MovedPart part, std::shared_ptr<SpectralMemory> memory,
                             std::shared_ptr<const model::HeldLinks> held)
    : variator_(variator),
      part_(part),
      memory_(memory != nullptr ? std::move(memory) : std::make_shared<SpectralMemory>(variator.layout())),
      held_(std::move(held)) {
    for (auto* field : {&velocity_.direction, &coordinate_.direction})
        field->assign(static_cast<std::size_t>(variator.layout().size()), 0.0);
    velocity_.size = 1e-9;
    coordinate_.size = 1e-11;
}

double SpectralBound::imaginary() const noexcept { return std::sqrt(coordinate_.found); }

void SpectralBound::take(double step, bool damped) noexcept {
    step_ = step;
    damping_weight_ = damped ? 4.0 / step : 0.0;
    if (held_ != nullptr) inverse_ = held_->inverse(step);
}

/// Calls action(coordinate's index, velocity's index) for what is moved.
template <class Action>
void SpectralBound::for_each_unknown(Action action) const noexcept {
    const model::ChainLayout& at = variator_.layout();
    const bool pulleys = part_ == MovedPart::all || part_ == MovedPart::pulleys || part_ == MovedPart::all_but_waves;
    const bool whole_links = part_ == MovedPart::all, waves = part_ == MovedPart::waves;
    for (int link = 0; link < at.links && part_ != MovedPart::pulleys; ++link) {
        for (int k = 0; k < at.link_size(); ++k) {
            if (whole_links || moves_in_waves(at, k) == waves) action(at.link_begin(link) + k, at.link_begin(link) + at.link_size() + k);
        }
    }
    for (int k = 0; k < at.pulley_size && pulleys; ++k) action(at.pulley_begin() + k, at.pulley_begin() + at.pulley_size + k);
}

int SpectralBound::iterate(Iteration& iteration, bool of_velocities, double t, const double* state, const model::Phase* phases,
                           int budget) noexcept {
    std::vector<double>& direction = iteration.direction;
    const model::ChainLayout& layout = variator_.layout();
    const int held_links = held_ != nullptr && !of_velocities ? layout.links : 0;
    const int most = cold_ ? cold_iterations : warm_iterations;
    int evaluations = 0;
    bool settled = false;
    while (!settled && iteration.taken < most && evaluations < budget) {
        double largest = 0.0;
        for (const double entry : direction) largest = std::max(largest, std::abs(entry));
        if (!(largest > 0.0)) break;
        const double scale = iteration.size / largest;
        double before = 0.0, after = 0.0;
        for (std::size_t k = 0; k < direction.size(); ++k) {
            memory_->moved[k] = state[k] + scale * direction[k];
            before += (memory_->moved[k] - state[k]) * (memory_->moved[k] - state[k]);
        }
        if (!of_velocities && damping_weight_ > 0.0)
            for_each_unknown([&](int q, int v) { memory_->moved[at(v)] += damping_weight_ * (memory_->moved[at(q)] - state[q]); });
        model::right_hand_side(variator_, t, memory_->moved.data(), phases, memory_->slope.data(), memory_->scratch);
        ++evaluations;
        ++iteration.taken;
        for_each_unknown([&](int q, int v) {
            const auto acceleration = static_cast<std::size_t>(v);
            const double change = memory_->slope[acceleration] - memory_->base[acceleration];
            direction[of_velocities ? acceleration : static_cast<std::size_t>(q)] = change;
        });
        for (int link = 0, q = 0; link < held_links; ++link, q = layout.link_begin(link))
            held_->hold(inverse_, state + q, &direction[at(q)]);
        for (const double change : direction) after += change * change;
        const double value = std::sqrt(after / before);
        settled = std::abs(value - iteration.value) < converged * value;
        iteration.value = value;
    }
    if (settled || iteration.taken == most || evaluations < budget) iteration.taken = 0;
    return evaluations;
}

/// Takes a complete estimate into use.
void SpectralBound::publish() noexcept {
    for (Iteration* each : {&velocity_, &coordinate_}) each->found = each->value;
    cold_ = velocity_complete_ = false;
}

void SpectralBound::begin() noexcept {
    if (!cold_) return;
    for_each_unknown([&](int q, int v) {
        coordinate_.direction[static_cast<std::size_t>(q)] = seed(q);
        velocity_.direction[static_cast<std::size_t>(v)] = seed(v);
    });
}

int SpectralBound::iterate_at_rest(double t, const double* state, const model::Phase* phases, int budget) noexcept {
    auto& [base, moved, slope, rest, rest_phases, scratch] = *memory_;
    std::copy_n(state, rest.size(), rest.begin());
    const model::ChainLayout& at = variator_.layout();
    for (int link = 0; link < at.links; ++link) std::fill_n(rest.begin() + at.link_begin(link) + at.link_size(), at.link_size(), 0.0);
    std::fill_n(rest.begin() + at.pulley_begin() + at.pulley_size, at.pulley_size, 0.0);
    std::transform(phases, phases + rest_phases.size(), rest_phases.begin(),
                   [](model::Phase phase) { return phase == model::Phase::slip ? model::Phase::stick : phase; });
    model::right_hand_side(variator_, t, rest.data(), rest_phases.data(), base.data(), scratch);
    return 1 + iterate(velocity_, true, t, rest.data(), rest_phases.data(), budget - 1);
}

int SpectralBound::estimate_at_rest(double t, const double* state, const model::Phase* phases, int budget) noexcept {
    if (complete()) begin();
    int evaluations = 0;
    if (!velocity_complete_) {
        evaluations = iterate_at_rest(t, state, phases, budget);
        velocity_complete_ = velocity_.taken == 0;
        if (!velocity_complete_ || budget - evaluations < least_budget) return evaluations;
    }
    return evaluations + estimate_oscillation(t, state, phases, budget - evaluations);
}

int SpectralBound::estimate_oscillation(double t, const double* state, const model::Phase* phases, int budget) noexcept {
    if (complete()) begin();
    model::right_hand_side(variator_, t, state, phases, memory_->base.data(), memory_->scratch);
    const int evaluations = 1 + iterate(coordinate_, false, t, state, phases, budget - 1);
    if (coordinate_.taken == 0) publish();
    return evaluations;
}

int SpectralBound::estimate(double t, const double* state, const model::Phase* phases) noexcept {
    begin();
    model::right_hand_side(variator_, t, state, phases, memory_->base.data(), memory_->scratch);
    const int evaluations =
        1 + iterate(velocity_, true, t, state, phases, unlimited) + iterate(coordinate_, false, t, state, phases, unlimited);
    publish();
    return evaluations;
}

void SpectralBound::visit(engine::Archive& archive) {
    archive("spectrum_cold", cold_), archive("velocity_complete", velocity_complete_);
    for (Iteration* each : {&velocity_, &coordinate_}) {
        archive("spectrum_value", each->value), archive("spectrum_size", each->size), archive("spectrum_found", each->found);
        archive("spectrum_taken", each->taken, 0, cold_iterations);
        archive("spectrum_direction", std::span(each->direction));
    }
}

}  // namespace cvtflow::tasks
