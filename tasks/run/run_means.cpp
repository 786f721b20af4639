#include "tasks/run/run_means.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "tasks/step/method_memory.hpp"

namespace cvtflow::tasks {

namespace {

constexpr double gross_slip = 0.03;  ///< creep of a holding chain stays below a hundredth, a sliding one is beyond
constexpr double often = 0.05;       ///< share of outputs
constexpr double drifts_ratio = 0.01, drifts_slip = 0.2, min_slip = 5e-4;
constexpr double standing_speed = 0.1;   ///< of shafts, 5 mm/s at the chain: of the order of the speeds at which tips creep [rad/s]
constexpr double resolved_share = 0.05;  ///< of the losses, that the balance may leave whatever they are
constexpr double min_load = 0.01;        ///< taken by shafts, of the input
constexpr double takes_energy = 0.02;    ///< of the input; 7e-4 over 11 pin periods of the settled baseline

constexpr NoteKind kinds[] = {
    {"gross_slip", "mean slip of the last fifth above 3 %"},
    {"control_limit", "a controller was at the limit of its authority at more than 5 % of the last fifth's outputs"},
    {"slack_strand", "the slack strand carried no tension at more than 5 % of the last fifth's outputs"},
    {"clamping_limit", "a clamping force was above wear.clamping_limit at the slip speed of an output"},
    {"efficiency", "efficiency of the whole run, or of its last fifth, outside 0 … 1"},
    {"unsteady",
     "the state changes: ratio of the first and the last fifth differ by more than 1 %, slip by more than a fifth of it, the stored "
     "energy by more than 2 % of the input; or it was seen for less than a pin period"},
    {"standstill", "the shafts turn by less than 0.1 rad/s: slip is noise"},
    {"no_load", "drive and load transfer less power than the machine loses: slip and efficiency are those of idling"},
    {"unresolved", "losses below the resolution of the energy balance: it would not show an error of 5 % in them"},
};

/// Absolute tolerance of a balance [J]; 0 if there are too few samples to judge it.
[[nodiscard]] double unresolved(EnergyBalance balance) noexcept {
    constexpr double min_samples = 10.0;
    balance.loss = 0.0;
    return balance.samples < min_samples ? 0.0 : balance.honest();
}

/// What inputs brought [J].
[[nodiscard]] double input(const EnergySums& before, const EnergySums& after) noexcept {
    double in = 0.0;
    for (std::size_t k = 0; k < after.work.size(); ++k) in += std::max(0.0, after.work[k] - before.work[k]);
    return in;
}

/// Change of the stored energy, by works and losses [J].
[[nodiscard]] double change_of_energy(const EnergySums& before, const EnergySums& after) noexcept {
    double change = before.lost() - after.lost();
    for (std::size_t k = 0; k < after.work.size(); ++k) change += after.work[k] - before.work[k];
    return change;
}

/// By the mean powers of the hydraulics, which change little within a pin period.
[[nodiscard]] double efficiency_with_pump(const SpanMeans& means, const EnergySums& before, const EnergySums& after) noexcept {
    if (means.hydraulics.pump == 0.0) return means.efficiency;
    const double lasted = after.time - before.time;
    return after.efficiency_since(before, means.hydraulics.pump * lasted, means.hydraulics.lost() * lasted);
}

}  // namespace

std::span<const NoteKind> note_kinds() noexcept { return kinds; }

void RunMeans::clear() noexcept {
    bins_.clear();
    per_bin_ = 1.0;
    pin_period_ = 0.0;
}

void RunMeans::add(const model::Observation& now, const EnergySums& sums, double pin_period) {
    if (bins_.empty() || bins_.back().outputs >= per_bin_) {
        if (bins_.size() == max_bins) halve();
        if (bins_.empty() || bins_.back().outputs >= per_bin_) bins_.emplace_back();
    }
    Bin& bin = bins_.back();
    bin.outputs += 1.0;
    bin.time = now.time;
    bin.ratio += now.ratio;
    bin.slip += now.slip;
    bin.tight += now.tight;
    bin.slack += now.slack;
    bin.limited += now.control_limited ? 1.0 : 0.0;
    bin.loose += now.slack <= 0.0 ? 1.0 : 0.0;
    bin.beyond += now.limit_use > 1.0 ? 1.0 : 0.0;
    bin.turning += 0.5 * (std::abs(now.speed[0]) + std::abs(now.speed[1]));
    bin.friction_slip += now.friction_slip;
    bin.creep += now.creep_power;
    bin.brought += std::max(0.0, now.work[0]) + std::max(0.0, now.work[1]);
    bin.energy = sums;
    bin.hydraulics = now.hydraulic_energy;
    pin_period_ = pin_period;
}

void RunMeans::Bin::add(const Bin& other) noexcept {
    outputs += other.outputs;
    ratio += other.ratio;
    slip += other.slip;
    tight += other.tight;
    slack += other.slack;
    limited += other.limited;
    loose += other.loose;
    beyond += other.beyond;
    turning += other.turning;
    friction_slip += other.friction_slip;
    creep += other.creep;
    brought += other.brought;
}

/// Twice as many outputs in each.
void RunMeans::halve() {
    for (std::size_t k = 0; 2 * k + 1 < bins_.size(); ++k) {
        Bin sum = bins_[2 * k + 1];
        sum.add(bins_[2 * k]);
        bins_[k] = sum;
    }
    bins_.resize(bins_.size() / 2);
    per_bin_ *= 2.0;
}

EnergySums RunMeans::energy_at(double time) const {
    const auto after = std::find_if(bins_.begin(), bins_.end(), [&](const Bin& bin) { return bin.energy.time >= time; });
    if (after == bins_.end()) return bins_.back().energy;
    if (after == bins_.begin()) return after->energy;
    return EnergySums::between((after - 1)->energy, after->energy, time);
}

SpanMeans RunMeans::span(double from, double to) const {
    SpanMeans means;
    if (bins_.empty()) return means;
    const auto size = static_cast<double>(bins_.size());
    const auto width = [&](double share) { return static_cast<std::size_t>(share * size); };
    const std::size_t begin = from == 0.0 ? 0 : bins_.size() - std::max<std::size_t>(1, width(1.0 - from)),
                      end = to == 1.0 ? bins_.size() : std::max<std::size_t>(1, width(to));
    Bin sum;
    for (std::size_t k = begin; k < end; ++k) sum.add(bins_[k]);
    means.ratio = sum.ratio / sum.outputs;
    means.slip = sum.slip / sum.outputs;
    means.friction_slip = sum.friction_slip / sum.outputs;
    means.loss_slip = sum.brought > 0.0 ? sum.creep / sum.brought : 0.0;
    means.tight = sum.tight / sum.outputs;
    means.slack = sum.slack / sum.outputs;
    means.limited = sum.limited / sum.outputs;
    means.loose = sum.loose / sum.outputs;
    means.beyond = sum.beyond / sum.outputs;
    means.turning = sum.turning / sum.outputs;
    means.begin = begin == 0 ? bins_.front().time : bins_[begin - 1].time;
    means.end = bins_[end - 1].time;
    means.periods = pin_period_ > 0.0 ? std::floor((means.end - means.begin) / pin_period_) : 0.0;
    if (means.periods == 0.0 && pin_period_ > 0.0 && means.end - bins_.front().time >= pin_period_)
        means.periods = 1.0;  // a fifth shorter than a period
    const EnergySums before = energy_at(means.periods > 0.0 ? means.end - means.periods * pin_period_ : means.begin);
    const EnergySums after = energy_at(means.end);
    const auto taken_out = [&](model::Work by) {  // by a shaft, not by a cylinder
        return std::max(0.0, before.work[static_cast<std::size_t>(by)] - after.work[static_cast<std::size_t>(by)]);
    };
    const double taken = taken_out(model::Work::drive) + taken_out(model::Work::load), lost = after.lost() - before.lost();
    const double in = input(before, after);
    means.no_load = in > 0.0 && taken < min_load * in;
    means.efficiency = means.no_load ? std::numeric_limits<double>::quiet_NaN() : after.efficiency_since(before);
    means.hydraulics = model::mean_powers(bins_[begin == 0 ? 0 : begin - 1].hydraulics, bins_[end - 1].hydraulics, means.end - means.begin);
    means.with_pump = means.no_load ? means.efficiency : efficiency_with_pump(means, before, after);
    means.carried = lost > 0.0 ? taken / lost : 0.0;
    means.stored = in > 0.0 ? change_of_energy(before, after) / in : 0.0;
    return means;
}

RunMeans::Change RunMeans::change() const {
    const SpanMeans whole = all(), first = first_fifth(), last = last_fifth();
    const bool ratio_drifts = std::abs(last.ratio - first.ratio) > drifts_ratio * std::abs(whole.ratio);
    const bool slip_drifts = std::abs(last.slip - first.slip) > drifts_slip * std::abs(whole.slip) + min_slip;
    if (ratio_drifts || slip_drifts) return Change::drift;
    if (pin_period_ > 0.0 && whole.periods < 1.0) return Change::brief;
    return std::abs(whole.stored) > takes_energy ? Change::energy : Change::none;
}

std::string RunMeans::text_of(Change change) const {
    const SpanMeans whole = all(), first = first_fifth(), last = last_fifth();
    const auto percent = [](double share) { return fmt::format("{:.3g} %", 100.0 * share); };
    switch (change) {
        case Change::drift:
            return fmt::format("means are over a changing state: ratio {:.5g} … {:.5g}, slip {} … {}", first.ratio, last.ratio,
                               percent(first.slip), percent(last.slip));
        case Change::brief:
            return fmt::format("means are over less than the {:.3g} ms in which a pin takes the place of the next one", 1e3 * pin_period_);
        case Change::energy:
            return fmt::format("means are over a changing state: the stored energy has {} {} of the input",
                               whole.stored > 0.0 ? "taken" : "given", percent(std::abs(whole.stored)));
        case Change::none: break;
    }
    return {};
}

std::array<bool, 9> RunMeans::odd(const EnergyBalance& balance) const {
    if (bins_.empty()) return {};
    const SpanMeans whole = all(), last = last_fifth();
    const auto impossible = [](double efficiency) { return efficiency < 0.0 || efficiency > 1.0; };  // not a number: none
    const bool stands = whole.turning < standing_speed;
    return {std::abs(last.slip) > gross_slip && !stands,
            last.limited > often,
            last.loose > often,
            whole.beyond > 0.0,
            !whole.no_load && (impossible(whole.efficiency) || impossible(last.efficiency)),
            change() != Change::none && !stands,
            stands,
            (whole.no_load || (std::isfinite(whole.efficiency) && whole.carried < 1.0)) && !stands,
            unresolved(balance) > resolved_share * balance.loss};
}

std::vector<Note> RunMeans::notes(const EnergyBalance& balance, bool pulleys) const {
    std::array<bool, 9> found = odd(balance);
    if (!pulleys) std::fill(found.begin(), found.end() - 1, false);
    const SpanMeans whole = all(), last = last_fifth();
    const auto percent = [](double share) { return fmt::format("{:.3g} %", 100.0 * share); };
    const std::string texts[] = {
        fmt::format("the chain slips by {}", percent(last.slip)),
        fmt::format("control is at the limit of its authority ({} of the last fifth)", percent(last.limited)),
        fmt::format("the slack strand carries no tension ({} of the last fifth)", percent(last.loose)),
        fmt::format("clamping exceeds wear.clamping_limit at its slip speed at {} of the outputs", percent(whole.beyond)),
        fmt::format("an efficiency of {} ({} in the last fifth) is none: what moves has taken or given energy", percent(whole.efficiency),
                    percent(last.efficiency)),
        text_of(change()),
        "the machine is at rest: slip is noise",
        fmt::format("no load: drive and load transfer {} of the losses{}", percent(whole.carried),
                    whole.no_load ? ": there is no efficiency, and slip is that of idling" : ": slip and efficiency are those of idling"),
        fmt::format("losses below the resolution of the energy balance: it would not show an error of {:.2g} J of {:.2g} J",
                    unresolved(balance), balance.loss),
    };
    std::vector<Note> notes;
    for (std::size_t k = 0; k < found.size(); ++k) {
        if (found[k]) notes.push_back({kinds[k].name, texts[k]});
    }
    return notes;
}

void RunMeans::name_notes(const EnergyBalance& balance, std::string& names) const {
    const std::array<bool, 9> found = odd(balance);
    names.clear();
    for (std::size_t k = 0; k < found.size(); ++k) {
        if (found[k]) names.append(names.empty() ? "" : " ").append(kinds[k].name);
    }
}

void RunMeans::save(std::vector<double>& memory) const {
    static_assert(std::is_trivially_copyable_v<Bin> && sizeof(Bin) % sizeof(double) == 0);
    constexpr std::size_t numbers = sizeof(Bin) / sizeof(double);
    memory.insert(memory.end(), {static_cast<double>(bins_.size()), per_bin_, pin_period_});
    const std::size_t begin = memory.size();
    memory.resize(begin + bins_.size() * numbers);
    if (!bins_.empty()) std::memcpy(memory.data() + begin, bins_.data(), bins_.size() * sizeof(Bin));
}

std::span<const double> RunMeans::load(std::span<const double> memory) {
    constexpr std::size_t numbers = sizeof(Bin) / sizeof(double);
    const auto bins = static_cast<std::size_t>(pop_integer(memory, 0, static_cast<int>(max_bins)));
    const auto own = pop_front(memory, 2);
    per_bin_ = own[0];
    pin_period_ = own[1];
    bins_.resize(bins);
    if (bins > 0) std::memcpy(static_cast<void*>(bins_.data()), pop_front(memory, bins * numbers).data(), bins * sizeof(Bin));
    return memory;
}

}  // namespace cvtflow::tasks
