#include "tasks/method/friction/rigid_pulleys.hpp"

#include <algorithm>

namespace cvtflow::tasks {

void RigidPulleys::place() noexcept {
    if (!absent_) variator_.pulleys().motions(s_.tail.data(), sheaves_);
}

void RigidPulleys::drift(double step) noexcept {
    const auto size = static_cast<std::size_t>(variator_.layout().pulley_size);
    for (std::size_t k = 0; k < size; ++k) s_.tail[k] += step * s_.tail[size + k];
    for (std::size_t k = s_.kicked_end(); k < s_.tail.size(); ++k) s_.tail[k] += step * s_.tail_slope[k];
    place();
}

void RigidPulleys::start(double time) noexcept {
    evaluate(time);
    kinetic_ = mean_kinetic_ = kinetic_now();
    couple(time, coupling_rates(time));
}

void RigidPulleys::evaluate(double time) noexcept {
    if (absent_) return;
    const model::PulleyModel& pulleys = variator_.pulleys();
    inputs_ = pulleys.inputs(time, s_.tail.data());
    pulleys.slope(s_.tail.data(), inputs_, s_.forces.reaction.sheaves, s_.tail_slope.data(), &s_.forces.account);
    std::copy_n(inputs_.control_rate.begin(), variator_.layout().controls, s_.tail_slope.begin() + variator_.layout().pulley_block());
}

model::WorkRates RigidPulleys::kick(double time, double step) noexcept {
    evaluate(time);
    const std::array<double, 2> rates = coupling_rates(time);
    model::WorkRates power = works();
    const double before = kinetic_;
    kick_by_rates(step);
    mean_kinetic_ = 0.5 * (before + kinetic_);
    couple(time, rates);
    const model::WorkRates after = works();
    for (std::size_t k = 0; k < power.size(); ++k) power[k] = 0.5 * (power[k] + after[k]);
    return power;
}

void RigidPulleys::advance(double time) noexcept { kick_by_rates(time); }

void RigidPulleys::kick_by_rates(double time) noexcept {
    for (std::size_t k = static_cast<std::size_t>(variator_.layout().pulley_size), end = s_.kicked_end(); k < end; ++k)
        s_.tail[k] += time * s_.tail_slope[k];
    kinetic_ = kinetic_now();
}

std::array<double, 2> RigidPulleys::coupling_rates(double time) const noexcept {
    const model::PulleyModel& pulleys = variator_.pulleys();
    std::array<double, 2> rates{};
    for (std::size_t k = 0; k < 2 && !absent_; ++k) {
        const int shaft = static_cast<int>(k);
        if (pulleys.coupled(shaft)) rates[k] = pulleys.coupling(time, s_.tail.data(), shaft).rate;
    }
    return rates;
}

void RigidPulleys::couple(double time, const std::array<double, 2>& rates) noexcept {
    const model::PulleyModel& pulleys = variator_.pulleys();
    far_power_ = twist_power_ = {};
    for (std::size_t k = 0; k < 2 && !absent_; ++k) {
        const int shaft = static_cast<int>(k);
        if (!pulleys.coupled(shaft)) continue;
        const model::CouplingState now = pulleys.coupling(time, s_.tail.data(), shaft);
        far_power_[k] = torque()[k] * pulleys.reference_speed(time, shaft);
        twist_power_[k] = now.damping * rates[k] * 0.5 * (rates[k] + now.rate);  // the damper's torque is of the velocities before
    }
}

double RigidPulleys::kinetic_now() const noexcept { return absent_ ? 0.0 : variator_.pulleys().kinetic(s_.tail.data()); }

model::WorkRates RigidPulleys::works() const noexcept {
    return absent_ ? model::WorkRates{} : variator_.pulleys().works(s_.tail.data(), inputs_);
}

}  // namespace cvtflow::tasks
