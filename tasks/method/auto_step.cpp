
#include "tasks/method/auto_step.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "model/parameters/chain_layout.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

namespace {

constexpr double forever = std::numeric_limits<double>::infinity();

/// Longest step where friction falls with the sliding speed: slip and losses of a machine of the lottery were off by 1.3 % at 1.4 us, in
/// proportion to the step [s].
constexpr double longest_with_tip_law = 0.7e-6;

/// Largest h times NegativeSlopeFriction::growth(). Machine 93 of the lottery lost 3.6 % too much at 0.37 and 1.0 % at 0.25, machine 27 1.3
/// % at 0.2 [1].
constexpr double accurate_growth = 0.15;

/// Least number of steps in which a pin takes the place of the next one. A pin strikes its sheave, and rolls in its joint, within a few
/// hundredths of that time. Without this limit, 23 of 400 machines of the lottery with rigid pins were off by more than 1 % in losses, by
/// 3.7 % at most; with 100 steps per pin 13, by 1.6 % at most. With the method since decision 110, 80 steps are as exact as those were.
/// With halves the slip of `overdrive` is off by 0.35 % in 104 to 125 steps per pin, by 0.2 % in 140 (decision 115).
constexpr double steps_per_rigid_pin = 80.0, steps_per_pin_of_halves = 140.0;

/// Longest step with halves while a start's ramp loads contacts, which damp more than the last estimate has found [s].
constexpr double longest_while_loads_rise = 2.858e-6;

[[nodiscard]] double within(double reach, double extent) noexcept { return extent > 0.0 ? reach / extent : forever; }

/// Largest damping δ over the frequency of filtered waves with which they are stable to the limit without damping. Dampers in proportion to
/// stiffness make x (1 - β x) at x = h²ω² larger by 1 + 4 δ/(h ω²); its largest value is 1/(4 β) of 4, at h ω = 1/√(2 β).
[[nodiscard]] double filtered_damping(double filter) noexcept { return (4.0 * filter - 0.25) / std::sqrt(2.0 * filter); }

}  // namespace

double longest_automatic_step(const Method& method, const model::Parameters& parameters) {
    const MethodProgram* program = method.program();
    const double longest = program == nullptr ? usual_longest_step : program->longest_step;
    const bool limited = parameters.tip.friction_law != model::TipFriction::constant && parameters.detail.pins != model::PinDetail::rigid;
    return !limited ? longest : std::min(longest, longest_with_tip_law);
}

AutoStep::AutoStep(const model::Variator& variator, const model::Parameters& parameters, const Method& method)
    : reach_(reach_of(method)),
      longest_(longest_automatic_step(method, parameters)),
      interval_(parameters.detail.pins == model::PinDetail::rigid && reach_.damping != forever ? rigid_check_interval : check_interval),
      reuses_eigenvectors_(parameters.detail.pins == model::PinDetail::rigid),
      held_(held_links(method, variator.chain())),
      filter_(held_ != nullptr ? held_->wave_filter() : reach_.filter),
      memory_(std::make_shared<SpectralMemory>(variator.layout())),
      bound_(variator, filter_ > 0.0 ? MovedPart::all_but_waves : MovedPart::all, memory_, held_),
      variator_(variator),
      chain_(parameters.chain),
      start_(parameters.start) {
    if (variator.chain().coefficients().tip.law != nullptr)
        friction_growth_ = std::make_unique<NegativeSlopeFriction>(variator, parameters);
    if (friction_growth_ != nullptr) interval_ = check_interval;  // the forces that the growth is in proportion to change with the load
    if (reach_.damping == forever) return;
    friction_matters_ = parameters.detail.pins == model::PinDetail::rigid;
    model::Parameters without_friction = parameters;
    for (model::Friction* friction : {&without_friction.plate.friction, &without_friction.joint.friction, &without_friction.tip.friction})
        friction->coefficient = 0.0;
    frictionless_ = std::make_unique<model::Variator>(without_friction);
    std::vector<MovedPart> parts{MovedPart::all};
    if (filter_ > 0.0) parts = {MovedPart::all_but_waves, MovedPart::waves};
    if (friction_matters_) parts = {MovedPart::other_links, MovedPart::pulleys, MovedPart::waves};
    for (const MovedPart part : parts) damped_parts_.emplace_back(*frictionless_, part, memory_, held_);
}

double AutoStep::filtered_limit(const SpectralBound& part) const noexcept {
    const bool filtered = filter_ > 0.0 && &part == &damped_parts_.back() && part.real() < filtered_damping(filter_) * part.imaginary();
    return filtered ? within(1.0 / std::sqrt(filter_), part.imaginary()) : 0.0;
}

/// Where friction takes some of the stability away, shares of the strongest damping and of the fastest oscillation add up, as if one acted
/// on the other, which need not be so: h ω/2 + h δ = 1.
double AutoStep::limit_of(const SpectralBound& part) const noexcept {
    if (part.step() > 0.0) return part.step();
    const double filtered = filtered_limit(part);
    return filtered > 0.0 ? filtered : 1.0 / (part.imaginary() / reach_.oscillation + part.real() / reach_.damping);
}

/// Tries steps, from the longest one on, until one is stable: each with its own hold of the links.
void AutoStep::find_limit(SpectralBound& part, double time, const double* state, const model::Phase* phases) noexcept {
    constexpr int most_trials = 10;
    constexpr double close = 1.02;
    const bool waves = filter_ > 0.0 && &part == &damped_parts_.back();
    const bool loaded = time - begun_ > waves_change && model::ramp(start_, 0.5 * (begun_ + time)) >= 1.0;
    if (waves && part.step() > 0.0 && loaded) return;
    part.forget();
    part.take(longest_ / sharp_margin, false);
    if (waves) evaluations_ += part.estimate_at_rest(time, state, phases);
    if (const double limit = filtered_limit(part); limit > 0.0) return part.take(limit, false);
    double excess = 1.0;
    for (int trial = 0; trial == 0 || (trial < most_trials && excess > close); ++trial) {
        part.take(part.step() / excess, true);
        evaluations_ += part.estimate_oscillation(time, state, phases);
        excess = part.step() * part.imaginary() / reach_.oscillation;
    }
    part.take(part.step() / std::max(1.0, excess), true);
}

const SpectralBound& AutoStep::most_limiting() const noexcept {
    return *std::ranges::min_element(damped_parts_, {}, [this](const SpectralBound& part) { return limit_of(part); });
}

void AutoStep::restart() noexcept {
    bound_.forget();
    for (SpectralBound& part : damped_parts_) part.forget();
    checked_ = estimated_ = begun_ = damped_at_ = turned_ = -1e300;
    part_ = no_part;
    soonest_ = check_interval;
    damping_due_ = false;
    stable_ = growth_ = pin_period_ = 0.0;
    damped_ = forever;
    evaluations_ = 0;
}

bool AutoStep::spreads(double time) const noexcept {
    return reuses_eigenvectors_ && time >= 0.0 && time - begun_ >= check_interval * (1.0 - 1e-9);
}

bool AutoStep::check_is_due(double time) const noexcept {
    return part_ == no_part && time - checked_ >= std::min(interval_, checked_ - begun_) * (1.0 - 1e-9);
}

bool AutoStep::turn_is_due(double time) const noexcept {
    return part_ != no_part && (!spreads(time) || time - turned_ >= turn_interval * (1.0 - 1e-9));
}

bool AutoStep::reads_state(double time) const noexcept {
    return !reuses_eigenvectors_ || begun_ == -1e300 || check_is_due(time) || turn_is_due(time);
}

double AutoStep::longest(double time, const double* state, const model::Phase* phases) noexcept {
    if (begun_ == -1e300) begun_ = time;
    if (!reuses_eigenvectors_ && clamping_has_risen(time, state)) {  // contacts follow within some milliseconds
        begun_ = time;
        soonest_ = soonest_after_rise;
    }
    if (check_is_due(time)) {
        const double interval = std::min(interval_ < rigid_check_interval ? interval_ : rigid_estimate_interval, estimated_ - begun_);
        if (clamping_has_risen(time, state) || time - estimated_ >= interval * (1.0 - 1e-9)) {
            // Contacts damp more the more they bear; what they bear hardly changes in a settled run whose clamping does not.
            damping_due_ = time == begun_ || time - begun_ >= std::max(soonest_, 2.0 * (damped_at_ - begun_)) * (1.0 - 1e-9);
            part_ = friction_matters_ ? 0 : 1;  // sweeps take friction implicitly: all that limits them is in the other parts
            estimated_ = time;
        }
        checked_ = time;
        pin_period_ = model::pin_period(chain_, variator_.layout(), state);
        if (friction_growth_ != nullptr) growth_ = friction_growth_->growth(time, state, phases);
    }
    if (turn_is_due(time)) {
        estimate(time, state, phases, spreads(time) ? turn_evaluations : SpectralBound::unlimited);
        turned_ = time;
    }
    const double passing =
        pin_period_ > 0.0 ? pin_period_ / (reuses_eigenvectors_ ? steps_per_rigid_pin : steps_per_pin_of_halves) : forever;
    const double rising = !friction_matters_ && model::ramp(start_, time) < 1.0 ? longest_while_loads_rise : forever;
    return std::min({stable_step(), passing, longest_, rising});
}

/// Forces without the ramp of a start.
std::array<double, 2> AutoStep::clamping(double time, const double* state) const noexcept {
    return variator_.pulleys().inputs().at(std::max(time, 0.0), state + variator_.layout().pulley_begin()).clamping;
}

bool AutoStep::clamping_has_risen(double time, const double* state) const noexcept {
    constexpr double rise = 1.2, small = 100.0;  // [1], [N]
    if (damped_parts_.empty() || damped_at_ == -1e300 || variator_.layout().pulley_size == 0) return false;
    const std::array<double, 2> now = clamping(time, state);
    return now[0] > rise * std::max(small, damped_with_[0]) || now[1] > rise * std::max(small, damped_with_[1]);
}

void AutoStep::estimate(double time, const double* state, const model::Phase* phases, int budget) noexcept {
    const int parts = 1 + (damping_due_ ? static_cast<int>(damped_parts_.size()) : 0);
    while (part_ < parts) {
        SpectralBound& part = part_ == 0 ? bound_ : damped_parts_[static_cast<std::size_t>(part_ - 1)];
        if (!friction_matters_) {
            find_limit(part, time, state, phases);
        } else {
            const bool oscillation = part_ == 0 && reach_.decay == forever;
            evaluations_ +=
                oscillation ? part.estimate_oscillation(time, state, phases, budget) : part.estimate_at_rest(time, state, phases, budget);
        }
        if (!part.complete()) return;
        ++part_;
        if (budget != SpectralBound::unlimited) break;
    }
    if (part_ < parts) return;
    part_ = no_part;
    if (damping_due_) {
        if (!damped_parts_.empty()) damped_ = limit_of(most_limiting());
        damped_at_ = time;
    }
    if (!damped_parts_.empty() && (damping_due_ || reuses_eigenvectors_)) damped_with_ = clamping(time, state);
    stable_ = std::min({within(reach_.oscillation, bound_.imaginary()), within(reach_.decay, bound_.real()), damped_});
}

LargestStep AutoStep::largest() const noexcept {
    const double share = friction_matters_ ? margin : sharp_margin;
    const double fastest = !damped_parts_.empty() ? most_limiting().imaginary() : bound_.imaginary();
    const LargestStep limits[] = {
        {share * within(reach_.oscillation, bound_.imaginary()), StepLimiter::oscillation, bound_.imaginary()},
        {share * within(reach_.decay, bound_.real()), StepLimiter::decay, bound_.real()},
        {share * damped_, share * damped_ < longest_ * (1.0 - 1e-9) || friction_matters_ ? StepLimiter::damping : StepLimiter::error,
         fastest},
        {within(reach_.accurate, bound_.imaginary()), StepLimiter::accuracy, bound_.imaginary()},
        {within(accurate_growth, growth_), StepLimiter::growth, growth_},
    };
    const LargestStep least = *std::ranges::min_element(limits, {}, &LargestStep::step);
    return least.step < forever ? least : LargestStep{};
}

std::string text_of(const LargestStep& limit) {
    const std::string step = limit.step < 1e-6 ? fmt::format("{:.3g} ns", 1e9 * limit.step) : fmt::format("{:.3g} us", 1e6 * limit.step);
    const double kilohertz = limit.rate / (2e3 * std::numbers::pi);
    switch (limit.by) {
        case StepLimiter::nothing: return "linear stability sets no limit";
        case StepLimiter::oscillation: return fmt::format("{} (oscillation of {:.3g} kHz)", step, kilohertz);
        case StepLimiter::error: return step + " (as long as friction is accurate)";
        case StepLimiter::decay: return fmt::format("{} (decay of {:.2g} 1/s)", step, limit.rate);
        case StepLimiter::damping: return fmt::format("{} (damping of oscillations up to {:.3g} kHz)", step, kilohertz);
        case StepLimiter::accuracy: return fmt::format("{} (accuracy at an oscillation of {:.3g} kHz)", step, kilohertz);
        case StepLimiter::growth: return fmt::format("{} (sliding grows by {:.2g} 1/s where friction falls)", step, limit.rate);
    }
    return "";
}

void AutoStep::visit(engine::Archive& archive) {
    archive("step_checked", checked_), archive("step_begun", begun_), archive("stable_step", stable_);
    archive("damped_step", damped_), archive("damped_at", damped_at_), archive("growth", growth_), archive("pin_period", pin_period_);
    archive("spectrum_evaluations", evaluations_);
    if (friction_matters_) bound_.visit(archive);
    for (SpectralBound& part : damped_parts_) {
        if (!friction_matters_) part.visit_limit(archive);
    }
    if (!reuses_eigenvectors_) return archive("damped_soonest", soonest_), archive("damped_with", damped_with_);
    for (SpectralBound& part : damped_parts_) part.visit(archive);
    archive("spectrum_part", part_, no_part, static_cast<int>(damped_parts_.size()));
    archive("damping_due", damping_due_), archive("spectrum_turned", turned_), archive("spectrum_estimated", estimated_);
    archive("damped_with", damped_with_);
}

NegativeSlopeFriction::NegativeSlopeFriction(const model::Variator& variator, const model::Parameters& parameters)
    : variator_(variator), half_mass_(parameters.half.mass), observer_(variator) {}

/// Searches sliding speeds from the saturation speed up to 10 m/s, faster than tips slide in a machine that works, in steps of 2 %.
double NegativeSlopeFriction::fastest_growth(double force) const noexcept {
    constexpr double ratio = 1.02, fastest = 10.0;  // [1], [m/s]
    const model::TipCoefficients& tip = variator_.chain().coefficients().tip;
    double growth = 0.0, speed = tip.friction.saturation_speed, value = tip.law->by_speed.at(speed);
    while (speed < fastest) {
        const double next = tip.law->by_speed.at(speed * ratio);
        const double fall = tip.friction.coefficient * ((value - next) / (speed * (ratio - 1.0)));
        growth = std::max(growth, with_memory(2.0 * force * fall / half_mass_, speed));
        speed *= ratio;
        value = next;
    }
    return growth;
}

/// Positive root of s² + a s = a g.
double NegativeSlopeFriction::with_memory(double at_once, double speed) const noexcept {
    const model::TipCoefficients& tip = variator_.chain().coefficients().tip;
    if (!(tip.law->memory > 0.0) || at_once <= 0.0) return at_once;
    const double follows = (speed + tip.friction.saturation_speed) / tip.law->memory;
    return 2.0 * at_once / (1.0 + std::sqrt(1.0 + 4.0 * at_once / follows));
}

double NegativeSlopeFriction::growth(double t, const double* state, const model::Phase* phases) noexcept {
    if (variator_.chain().coefficients().tip.law == nullptr || !(fastest_growth(1.0) > 0.0)) return 0.0;
    const auto& axial = observer_.observe(t, state, phases).tip_axial;
    double largest = 0.0;
    for (const double force : axial) largest = std::max(largest, std::abs(force));
    return fastest_growth(largest);
}

}  // namespace cvtflow::tasks
