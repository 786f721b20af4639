#include "model/variator/rigid/rigid_stepper.hpp"

#include <algorithm>
#include <numeric>

namespace cvtflow::model {

namespace {

template <class Values>
[[nodiscard]] double total(const Values& values) noexcept {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

}  // namespace

double RigidBalance::stored() const noexcept { return total(energy); }
double RigidBalance::losses() const noexcept { return total(lost); }
double RigidBalance::works() const noexcept { return total(worked); }

double residual(const RigidBalance& from, const RigidBalance& to) noexcept {
    return (to.stored() - from.stored()) - (to.works() - from.works()) + (to.losses() - from.losses());
}

RigidStepper::RigidStepper(const RigidModel& model, double step)
    : model_(model),
      step_(step),
      columns_(model.columns()),
      tail_(static_cast<std::size_t>(model.layout().tail()), 0.0),
      tail_slope_(tail_.size(), 0.0) {}

void RigidStepper::start(double t, const double* y) {
    const RigidLayout& at = model_.layout();
    start_ = t;
    steps_ = 0;
    columns_ = model_.columns();
    std::vector<double> now(y, y + at.size()), slope(now.size(), 0.0);
    model_.slope(t, y, slope.data(), columns_, forces_);  // leaves friction in the columns, which the first step begins with
    for (int k = 0; k < rigid_coordinates * at.pins; ++k)
        now[static_cast<std::size_t>(at.velocity(0) + k)] -= 0.5 * step_ * slope[static_cast<std::size_t>(at.velocity(0) + k)];
    for (int k = at.pulley_begin() + at.pulley_size; k < at.control_begin(); ++k)
        now[static_cast<std::size_t>(k)] -= 0.5 * step_ * slope[static_cast<std::size_t>(k)];
    model_.read(now.data(), columns_);
    columns_.copy(Column::rub, Column::rub_before);
    std::copy(now.begin() + at.pulley_begin(), now.end(), tail_.begin());
    kinetic_ = model_.kinetic(now.data());
    work_rate_ = {};
    balance_ = total_ = {};
}

void RigidStepper::step() noexcept {
    const RigidModel& model = model_;
    const RigidLayout& at = model.layout();
    const double kinetic_before = kinetic_;
    model.accelerate(time(), tail_.data(), {step_}, columns_, forces_);
    model.tail_slope(tail_.data(), forces_, tail_slope_.data());
    if (at.pulley_size != 0) work_rate_ = model.pulleys().works(tail_.data(), forces_.inputs);
    kinetic_ = model.kernels().advance(model.coefficients(), step_, columns_);
    columns_.copy(Column::rub, Column::rub_before);
    if (at.pulley_size != 0) advance_tail();
    keep_balance(kinetic_before);
    ++steps_;
}

void RigidStepper::advance_tail() noexcept {
    const std::size_t size = static_cast<std::size_t>(model_.layout().pulley_size);
    for (std::size_t k = 0; k < size; ++k) {
        tail_[size + k] += step_ * tail_slope_[size + k];
        tail_[k] += step_ * tail_[size + k];
    }
    for (std::size_t k = 2 * size; k < tail_.size(); ++k) tail_[k] += step_ * tail_slope_[k];
    const WorkRates after = model_.pulleys().works(tail_.data(), forces_.inputs);
    for (std::size_t k = 0; k < work_kinds; ++k) work_rate_[k] = 0.5 * (work_rate_[k] + after[k]);
    kinetic_ += model_.pulleys().kinetic(tail_.data());
}

void RigidStepper::keep_balance(double kinetic_before) noexcept {
    const auto halfway = [this](double sum, double rate) { return sum + 0.5 * step_ * rate; };
    balance_.time = time();
    balance_.energy = forces_.account.energy;
    balance_.energy[static_cast<std::size_t>(Energy::kinetic)] = 0.5 * (kinetic_before + kinetic_);
    for (std::size_t k = 0; k < loss_kinds; ++k) {
        balance_.lost[k] = halfway(total_.lost[k], forces_.account.loss[k]);
        total_.lost[k] += step_ * forces_.account.loss[k];
    }
    for (std::size_t k = 0; k < work_kinds; ++k) {
        balance_.worked[k] = halfway(total_.worked[k], work_rate_[k]);
        total_.worked[k] += step_ * work_rate_[k];
    }
}

void RigidStepper::state(double* y) const noexcept {
    const RigidLayout& at = model_.layout();
    model_.write(columns_, y);
    for (int k = 0; k < rigid_coordinates; ++k) {
        const double* acceleration = columns_[Column::force_x + k];
        for (int pin = 0; pin < at.pins; ++pin) y[at.velocity(k) + pin] += 0.5 * step_ * acceleration[pin];
    }
    std::copy(tail_.begin(), tail_.end(), y + at.pulley_begin());
    for (int k = 0; k < at.pulley_size; ++k)
        y[at.pulley_begin() + at.pulley_size + k] += 0.5 * step_ * tail_slope_[static_cast<std::size_t>(at.pulley_size + k)];
}

}  // namespace cvtflow::model
