#include "model/rigid/rigid_stepper.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace cvtflow::model {

namespace {

/// Steps that differ by less, as a part of themselves, are of one length: they are differences of times, which are rounded.
constexpr double equal_steps = 1e-8;

template <class Values>
[[nodiscard]] double total(const Values& values) noexcept {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

/// What the pins keep from step to step: first and last of columns that follow each other.
constexpr Column kept[][2] = {{Column::x, Column::vbend_y},
                              {Column::stretch_damping_force, Column::bend_damping_force_across},
                              {Column::rolling_moment, Column::rolling_moment},
                              {Column::acceleration_x, Column::acceleration_bend_y},
                              {Column::plate_friction, Column::plate_slip_high},
                              {Column::joint_friction, Column::joint_slip},
                              {Column::tip_stiffness_front, Column::tip_loading_rear},
                              {Column::tip_moment, Column::tip_moment},
                              {Column::tip_force_z, Column::tip_force_z},
                              {Column::tip_force_slide, Column::tip_force_slide},
                              {Column::lengthening, Column::lengthening},
                              {Column::tip_normal, Column::tip_radial + (rigid_tips - 1)}};

}  // namespace

double RigidBalance::stored() const noexcept { return total(energy); }
double RigidBalance::losses() const noexcept { return total(lost); }
double RigidBalance::works() const noexcept { return total(worked); }

double residual(const RigidBalance& from, const RigidBalance& to) noexcept {
    return (to.stored() - from.stored()) - (to.works() - from.works()) + (to.losses() - from.losses());
}

RigidStepper::RigidStepper(const Variator& variator)
    : variator_(variator),
      model_(variator.chain().rigid()->model()),
      columns_(model_.columns()),
      tail_(static_cast<std::size_t>(variator.layout().pulley_block() + variator.layout().controls), 0.0),
      tail_slope_(tail_.size(), 0.0) {}

/// Friction of the velocities as they are stays in the columns, and the first step begins with it.
void RigidStepper::start(double t, const double* y) {
    const ChainLayout& at = model_.layout();
    time_ = t;
    lead_ = shift_ = 0.0;
    model_.read(y, columns_);
    std::copy_n(y + at.pulley_begin(), tail_.size(), tail_.begin());
    ledger_.fill(0.0);
    if (at.ledger) std::copy_n(y + at.ledger_begin(), ledger_.size(), ledger_.begin());
    evaluate(0.0);
    columns_.copy(Column::plate_friction, Column::plate_friction_before);
    columns_.copy(Column::plate_friction_moment, Column::plate_friction_moment_before);
    columns_.copy(Column::joint_friction, Column::joint_friction_before);
    tail_kinetic_ = tail_kinetic();
    kinetic_ = model_.kernels().kick(model_.coefficients(), 0.0, columns_) + tail_kinetic_;
    couple(coupling_rates());
    balance_ = total_ = {};
    balance_.energy = forces_.account.energy;
    balance_.energy[static_cast<std::size_t>(Energy::kinetic)] = kinetic_;
}

std::size_t RigidStepper::kicked_end() const noexcept {
    return tail_.size() - (model_.layout().hydraulic() ? static_cast<std::size_t>(hydraulic_unknowns) : 0);
}

void RigidStepper::step(double begin, double step) noexcept {
    if (std::abs(0.5 * step - lead_) > equal_steps * step) lead(0.5 * step);
    const int size = model_.layout().pulley_size;
    model_.kernels().drift(step, columns_);
    for (int k = 0; k < size; ++k) tail_[static_cast<std::size_t>(k)] += step * tail_[static_cast<std::size_t>(size + k)];
    for (std::size_t k = kicked_end(); k < tail_.size(); ++k) tail_[k] += step * tail_slope_[k];
    time_ = begin + step;
    evaluate(step);
    kick(step);
}

/// The share of the step behind that the mean of both steps' lengths leaves out, by the same forces.
void RigidStepper::lead(double time) noexcept {
    const double more = time - lead_;
    shift_ += (time * time - lead_ * lead_) * jerked();  // ½ v·M v' of velocities around t_n, with no work done
    model_.kernels().kick(model_.coefficients(), more, columns_);
    for (std::size_t k = static_cast<std::size_t>(model_.layout().pulley_size), end = kicked_end(); k < end; ++k)
        tail_[k] += more * tail_slope_[k];
    tail_kinetic_ = tail_kinetic();
    for (std::size_t k = 0; k < 2; ++k) {
        total_.far[k] += more * far_power_[k];
        total_.twisted[k] += more * twist_power_[k];
    }
    for (std::size_t k = 0; k < loss_kinds; ++k) total_.lost[k] += more * forces_.account.loss[k];
    if (model_.layout().pulley_size != 0) {
        const WorkRates power = variator_.pulleys().works(tail_.data(), inputs_);
        for (std::size_t k = 0; k < work_kinds; ++k) total_.worked[k] += more * power[k];
        total_.impulse[0] += more * inputs_.drive_torque;
        total_.impulse[1] += more * inputs_.load_torque;
    }
    lead_ = time;
}

void RigidStepper::evaluate(double kick) noexcept {
    const PulleyModel& pulleys = variator_.pulleys();
    const bool alone = model_.layout().pulley_size == 0;
    SheaveMotion sheaves[4];
    if (!alone) pulleys.motions(tail_.data(), sheaves);
    if (kick > 0.0)
        model_.accelerate(alone ? nullptr : sheaves, {kick}, columns_, forces_);
    else
        model_.accelerate(alone ? nullptr : sheaves, columns_, forces_);
    if (alone) return;
    inputs_ = pulleys.inputs(time_, tail_.data());
    pulleys.slope(tail_.data(), inputs_, forces_.reaction.sheaves, tail_slope_.data(), &forces_.account);
    std::copy_n(inputs_.control_rate.begin(), model_.layout().controls, tail_slope_.begin() + model_.layout().pulley_block());
}

/// Half of it belongs to the step behind. Powers of a kick are those of the mean of the velocities before and after.
void RigidStepper::kick(double length) noexcept {
    const double before = tail_kinetic_, half = 0.5 * length;
    const std::array<double, 2> rates = coupling_rates();
    WorkRates power{};
    if (model_.layout().pulley_size != 0) power = variator_.pulleys().works(tail_.data(), inputs_);
    kinetic_ = model_.kernels().kick(model_.coefficients(), length, columns_);
    columns_.copy(Column::plate_friction, Column::plate_friction_before);
    columns_.copy(Column::plate_friction_moment, Column::plate_friction_moment_before);
    columns_.copy(Column::joint_friction, Column::joint_friction_before);
    for (std::size_t k = static_cast<std::size_t>(model_.layout().pulley_size), end = kicked_end(); k < end; ++k)
        tail_[k] += length * tail_slope_[k];
    tail_kinetic_ = tail_kinetic();
    kinetic_ += 0.5 * (before + tail_kinetic_);
    couple(rates);
    if (model_.layout().pulley_size != 0) {
        const WorkRates after = variator_.pulleys().works(tail_.data(), inputs_);
        for (std::size_t k = 0; k < work_kinds; ++k) power[k] = 0.5 * (power[k] + after[k]);
    }
    const auto book = [&](double share, RigidBalance& to) {
        for (std::size_t k = 0; k < loss_kinds; ++k) to.lost[k] = total_.lost[k] + share * forces_.account.loss[k];
        for (std::size_t k = 0; k < work_kinds; ++k) to.worked[k] = total_.worked[k] + share * power[k];
        to.impulse = {total_.impulse[0] + share * inputs_.drive_torque, total_.impulse[1] + share * inputs_.load_torque};
        for (std::size_t k = 0; k < 2; ++k) {
            to.far[k] = total_.far[k] + share * far_power_[k];
            to.twisted[k] = total_.twisted[k] + share * twist_power_[k];
        }
    };
    book(half, balance_);
    book(length, total_);
    balance_.energy = forces_.account.energy;
    balance_.energy[static_cast<std::size_t>(Energy::kinetic)] = kinetic_ + shift_;
    lead_ = half;
}

double RigidStepper::jerked() const noexcept {
    const RigidCoefficients& c = model_.coefficients();
    double sum = 0.0;
    for (int k = 0; k < rigid_coordinates; ++k) {
        const double *a = columns_[Column::acceleration_x + k], mass = c.inertia(k);
        for (int pin = 0; pin < c.pins; ++pin) sum += 0.5 * mass * a[pin] * a[pin];
    }
    return sum;
}

std::array<double, 2> RigidStepper::coupling_rates() const noexcept {
    const PulleyModel& pulleys = variator_.pulleys();
    std::array<double, 2> rates{};
    for (int shaft = 0; shaft < 2 && model_.layout().pulley_size != 0; ++shaft) {
        if (pulleys.coupled(shaft)) rates[static_cast<std::size_t>(shaft)] = pulleys.coupling(time_, tail_.data(), shaft).rate;
    }
    return rates;
}

void RigidStepper::couple(const std::array<double, 2>& rates) noexcept {
    const PulleyModel& pulleys = variator_.pulleys();
    const std::array<double, 2> torque{inputs_.drive_torque, inputs_.load_torque};
    far_power_ = twist_power_ = {};
    for (int shaft = 0; shaft < 2 && model_.layout().pulley_size != 0; ++shaft) {
        if (!pulleys.coupled(shaft)) continue;
        const std::size_t k = static_cast<std::size_t>(shaft);
        const CouplingState now = pulleys.coupling(time_, tail_.data(), shaft);
        far_power_[k] = torque[k] * pulleys.reference_speed(time_, shaft);
        twist_power_[k] = now.damping * rates[k] * 0.5 * (rates[k] + now.rate);  // the damper's torque is of the velocities before
    }
}

double RigidStepper::tail_kinetic() const noexcept {
    return model_.layout().pulley_size != 0 ? variator_.pulleys().kinetic(tail_.data()) : 0.0;
}

void RigidStepper::state(double* y) const noexcept {
    const ChainLayout& at = model_.layout();
    model_.write(columns_, y);
    for (int k = 0; k < rigid_coordinates; ++k) {
        const double* acceleration = columns_[Column::acceleration_x + k];
        double* v = y + at.link_size() + rigid_place(at, k);
        for (int pin = 0; pin < at.links; ++pin) v[at.link_begin(pin)] -= lead_ * acceleration[pin] / model_.scale(k);
    }
    tail_state(y + at.pulley_begin());
}

void RigidStepper::tail_state(double* tail) const noexcept {
    const ChainLayout& at = model_.layout();
    const std::size_t size = static_cast<std::size_t>(at.pulley_size);
    std::copy(tail_.begin(), tail_.end(), tail);
    for (std::size_t k = size, end = kicked_end(); k < end; ++k) tail[k] = tail_[k] - lead_ * tail_slope_[k];
    if (!at.ledger) return;
    double* ledger = tail + tail_.size();
    for (std::size_t k = 0; k < loss_kinds; ++k) ledger[k] = ledger_[k] + balance_.lost[k];
    for (std::size_t k = 0; k < work_kinds; ++k) ledger[loss_kinds + k] = ledger_[loss_kinds + k] + balance_.worked[k];
}

template <class Stepper, class Visitor>
void RigidStepper::visit(Stepper& s, const Visitor& visitor) {
    visitor(&s.time_, 1);
    visitor(&s.lead_, 1);
    visitor(&s.kinetic_, 1);
    visitor(&s.tail_kinetic_, 1);
    visitor(&s.shift_, 1);
    visitor(s.far_power_.data(), 2);
    visitor(s.twist_power_.data(), 2);
    visitor(s.tail_.data(), s.tail_.size());
    visitor(s.tail_slope_.data(), s.tail_slope_.size());
    visitor(s.ledger_.data(), s.ledger_.size());
    visitor(s.forces_.account.loss.data(), loss_kinds);
    visitor(&s.inputs_.drive_torque, 1);
    visitor(&s.inputs_.load_torque, 1);
    visitor(s.inputs_.clamping.data(), 2);
    for (auto* balance : {&s.balance_, &s.total_}) {
        visitor(balance->energy.data(), energy_kinds);
        visitor(balance->lost.data(), loss_kinds);
        visitor(balance->worked.data(), work_kinds);
        visitor(balance->impulse.data(), 2);
        visitor(balance->far.data(), 2);
        visitor(balance->twisted.data(), 2);
    }
    for (const auto& [first, last] : kept) {
        for (int c = static_cast<int>(first); c <= static_cast<int>(last); ++c)
            visitor(s.columns_[static_cast<Column>(c)], static_cast<std::size_t>(s.columns_.pins()));
    }
}

void RigidStepper::save(std::vector<double>& memory) const {
    memory.clear();
    visit(*this, [&](const double* numbers, std::size_t count) { memory.insert(memory.end(), numbers, numbers + count); });
}

void RigidStepper::load(std::span<const double> memory) {
    std::size_t size = 0;
    visit(*this, [&](const double*, std::size_t count) { size += count; });
    if (memory.size() != size) throw std::invalid_argument("what rigid pins remember is not all there");
    visit(*this, [&](double* numbers, std::size_t count) {
        std::copy_n(memory.begin(), count, numbers);
        memory = memory.subspan(count);
    });
    for (const auto& [first, last] : kept) columns_.wrap(first, last);
    std::fill_n(columns_[Column::written], columns_.pins(), 1.0);
}

}  // namespace cvtflow::model
