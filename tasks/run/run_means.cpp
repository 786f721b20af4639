#include "tasks/run/run_means.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "tasks/scene/scene.hpp"
#include "tasks/step/control/step_grid.hpp"
#include "tasks/step/step_method.hpp"
#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

namespace {

constexpr double gross_slip = 0.03;      ///< creep of a holding chain stays below a hundredth, a sliding one is beyond
constexpr double often = 0.05;           ///< share of time
constexpr double misses = 0.01;          ///< share of a controller's target
constexpr double swings = 0.05;          ///< a controlled force: standard deviation over mean
constexpr double known = 0.01;           ///< error of a mean beyond which it is no result to 1 %
constexpr double misses_cycle = 0.02;    ///< speed of shaft 2 follows ECE-15 within 1.5 %
constexpr double varies = 1e-6;          ///< a target that is a table, from fifth to fifth
constexpr double standing_speed = 0.1;   ///< speed of shafts, 5 mm/s at the chain: of the order of the speeds at which tips creep [rad/s]
constexpr double resolved_share = 0.05;  ///< share of the losses that the balance may leave
constexpr double periods_of_control = 24.0;  ///< pin periods of ratio control before a sheave is held
constexpr double takes_energy = 0.02;        ///< share of the input; 7e-4 over 11 pin periods of the settled baseline

/// Absolute tolerance of a balance [J]; 0 if there are too few samples to judge it.
[[nodiscard]] double unresolved(EnergyBalance balance) noexcept {
    constexpr double min_samples = 10.0;
    balance.loss = 0.0;
    return balance.samples < min_samples ? 0.0 : balance.expected_residual();
}

/// Change of the stored energy, by works and losses [J].
[[nodiscard]] double change_of_energy(const EnergySums& before, const EnergySums& after) noexcept {
    double change = before.lost() - after.lost();
    for (std::size_t k = 0; k < after.work.size(); ++k) change += after.work[k] - before.work[k];
    return change;
}

/// Means of one number each, with their places.
constexpr std::pair<Mean, double SpanMeans::*> scalar_means[] = {
    {Mean::slip, &SpanMeans::slip},       {Mean::friction_slip, &SpanMeans::friction_slip},
    {Mean::tight, &SpanMeans::tight},     {Mean::slack, &SpanMeans::slack},
    {Mean::limited, &SpanMeans::limited}, {Mean::missed, &SpanMeans::missed},
    {Mean::loose, &SpanMeans::loose},     {Mean::beyond, &SpanMeans::beyond},
    {Mean::floor, &SpanMeans::floor},     {Mean::turning, &SpanMeans::turning},
    {Mean::target, &SpanMeans::target}};

void fill_means(const MeanPoint& before, const MeanPoint& after, SpanMeans& means) {
    const auto mean = [&](Mean quantity) { return after.mean_since(before, quantity); };
    const auto each = [&](Mean quantity, auto& values) {
        for (std::size_t k = 0; k < values.size(); ++k) values[k] = after.mean_since(before, quantity, k);
    };
    for (const auto& [quantity, member] : scalar_means) means.*member = mean(quantity);
    means.ratio = after.ratio_since(before);
    means.loss_slip = mean(Mean::brought) > 0.0 ? mean(Mean::creep) / mean(Mean::brought) : 0.0;
    if (mean(Mean::needed) > 0.0) means.astray = mean(Mean::astray) / mean(Mean::needed);
    if (mean(Mean::demanded) > 0.0) means.short_of = mean(Mean::short_of) / mean(Mean::demanded);
    each(Mean::speed, means.speed);
    each(Mean::torque, means.torque);
    each(Mean::chain_torque, means.chain_torque);
    each(Mean::clamping, means.clamping);
    each(Mean::radius, means.radius);
    each(Mean::axial_force, means.axial_force);
}

void fill_energies(const MeanPoint& before, const MeanPoint& after, SpanMeans& means) {
    const EnergySums &from = before.energy, &to = after.energy;
    const double lasted = after.time - before.time, change = change_of_energy(from, to);
    const EnergyFlow variator = to.since(from), outside = to.outside_since(from);
    const double in = outside.input();
    means.no_load = in > 0.0 && outside.no_load();
    means.hydraulics = model::mean_powers(before.hydraulics, after.hydraulics, lasted);
    const double time = to.time - from.time, pump = means.hydraulics.pump * time, oil = means.hydraulics.lost() * time;  // mean powers
    means.efficiency = variator.efficiency();
    means.with_pump = variator.with_pump(pump, oil).efficiency();
    means.overall = outside.with_pump(pump, oil).efficiency();
    means.carried = outside.lost > 0.0 ? outside.taken() / outside.lost : 0.0;
    means.stored = in > 0.0 ? change / in : 0.0;
    if (!(lasted > 0.0)) return;
    for (std::size_t shaft = 0; shaft < means.drag.size(); ++shaft) {
        means.drag[shaft] = (to.drag[shaft] - from.drag[shaft]) / lasted;
        means.shaft_power[shaft] = outside.shaft[shaft] / lasted;
    }
    means.input = in / lasted;
    means.lost = outside.lost / lasted;
    means.taken = (in - outside.lost - change) / lasted;
}

}  // namespace

std::string SpanMeans::text() const {
    std::string words = fmt::format("begin {} end {} thrust_ratio {}", begin, end, clamping[0] / clamping[1]);
    for (const auto& [name, value] : {std::pair{"ratio", ratio},
                                      {"slip", slip},
                                      {"friction_slip", friction_slip},
                                      {"loss_slip", loss_slip},
                                      {"tight_tension", tight},
                                      {"slack_tension", slack},
                                      {"efficiency", efficiency}})
        words += fmt::format(" {} {}", name, value);
    for (const auto& [name, values] : {std::pair{"speed", speed}, {"torque", torque}, {"clamping", clamping}, {"radius", radius}})
        words += fmt::format(" shaft_1/{0} {1} shaft_2/{0} {2}", name, values[0], values[1]);
    return words;
}

bool SpanMeans::cycle_missed() const noexcept { return astray > misses_cycle || std::abs(short_of) > misses_cycle; }

std::string CycleMiss::text(const SpanMeans& whole) const {
    return fmt::format(
        "the machine misses its cycle: speed of shaft 2 is off by {:.3g} % on average, its work by {:+.3g} %; most at t = "
        "{:.4g} s, where its speed is off by {:+.3g} %",
        100.0 * whole.astray, -100.0 * whole.short_of, time, 100.0 * share);
}

SpanMeans RunMeans::span(double from, double to) const {
    SpanMeans means;
    if (curve_.empty()) return means;
    const double first = begin(), last = end(), lasted = last - first, period = curve_.pin_period();
    means.begin = first + from * lasted;
    means.end = to == 1.0 ? last : first + to * lasted;
    means.periods = period > 0.0 ? std::floor((means.end - means.begin) / period) : 0.0;
    if (means.periods == 0.0 && period > 0.0 && means.end - first >= period) means.periods = 1.0;  // a fifth shorter than a period
    if (means.periods > 0.0) means.begin = std::max(first, means.end - means.periods * period);
    const MeanPoint before = curve_.at(means.begin), after = curve_.at(means.end);
    fill_means(before, lasted > 0.0 ? after : curve_.instant(before), means);
    means.swing = min_swing(curve_, means.begin, means.end);
    fill_energies(before, after, means);
    return means;
}

MeanErrors RunMeans::errors() const noexcept {
    return noted_errors(steady_.batches > 0 ? MeanErrors(steady_) : mean_errors(curve_), std::max(known, rule_.tolerance),
                        rule_.holds_sheave());
}

double RunMeans::begin() const noexcept { return steady_.batches == 0 ? curve_.first().time : curve_.points()[steady_.begin].time; }

double RunMeans::end() const noexcept {
    const std::size_t past = steady_.begin + steady_.batches * steady_.batch;
    return steady_.batches == 0 ? curve_.last().time : curve_.points()[past].time;
}

SteadyRule steady_rule(const Scene& scene) noexcept {
    const model::Parameters& p = scene.parameters;
    const bool changes = std::isfinite(next_input_point(p, {}, 0.0)), pressures = p.hydraulics.mode == model::HydraulicMode::pressure;
    if (!scene.run.until.automatic()) return {.changes = changes, .pressures = pressures};
    const int pitches = static_cast<int>(p.chain.pitch.size()), pins = p.chain.pins;
    const bool turns_matter = p.imperfection.runout != 0.0 || p.imperfection.attachment != 1.0 || p.imperfection.unbalance != 0.0 ||
                              p.imperfection.pin_length_spread != 0.0 || pins % pitches != 0;
    const bool holds_ratio = p.control.enabled && p.control.quantity == model::ControlledQuantity::ratio;
    return {.tolerance = scene.run.steady,
            .limit = scene.run.steady_limit * pins,
            .pins = static_cast<double>(pins),
            .repeats = static_cast<double>(turns_matter ? pins : pitches),
            .holds_ratio = holds_ratio,
            .controlled = scene.when_steady == WhenSteady::hold ? periods_of_control : 0.0,
            .grip = model::grip(p.tip),
            .inertia = p.load.mode == model::LoadMode::torque ? model::shaft_inertia(p.pulley, p.load.inertia) : 0.0,
            .changes = changes,
            .pressures = pressures};
}

void RunMeans::clear() noexcept {
    curve_.clear();
    steady_ = {};
    miss_ = {};
    next_check_ = 0.0;
    ended_ = false;
}

void RunMeans::seek_steady(const SteadyRule& rule) noexcept {
    rule_ = rule;
    if (rule.limit > 0.0) curve_.mark_periods();
}

void RunMeans::add(const model::Observation& now, const EnergySums& sums, double pin_period, const EnergyMark& mark, double needed_speed) {
    curve_.add(now, sums, pin_period, mark, needed_speed);
    const double off = needed_speed != 0.0 ? now.speed[1] / needed_speed - 1.0 : 0.0;
    if (std::abs(off) > std::abs(miss_.share)) miss_ = {now.time, off};
    end_control();
    if (rule_.limit > 0.0 && !ended_) check_steady();
}

void RunMeans::end_control() noexcept {
    if (rule_.controlled > 0.0 && static_cast<double>(curve_.points().size()) > rule_.controlled) judge_control(curve_, rule_);
}

void RunMeans::check_steady() noexcept {
    constexpr double between_checks = 4.0;
    const double periods = static_cast<double>(curve_.points().size() - 1);
    ended_ = !(curve_.pin_period() > 0.0) || periods >= rule_.limit;
    if (!ended_ && periods < next_check_) return;
    next_check_ = periods + between_checks;
    steady_ = steady_means(curve_, rule_);
    ended_ = ended_ || steady_.steady() || steady_.sliding > 0.0 || steady_.astray;
}

Fault RunMeans::steady_fault() const noexcept {
    if (!ended_ || steady_.steady()) return {};
    if (steady_.sliding > 0.0) return {FaultKind::not_steady, curve_.last().time, {}, steady_.sliding, 0.0};
    return {FaultKind::not_steady, curve_.last().time, {}, steady_.share, rule_.limit / std::max(1.0, rule_.pins)};
}

void RunMeans::visit(engine::Archive& archive) {
    archive("next_check", next_check_), archive("cycle_miss_time", miss_.time), archive("cycle_miss_share", miss_.share);
    curve_.visit(archive);
    if (archive.reads()) end_control();
}

namespace {

[[nodiscard]] std::string percent(double share) { return fmt::format("{:.3g} %", 100.0 * share); }

/// Reason to doubt means.
enum class Doubt { none, moves, brief, energy, few, uncertain };

[[nodiscard]] Doubt doubt_of(const RunMeans& means, const MeanErrors& errors) noexcept {
    const SpanMeans whole = means.all();
    const bool counts = means.curve().pin_period() > 0.0;
    if (errors.moved > 1.0) return Doubt::moves;
    if (counts && whole.periods < 1.0) return Doubt::brief;
    if (std::abs(whole.stored) > takes_energy) return Doubt::energy;
    if (counts && errors.batches == 0) return Doubt::few;
    return errors.share > 1.0 && !means.steady().steady() ? Doubt::uncertain : Doubt::none;
}

[[nodiscard]] std::string doubt_text(Doubt doubt, const RunMeans& means, const MeanErrors& errors) {
    const SpanMeans whole = means.all();
    const std::string_view advice = means.rule().limit > 0.0 || means.rule().changes ? "" : ": run.until=steady ends a run once they are";
    const auto of_mean = [](double value, const MeanError& error) { return percent(value / std::abs(error.mean)); };
    switch (doubt) {
        case Doubt::moves:
            return fmt::format("means are over a changing state: change of {} from begin to end {}", MeanErrors::name(errors.moving),
                               of_mean(errors.error[errors.moving].change, errors.error[errors.moving]));
        case Doubt::brief:
            return fmt::format("means are over less than the {:.3g} ms in which a pin takes the place of the next one",
                               1e3 * means.curve().pin_period());
        case Doubt::energy:
            return fmt::format("means are over a changing state: the stored energy has {} {} of the input",
                               whole.stored > 0.0 ? "taken" : "given", percent(std::abs(whole.stored)));
        case Doubt::few:
            return fmt::format("means are over {:.0f} pin periods, fewer than 4: their errors are not known{}", whole.periods, advice);
        case Doubt::uncertain:
            return fmt::format("means are not known to 1 %: {} ± {}{}", MeanErrors::name(errors.worst),
                               of_mean(errors.error[errors.worst].sum(), errors.error[errors.worst]), advice);
        case Doubt::none: break;
    }
    return {};
}

/// The largest mean slip of a fiftieth of the run, whose shafts turn, without its sign [1]; and when it is [s].
struct LargestSlip {
    double slip = 0.0, begin = 0.0, end = 0.0;

    [[nodiscard]] std::string text() const {
        return fmt::format("the chain slips by {} from {:.4g} to {:.4g} s", percent(slip), begin, end);
    }
};

[[nodiscard]] LargestSlip largest_slip(const RunMeans& means) {
    constexpr double most = 50.0, fewest_periods = 4.0;
    const SpanMeans whole = means.all();
    const double parts = std::clamp(std::floor(whole.periods / fewest_periods), 1.0, most);
    LargestSlip largest;
    MeanPoint before = means.curve().at(whole.begin);
    for (double part = 1.0; part <= parts && whole.end > whole.begin; part += 1.0) {
        const MeanPoint after = means.curve().at(whole.begin + part / parts * (whole.end - whole.begin));
        const double slip = std::abs(after.mean_since(before, Mean::slip));
        if (slip > largest.slip && after.mean_since(before, Mean::turning) > standing_speed) largest = {slip, before.time, after.time};
        before = after;
    }
    return largest;
}

/// Limit and miss of a controller in the last fifth of a run; where its target changes, in all of it: the share of time at its limit, and
/// the fifth in which it misses the target most.
struct Controlled {
    explicit Controlled(const RunMeans& means) {
        const SpanMeans whole = means.all(), last = means.fifth(4);
        limited = last.limited;
        missed = last.missed;
        for (int k = 0; k < 4; ++k) follows = follows || std::abs(means.fifth(k).target - last.target) > varies * std::abs(last.target);
        if (!follows) return;
        of_run = whole.limited > limited;
        limited = std::max(limited, whole.limited);
        for (int k = 0; k < 4; ++k) {
            const double there = means.fifth(k).missed;
            if (std::abs(there) > std::abs(missed)) missed = there, fifth = k;
        }
    }
    /// "the last fifth", "the second fifth", …
    [[nodiscard]] std::string place() const {
        constexpr std::string_view names[] = {"first", "second", "third", "fourth", "last"};
        return fmt::format("the {} fifth", names[fifth]);
    }

    double limited = 0.0, missed = 0.0;    ///< [1]
    bool follows = false, of_run = false;  ///< a target that changes; whether `limited` is of all of the run
    int fifth = 4;
};

/// Whether each of note_kinds applies.
[[nodiscard]] std::array<bool, std::size(note_kinds)> odd(const RunMeans& means, const EnergyBalance& balance) {
    if (means.curve().empty()) return {};
    const SpanMeans whole = means.all(), last = means.fifth(4);
    const auto lives_on_itself = [](const SpanMeans& span) { return span.input > 0.0 && span.lost > span.input; };
    const bool stands = whole.turning < standing_speed;
    const Controlled control(means);
    const Doubt doubt = doubt_of(means, means.errors());
    const bool uncertain = doubt == Doubt::few || doubt == Doubt::uncertain;
    return {largest_slip(means).slip > gross_slip && !stands,
            control.limited > often,
            std::abs(control.missed) > (means.rule().holds_sheave() ? misses_held : misses) && !stands,
            last.swing > swings && !stands,
            last.loose > often,
            whole.beyond > 0.0,
            whole.floor > often,
            !whole.no_load && (lives_on_itself(whole) || lives_on_itself(last)),
            doubt != Doubt::none && !uncertain && !stands,
            uncertain && !stands,
            stands,
            (whole.no_load || (whole.input > 0.0 && whole.carried < 1.0)) && !stands,
            whole.cycle_missed(),
            unresolved(balance) > resolved_share * balance.loss};
}

}  // namespace

std::vector<Note> notes(const RunMeans& means, const EnergyBalance& balance, bool pulleys) {
    std::array<bool, std::size(note_kinds)> found = odd(means, balance);
    if (!pulleys) std::fill(found.begin(), found.end() - 1, false);
    const SpanMeans whole = means.all(), last = means.fifth(4);
    const Controlled control(means);
    const MeanErrors errors = means.errors();
    const std::string doubts = doubt_text(doubt_of(means, errors), means, errors);
    const char* floor = means.rule().pressures ? "hydraulics.driven_pressure" : "clamping.driven";
    const std::string texts[] = {
        largest_slip(means).text(),
        fmt::format("control is at the limit of its authority ({} of the {})", percent(control.limited),
                    control.of_run ? "run" : "last fifth"),
        fmt::format("control misses its target by {} in {}", percent(control.missed), control.place()),
        fmt::format("a controlled clamping force swings by {} of its mean (standard deviation): the gains of its controller are too high",
                    percent(last.swing)),
        fmt::format("the {} strand carries no tension ({} of the last fifth)", last.tight < last.slack ? "tight" : "slack",
                    percent(last.loose)),
        fmt::format("clamping exceeds wear.clamping_limit at its slip speed in {} of the time", percent(whole.beyond)),
        fmt::format("{0} decides the clamping force of shaft 2 in {1} of the time: {0}=0 leaves it to clamping.safety", floor,
                    percent(whole.floor)),
        fmt::format("there is no efficiency: {:.3g} W are lost of {:.3g} W that come in ({:.3g} of {:.3g} W in the last fifth), and what "
                    "moves gives the rest",
                    whole.lost, whole.input, last.lost, last.input),
        doubts,
        doubts,
        "the machine is at rest: slip is noise",
        fmt::format("no load: drive and load transfer {} of the losses{}", percent(whole.carried),
                    whole.no_load ? ": there is no efficiency, and slip is that of idling" : ": slip and efficiency are those of idling"),
        means.cycle_miss().text(whole),
        fmt::format("losses below the resolution of the energy balance: it would not show an error of {:.2g} J of {:.2g} J",
                    unresolved(balance), balance.loss),
    };
    std::vector<Note> notes;
    for (std::size_t k = 0; k < found.size(); ++k) {
        if (found[k]) notes.push_back({note_kinds[k].name, texts[k]});
    }
    return notes;
}

void name_notes(const RunMeans& means, const EnergyBalance& balance, std::string& names) {
    const std::array<bool, std::size(note_kinds)> found = odd(means, balance);
    names.clear();
    for (std::size_t k = 0; k < found.size(); ++k) {
        if (found[k]) names.append(names.empty() ? "" : " ").append(note_kinds[k].name);
    }
}

void add_sample(RunMeans& means, const model::Observation& now, const Workspace& w, double time) {
    const model::Parameters& p = w.parameters;
    const double needed = w.trip.points() > 0 ? p.drive.speed.at(time) / p.control.ratio.at(time) : 0.0;
    means.add(now, w.energy.sums(time), w.pin_period(now.chain_speed), w.energy.mark(), needed);
}

}  // namespace cvtflow::tasks
