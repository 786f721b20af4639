#include "tasks/step/control/energy_ledger.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "engine/base/hash.hpp"
#include "model/variator/variator.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

namespace {

// DECISIONS 74 states the residuals of accurate and of wrong runs; the test Lottery counts them on random machines.
constexpr double share_of_losses = 1e-3;
constexpr double share_of_energy_in = 1e-5;
constexpr double share_of_stored = 1e-6;
constexpr double deviations = 6.0;
/// Noise explains no more than this share of what was dissipated: a run that blows up, or begins with a shock, produces noise itself. With
/// inputs that of spans of 10 ms and longer; shorter ones are noisier, as one over the root of the span. A ring's losses are so small
/// beside what it stores that noise is all that its balance shows.
constexpr double noise_share_with_inputs = 0.009, noise_share_without = 0.5, noise_span = 10e-3;  // [1], [1], [s]
constexpr double dense_share = 0.05;                                                              // [1]
constexpr double min_samples = 10.0;

[[nodiscard]] double total(const auto& values) noexcept { return std::accumulate(values.begin(), values.end(), 0.0); }

[[nodiscard]] model::Inputs mean_of(const model::Inputs& a, const model::Inputs& b) noexcept {
    model::Inputs mean;
    mean.drive_torque = 0.5 * (a.drive_torque + b.drive_torque);
    mean.load_torque = 0.5 * (a.load_torque + b.load_torque);
    for (std::size_t k = 0; k < 2; ++k) mean.clamping[k] = 0.5 * (a.clamping[k] + b.clamping[k]);
    for (std::size_t k = 0; k < 2; ++k) mean.drag[k] = 0.5 * (a.drag[k] + b.drag[k]);
    return mean;
}

/// Residual that noise of samples may explain, over the losses. A start that settles begins with a shock, which does not count.
[[nodiscard]] double noise_share(const EnergyBalance& balance, bool settling) noexcept {
    if (settling || balance.energy_in <= 0.0) return noise_share_without;
    return std::min(noise_share_with_inputs * std::sqrt(std::max(1.0, noise_span / balance.span)), noise_share_without);
}

}  // namespace

double EnergyBalance::relative() const noexcept { return loss > 0.0 ? std::abs(residual()) / loss : 0.0; }

double EnergyBalance::expected_residual() const noexcept {
    return share_of_losses * loss + share_of_energy_in * energy_in + share_of_stored * stored;
}

double EnergyBalance::balance_error_ratio(bool settling) const noexcept {
    if (samples < min_samples) return 0.0;
    const double tolerance = expected_residual() + std::min(deviations * deviation, noise_share(*this, settling) * loss);
    const double ratio = std::abs(residual()) / tolerance;
    return std::isnan(ratio) ? std::numeric_limits<double>::infinity() : ratio;
}

void EnergyLedger::restart(long stride) noexcept {
    m_ = {};
    known_ = false;
    stride_ = static_cast<double>(stride);
}

void EnergyLedger::step(const model::Variator& variator, double begin, const double* from, double end, const double* to) noexcept {
    const model::ChainLayout& at = variator.layout();
    m_.steps += 1.0;
    if (counted_) {
        m_.inputs = account_;
        return;
    }
    if (at.pulley_size == 0 || !on_) return;
    const model::PulleyModel& pulleys = variator.pulleys();
    const auto inputs = [&](double t, const double* tail) { return pulleys.inputs().at(t, tail); };
    if (!known_) inputs_ = inputs(begin, from);
    const model::Inputs after = inputs(end, to);
    const model::Inputs mean = mean_of(inputs_, after);
    m_.inputs.add(pulleys, begin, from, end, to, mean);
    inputs_ = after;
    known_ = true;
}

/// A torque k u + c u' that is linear over the step does the work ½k(u₁² - u₀²) + c (u₀' + u₁')/2 (u₁ - u₀) on a twist u: the first part is
/// stored, the second one lost.
void InputWorks::add(const model::PulleyModel& pulleys, double begin, const double* from, double end, const double* to,
                     const model::Inputs& mean) noexcept {
    const model::WorkRates done = model::input_work(pulleys.coordinates(), from, to, mean);
    for (std::size_t k = 0; k < done.size(); ++k) work[k] += done[k];
    const std::array<double, 2> torque{mean.drive_torque, mean.load_torque};
    for (int shaft = 0; shaft < 2; ++shaft) {
        const auto k = static_cast<std::size_t>(shaft);
        impulse[k] += (end - begin) * torque[k];
        drag.impulse[k] += (end - begin) * mean.drag[k];
        drag.energy[k] += mean.drag[k] * (to[pulleys.coordinates().rotation(shaft)] - from[pulleys.coordinates().rotation(shaft)]);
        if (!pulleys.torques().coupled(shaft)) continue;
        const model::CouplingState before = pulleys.torques().coupling(begin, from, shaft),
                                   after = pulleys.torques().coupling(end, to, shaft);
        couplings.work[k] += torque[k] * (pulleys.torques().reference_angle(end, shaft) - pulleys.torques().reference_angle(begin, shaft));
        couplings.dissipated[k] += 0.5 * after.damping * (before.rate + after.rate) * (after.twist - before.twist);
    }
}

void EnergyLedger::inputs_changed(double time, bool densely) noexcept {
    known_ = false;
    if (densely && m_.samples > 0.0 && time - m_.jumped > window) m_.jumped = time;
}

bool EnergyLedger::due(double time, double to_output) const noexcept {
    if (!on_) return false;
    if (m_.samples == 0.0) return true;
    if (!(time > m_.sampled)) return false;  // a step may be cut at its start
    const double since = time - m_.jumped;   // what follows a jump dies out fast at first: samples lie as close as it is young
    if (since < dense_time && m_.steps >= 1.0 && time - m_.sampled >= dense_share * since) return true;
    if (counted_ || 2.0 * to_output >= stride()) return m_.steps >= stride();
    return to_output == 0.0 && 2.0 * m_.steps >= stride();
}

void EnergyLedger::sample(double time, const model::Account& links, const model::Account& pulleys, double pin_period) noexcept {
    model::Account now = links;
    for (std::size_t k = 0; k < now.loss.size(); ++k) now.loss[k] += pulleys.loss[k];
    const double spacing = time - m_.sampled, power = total(now.loss);
    m_.stored = total(links.energy) + total(pulleys.energy);
    m_.max_stored = std::max(m_.max_stored, total(links.energy));
    m_.pin_period = pin_period;
    if (m_.samples > 0.0) {
        for (std::size_t k = 0; k < now.loss.size(); ++k) m_.loss[k] += 0.5 * spacing * (m_.power[k] + now.loss[k]);
        for (std::size_t k = 0; k < m_.inputs.work.size(); ++k) m_.energy_in += std::max(0.0, m_.inputs.work[k] - m_.work_sampled[k]);
    }
    m_.add_noise(power, spacing);
    m_.power = now.loss;
    m_.close_sample(time, window);
}

/// Fourth differences hold what the trapezoidal rule cannot see, 70 times for noise without memory, and little of what passes smoothly.
void EnergyLedger::Memory::add_noise(double now, double spacing) noexcept {
    auto& p = powers;
    if (samples > 3.0) {
        const double fourth = now - 4.0 * p[0] + 6.0 * p[1] - 4.0 * p[2] + p[3];
        noise += fourth * fourth / 70.0 * spacing * spacing;
    }
    p = {now, p[0], p[1], p[2]};
}

/// Adds counted energies. Their only noise is the shock of a start, which steps do not resolve.
void EnergyLedger::sample_counted(double time, double pin_period) noexcept {
    m_.pin_period = pin_period;
    if (!on_ || !counted_ || (m_.samples > 0.0 && time <= m_.sampled)) return;
    const double spacing = time - m_.sampled;
    for (std::size_t k = 0; k < account_.lost.size() && m_.samples > 0.0; ++k) m_.power[k] = (account_.lost[k] - m_.loss[k]) / spacing;
    m_.loss = account_.lost;
    if (time < 0.0) m_.add_noise(total(m_.power), spacing);
    m_.inputs = account_;
    for (std::size_t k = 0; k < m_.inputs.work.size(); ++k) m_.energy_in += std::max(0.0, m_.inputs.work[k] - m_.work_sampled[k]);
    m_.stored = account_.stored;
    m_.max_stored = std::max(m_.max_stored, m_.stored);
    m_.close_sample(time, std::clamp(pin_period, window, longest_window));
}

void EnergyLedger::Memory::close_sample(double time, double length) noexcept {
    sampled = time;
    work_sampled = inputs.work;
    samples += 1.0;
    steps = 0.0;
    if (samples == 1.0) {
        jumped = time;
        judged_from = time < 0.0 ? 0.5 * time : time;
        all = part = here();
    }
    if (time - part.begin >= length) close_window();
}

/// A residual that noise can explain is evaluated again; one that it cannot explain is kept.
void EnergyLedger::Memory::close_window() noexcept {
    const EnergyBalance closed = balance_since(part);
    if (const JudgedBalance now = judge(part); part.begin >= judged_from && now.ratio > worst.ratio) worst = now;
    dense_sampling = std::abs(closed.residual()) > closed.expected_residual() ? 1.0 : 0.0;
    part = here();
}

EnergyMark EnergyLedger::Memory::here() const noexcept {
    return {sampled, total(loss), total(work_sampled), stored, energy_in, noise, samples};
}

EnergyBalance EnergyLedger::Memory::balance_since(const EnergyMark& span) const noexcept {
    const EnergyMark now = here();
    return {now.begin - span.begin,
            now.stored - span.stored,
            now.work - span.work,
            now.loss - span.loss,
            now.energy_in - span.energy_in,
            max_stored,
            std::sqrt(std::max(0.0, now.noise - span.noise)),
            now.samples - span.samples};
}

JudgedBalance EnergyLedger::judged(const std::optional<EnergyMark>& from) const noexcept {
    JudgedBalance most = m_.worst;
    for (const EnergyMark& span : {from.value_or(m_.all), m_.part}) {
        if (const JudgedBalance now = m_.judge(span); now.ratio > most.ratio) most = now;
    }
    return most;
}

JudgedBalance EnergyLedger::Memory::judge(const EnergyMark& span) const noexcept {
    const EnergyBalance balance = balance_since(span);
    return {balance.balance_error_ratio(span.begin < 0.0), span.begin, sampled, balance.relative(), balance.loss};
}

EnergySums EnergyLedger::sums(double time) const noexcept {
    EnergySums now{time, m_.loss, m_.inputs.work, m_.inputs.drag.energy};
    if (m_.samples == 0.0) return now;
    for (std::size_t k = 0; k < now.loss.size(); ++k) now.loss[k] += (time - m_.sampled) * m_.power[k];
    return now;
}

void EnergyLedger::output(double time, const std::array<double, 2>& momentum) noexcept {
    sample_counted(time, m_.pin_period);
    if (m_.outputs > 0.0) m_.chain_torque = m_.torque_since_output(time, momentum);
    m_.impulse_output = m_.inputs.net_impulse();
    m_.momentum_output = momentum;
    m_.output_time = time;
    m_.outputs += 1.0;
    m_.past.remember(sums(time), m_.pin_period);
}

std::array<double, 2> EnergyLedger::Memory::torque_since_output(double time, const std::array<double, 2>& momentum) const noexcept {
    std::array<double, 2> torque{};
    for (std::size_t k = 0; k < 2; ++k) {
        const double gained = momentum[k] - momentum_output[k], given = inputs.net_impulse()[k] - impulse_output[k];
        torque[k] = (gained - given) / (time - output_time);
    }
    return torque;
}

std::array<double, 2> EnergyLedger::chain_torque(double time, const std::array<double, 2>& momentum) const noexcept {
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    if (m_.outputs > 0.0 && time > m_.output_time) return m_.torque_since_output(time, momentum);
    return m_.outputs > 1.0 ? m_.chain_torque : std::array{unknown, unknown};
}

std::size_t PastSums::place(double number) const noexcept { return static_cast<std::size_t>(std::fmod(begin_ + number, max_count)); }

void PastSums::remember(const EnergySums& now, double pin_period) noexcept {
    const double forgotten = period_begin(now.time, pin_period);
    begin_ = std::fmod(begin_ + forgotten, max_count);
    count_ -= forgotten;
    const bool crowded = count_ > 0.0 && now.time - sums_[place(count_ - 1.0)].time < pin_period / static_cast<double>(per_period);
    if (crowded || count_ >= static_cast<double>(max_count)) return;
    sums_[place(count_)] = now;
    count_ += 1.0;
}

double PastSums::outputs_before(double time) const noexcept {
    return count_ > 0.0 && sums_[place(count_ - 1.0)].time >= time ? count_ - 1.0 : count_;
}

double PastSums::period_begin(double time, double pin_period) const noexcept {
    const double count = outputs_before(time);
    double first = 0.0;
    while (first + 1.0 < count && time - sums_[place(first + 1.0)].time >= pin_period) first += 1.0;
    return first;
}

std::optional<EnergySums> PastSums::before(double time, double pin_period) const noexcept {
    const double count = outputs_before(time);
    if (count == 0.0) return std::nullopt;
    const double number = period_begin(time, pin_period), start = time - pin_period;
    const EnergySums& first = sums_[place(number)];
    return number + 1.0 < count && first.time < start ? EnergySums::between(first, sums_[place(number + 1.0)], start) : first;
}

void PastSums::visit(engine::Archive& archive) {
    archive("past: time, loss, work", sums_), archive("past_begin", begin_), archive("past_count", count_);
    const auto whole = [](double number, std::size_t most) {
        return number >= 0.0 && number <= static_cast<double>(most) && number == std::floor(number);
    };
    if (!whole(begin_, max_count - 1) || !whole(count_, max_count)) archive.refuse("past_count");
}

void EnergyLedger::visit(engine::Archive& field) {
    Memory& m = m_;
    field("samples", m.samples), field("sampled", m.sampled), field("steps", m.steps), field("jumped", m.jumped);
    field("power", m.power), field("loss", m.loss), field("powers", m.powers);
    field("stored", m.stored), field("max_stored", m.max_stored), field("noise", m.noise), field("through", m.energy_in);
    field("pin_period", m.pin_period);
    field("work", m.inputs.work), field("work_sampled", m.work_sampled);
    field("impulse", m.inputs.impulse), field("drag: energy, impulse", m.inputs.drag);
    field("impulse_output", m.impulse_output), field("momentum_output", m.momentum_output);
    field("chain_torque", m.chain_torque), field("couplings: work, dissipated", m.inputs.couplings);
    field("outputs", m.outputs), field("output_time", m.output_time);
    field("all: begin, loss, work, stored, through, noise, samples", m.all), field("part", m.part);
    field("worst: ratio, begin, end, relative, loss", m.worst), field("doubt", m.dense_sampling), field("judged_from", m.judged_from);
    m.past.visit(field);
}

double EnergySums::lost() const noexcept { return std::accumulate(loss.begin(), loss.end(), 0.0); }

EnergySums EnergySums::between(const EnergySums& from, const EnergySums& to, double time) noexcept {
    const double share = (time - from.time) / (to.time - from.time);
    EnergySums at = from;
    at.time = time;
    for (std::size_t k = 0; k < at.loss.size(); ++k) at.loss[k] += share * (to.loss[k] - from.loss[k]);
    for (std::size_t k = 0; k < at.work.size(); ++k) at.work[k] += share * (to.work[k] - from.work[k]);
    for (std::size_t k = 0; k < at.drag.size(); ++k) at.drag[k] += share * (to.drag[k] - from.drag[k]);
    return at;
}

EnergyFlow EnergySums::since(const EnergySums& before) const noexcept {
    const auto done = [&](model::Work by) { return work[static_cast<std::size_t>(by)] - before.work[static_cast<std::size_t>(by)]; };
    return {lost() - before.lost(), done(model::Work::clamping), {done(model::Work::drive), done(model::Work::load)}};
}

EnergyFlow EnergySums::outside_since(const EnergySums& before) const noexcept {
    EnergyFlow flow = since(before);
    for (std::size_t shaft = 0; shaft < drag.size(); ++shaft) {
        const double taken = drag[shaft] - before.drag[shaft];
        flow.shaft[shaft] += taken;
        flow.lost += taken;
    }
    return flow;
}

EnergyFlow EnergyFlow::with_pump(double work, double loss) const noexcept {
    return work > 0.0 ? EnergyFlow{lost + loss, work, shaft} : *this;
}

double EnergyFlow::input() const noexcept { return std::max(0.0, clamping) + std::max(0.0, shaft[0]) + std::max(0.0, shaft[1]); }

double EnergyFlow::taken() const noexcept { return std::max(0.0, -shaft[0]) + std::max(0.0, -shaft[1]); }

bool EnergyFlow::no_load() const noexcept {
    constexpr double min_load = 0.01;
    return taken() < min_load * input();
}

double EnergyFlow::efficiency() const noexcept {
    const bool flows = input() > 0.0 && !no_load() && lost <= input();
    return flows ? 1.0 - lost / input() : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace cvtflow::tasks
