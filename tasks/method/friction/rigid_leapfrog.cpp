
#include "tasks/method/friction/rigid_leapfrog.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "tasks/step/step_graph.hpp"

namespace cvtflow::tasks {

namespace {

enum RigidCycle : int { rigid_cycle = method_cycles };
/// Fields of these tasks, numbered behind those of the step graph. Unit: a pin.
enum RigidField { motion = 1100, link_force, plate_force, tip_force, account };

/// Steps that differ by less, as a part of themselves, are of one length: they are differences of times, which are rounded.
constexpr double equal_steps = 1e-8;
/// Radii of pins are known to this without further work [m].
constexpr double radius_error = 1e-4;

[[nodiscard]] double least_inertia(const model::RigidCoefficients& c) noexcept { return std::min(c.mass, c.tilt_mass); }

/// to = from + share * rates, term by term.
template <class Values, class Rates>
void advance(Values& to, const Values& from, double share, const Rates& rates) noexcept {
    for (std::size_t k = 0; k < to.size(); ++k) to[k] = from[k] + share * rates[k];
}

/// The phases are compared with all tips after the next step.
void forget_touching(model::StepColumns& columns, int pins) noexcept {
    for (int tip = 0; tip < model::rigid_tips; ++tip) std::fill_n(columns.tip.touching[at(tip)], pins, -1.0F);
}

/// Tips of a pin are those of its front half, the front of the link behind, and of its rear half, the rear of the link ahead.
void set_phase(Workspace& w, int pin, int tip, bool touches) noexcept {
    const int link = tip < model::rigid_tips / 2 ? w.layout().previous(pin) : pin;
    const std::size_t number = at(model::tips_per_link * link + (tip + model::rigid_tips / 2) % model::rigid_tips);
    const model::Phase phase = touches ? model::Phase::touching : model::Phase::free;
    if (std::exchange(w.tips.phases[number], phase) != phase) w.tips.changed[number] = w.step.time + w.step.h;
}

/// Phases of tips: touching where they press.
void find_touching(Workspace& w, model::RigidState& pins) noexcept {
    w.tips.have_changed = false;
    if (pins.model.kernels<float>().contact_changes(pins.columns) == 0.0) return;
    w.tips.have_changed = true;
    w.tips.phases_before = w.tips.phases;
    for (int tip = 0; tip < model::rigid_tips; ++tip) {
        const float* normal = pins.columns.tip.normal[at(tip)];
        float* touching = pins.columns.tip.touching[at(tip)];
        for (int pin = 0; pin < pins.columns.padded(); ++pin) {
            const float touches = normal[pin] > 0.0F ? 1.0F : 0.0F;
            if (std::exchange(touching[pin], touches) != touches && pin < w.layout().links) set_phase(w, pin, tip, touches > 0.0F);
        }
    }
}

}  // namespace

RigidLeapfrog::RigidLeapfrog(Workspace& workspace)
    : w_(workspace),
      pins_(workspace.columns()),
      c_(pins_.model.coefficients()),
      kernel_(pins_.model.kernels<float>()),
      pulleys_(workspace.variator, pins_),
      account_(workspace.energy.count()),
      fastest_(0.5 * least_inertia(c_) * fastest_pin * fastest_pin),
      ledger_(pins_.ledger) {}

void RigidLeapfrog::add_tasks(engine::TaskGraph& graph) {
    const int pins = w_.layout().links;
    const auto writes = [pins](int field) { return engine::Access{field, 0, pins, true}; };
    const auto reads = [pins](int field) { return engine::Access{field, 0, pins, false}; };
    const auto add = [&](const char* name, engine::TaskCode code, const std::vector<engine::Access>& accesses) {
        return graph.add({name, rigid_cycle, code, 0, accesses});
    };
    const int tasks[] = {
        add("links", engine::code_of<&RigidLeapfrog::links>(*this), {writes(motion), writes(link_force), writes(account)}),
        add("press", engine::code_of<&RigidLeapfrog::press>(*this), {reads(motion), reads(link_force), writes(tip_force)}),
        add("plates", engine::code_of<&RigidLeapfrog::plates>(*this),
            {reads(motion), reads(link_force), reads(tip_force), writes(plate_force), writes(account)}),
        add("rub", engine::code_of<&RigidLeapfrog::rub>(*this),
            {reads(link_force), reads(plate_force), writes(tip_force), writes(account)}),
        add("kick", engine::code_of<&RigidLeapfrog::kick>(*this),
            {reads(link_force), writes(plate_force), reads(tip_force), writes(motion), writes(account)}),
    };
    for (int k = 0; k < 4; ++k) graph.order(tasks[k], tasks[k + 1]);
}

CycleSequence RigidLeapfrog::step() {
    const double h = w_.step.h;
    if (std::abs(0.5 * h - pins_.lead) > equal_steps * h) set_lead(0.5 * h);
    kick_.step = h;
    pulleys_.drift(h);     // q ← q + h v
    co_yield rigid_cycle;  // q ← q + h v;  a = forces at q, with the friction of v + 0.7 h a;  v ← v + h a
    finish();              // the pulleys by the reactions of the tips: v ← v + h a; energies; phases
    co_return is_suspect() ? find_fault(w_, w_.state()) : Fault{};
}

void RigidLeapfrog::links(int) noexcept { kernel_.links(c_, kick_, pins_.columns, pins_.forces.account); }

void RigidLeapfrog::press(int) noexcept {
    if (!pulleys_.absent()) kernel_.press(c_, pulleys_.sheaves(), kick_, pins_.columns);
}

void RigidLeapfrog::plates(int) noexcept { kernel_.plates(c_, kick_, pins_.columns, pins_.forces.account); }

void RigidLeapfrog::rub(int) noexcept {
    if (!pulleys_.absent()) kernel_.rub(c_, pins_.columns, pins_.forces.reaction, pins_.forces.account);
}

void RigidLeapfrog::kick(int) noexcept { pins_.forces.kinetic = kernel_.kick(c_, kick_, pins_.columns, pins_.forces.account); }

/// Friction of the velocities as they are stays in the columns, and the first step begins with it.
void RigidLeapfrog::start() {
    std::copy_n(w_.state() + w_.layout().pulley_begin(), pins_.tail.size(), pins_.tail.begin());
    pulleys_.place();
    pins_.read(w_.state(), w_.variator.chain().rigid()->evaluate(w_.state(), pulleys_.sheaves()));
    ledger_ = pins_.ledger;
    shift_ = 0.0;
    kick_ = {};
    forget_touching(pins_.columns, w_.layout().links);
    const model::StepColumns& columns = pins_.columns;
    columns.copy({columns.plate.slip_low, columns.plate.slip_high}, columns.plate.slip_low_before);
    columns.copy(columns.joint.slip, columns.joint.slip_before);
    columns.clear(columns.damping.waves(), 0, columns.padded());
    pulleys_.start(w_.step.time);
    half_way_ = {};
    count_energy({});
    cold_ = false;
}

void RigidLeapfrog::finish() noexcept {
    count_energy(pulleys_.kick(w_.step.time + kick_.step, kick_.step));
    find_touching(w_, pins_);
    w_.columns_advanced();
    ++w_.step.evaluations;
}

void RigidLeapfrog::add_energies(const EnergyAccount& from, double time, const model::WorkRates& power, EnergyAccount& to) const noexcept {
    advance(to.lost, from.lost, time, pins_.forces.account.loss);
    advance(to.work, from.work, time, power);
    advance(to.impulse, from.impulse, time, pulleys_.torque());
    advance(to.drag.impulse, from.drag.impulse, time, pulleys_.drag());
    advance(to.drag.energy, from.drag.energy, time, pulleys_.drag_power());
    advance(to.couplings.work, from.couplings.work, time, pulleys_.far_power());
    advance(to.couplings.dissipated, from.couplings.dissipated, time, pulleys_.twist_power());
}

/// Half of the kick belongs to the step behind: account_ is of the coordinates, half_way_ of the velocities.
void RigidLeapfrog::count_energy(const model::WorkRates& power) noexcept {
    kinetic_ = pins_.forces.kinetic + pulleys_.kinetic();
    add_energies(half_way_, 0.5 * kick_.step, power, account_);
    add_energies(half_way_, kick_.step, power, half_way_);
    pins_.lead = 0.5 * kick_.step;
    auto& energy = pins_.forces.account.energy;
    energy[static_cast<std::size_t>(model::Energy::kinetic)] = kinetic_;
    account_.stored = std::accumulate(energy.begin(), energy.end(), shift_);
    if (ledger_.empty()) return;
    for (std::size_t k = 0; k < model::loss_kinds; ++k) pins_.ledger[k] = ledger_[k] + account_.lost[k];
    for (std::size_t k = 0; k < model::work_kinds; ++k)
        pins_.ledger[model::loss_kinds + k] = ledger_[model::loss_kinds + k] + account_.work[k];
}

/// Moves velocities to another lead over the coordinates, by the forces of the last step; called when the length of steps changes.
void RigidLeapfrog::set_lead(double lead) noexcept {
    const double more = lead - pins_.lead;
    shift_ += (lead * lead - pins_.lead * pins_.lead) * pins_.acceleration_energy();  // ½ v·M v' at the coordinates, with no work done
    kernel_.shift(c_, more, pins_.columns);
    pulleys_.advance(more);
    add_energies(half_way_, more, pulleys_.works(), half_way_);
    pins_.lead = lead;
}

/// Whether a pin may be where or as fast as none should be; false for almost all steps without one.
bool RigidLeapfrog::is_suspect() const noexcept {
    if (!(std::abs(kinetic_) <= fastest_)) return true;
    if (pulleys_.absent()) return false;
    const model::RigidReaction& found = pins_.forces.reaction;
    const model::Pulley& pulley = w_.parameters.pulley;
    return found.deepest > w_.parameters.tip.deepest || found.innermost < pulley.innermost + radius_error ||
           found.outermost > pulley.outermost - radius_error;
}

void RigidLeapfrog::visit(engine::Archive& archive) {
    archive("cold", cold_);
    if (cold_) {
        if (archive.reads()) start();
        return;
    }
    if (archive.reads()) pins_.columns.clear_tips();
    archive("lead", pins_.lead), archive("lead_shift", shift_), archive("ledger", std::span(pins_.ledger)),
        archive("ledger_begun", std::span(ledger_));
    archive("losses", pins_.forces.account.loss);
    pulleys_.visit(archive);
    for (EnergyAccount* account : {&account_, &half_way_}) {
        archive("lost", account->lost), archive("work", account->work), archive("impulse", account->impulse);
        archive("drag", account->drag), archive("couplings", account->couplings), archive("stored", account->stored);
    }
    model::StepColumns& columns = pins_.columns;
    const auto rows = [&](const char* name, const auto& range) {
        for (auto* row = range.first; row <= range.last; row += columns.stride())
            archive(name, std::span(row, static_cast<std::size_t>(columns.pins())));
    };
    rows("pins", columns.state());
    for (const auto& range : columns.kept()) rows("filters", range);
    if (c_.remembers()) rows("friction_memory", columns.tip.remembered());
    if (!archive.reads()) return;
    for (const auto& range : columns.kept()) columns.wrap(range);
    forget_touching(columns, w_.layout().links);
}

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
    inputs_ = pulleys.inputs().at(time, s_.tail.data());
    pulleys.slope(s_.tail.data(), inputs_, s_.forces.reaction.sheaves, s_.tail_slope.data(), &s_.forces.account);
    std::copy_n(inputs_.control_rate.begin(), variator_.layout().controls, s_.tail_slope.begin() + 2 * variator_.layout().pulley_size);
}

model::WorkRates RigidPulleys::kick(double time, double step) noexcept {
    evaluate(time);
    const std::array<double, 2> rates = coupling_rates(time);
    const auto speeds = [this] {
        const model::PulleyModel& pulleys = variator_.pulleys();
        return absent_
                   ? std::array<double, 2>{}
                   : std::array{pulleys.coordinates().shaft_speed(s_.tail.data(), 0), pulleys.coordinates().shaft_speed(s_.tail.data(), 1)};
    };
    model::WorkRates power = works();
    const std::array<double, 2> turning = speeds();
    const double before = kinetic_;
    advance(step);
    mean_kinetic_ = 0.5 * (before + kinetic_);
    couple(time, rates);
    const model::WorkRates after = works();
    for (std::size_t k = 0; k < power.size(); ++k) power[k] = 0.5 * (power[k] + after[k]);
    const std::array<double, 2> turning_after = speeds();
    for (std::size_t k = 0; k < turning.size(); ++k) drag_power_[k] = 0.5 * inputs_.drag[k] * (turning[k] + turning_after[k]);
    return power;
}

void RigidPulleys::advance(double time) noexcept {
    for (std::size_t k = static_cast<std::size_t>(variator_.layout().pulley_size), end = s_.kicked_end(); k < end; ++k)
        s_.tail[k] += time * s_.tail_slope[k];
    kinetic_ = kinetic_now();
}

std::array<double, 2> RigidPulleys::coupling_rates(double time) const noexcept {
    const model::PulleyModel& pulleys = variator_.pulleys();
    std::array<double, 2> rates{};
    for (std::size_t k = 0; k < 2 && !absent_; ++k) {
        const int shaft = static_cast<int>(k);
        if (pulleys.torques().coupled(shaft)) rates[k] = pulleys.torques().coupling(time, s_.tail.data(), shaft).rate;
    }
    return rates;
}

void RigidPulleys::couple(double time, const std::array<double, 2>& rates) noexcept {
    const model::PulleyModel& pulleys = variator_.pulleys();
    far_power_ = twist_power_ = {};
    for (std::size_t k = 0; k < 2 && !absent_; ++k) {
        const int shaft = static_cast<int>(k);
        if (!pulleys.torques().coupled(shaft)) continue;
        const model::CouplingState now = pulleys.torques().coupling(time, s_.tail.data(), shaft);
        far_power_[k] = torque()[k] * pulleys.torques().reference_speed(time, shaft);
        twist_power_[k] = now.damping * rates[k] * 0.5 * (rates[k] + now.rate);  // the damper's torque is of the velocities before
    }
}

double RigidPulleys::kinetic_now() const noexcept { return absent_ ? 0.0 : variator_.pulleys().kinetic(s_.tail.data()); }

model::WorkRates RigidPulleys::works() const noexcept {
    return absent_ ? model::WorkRates{} : model::input_powers(variator_.pulleys().coordinates(), s_.tail.data(), inputs_);
}

}  // namespace cvtflow::tasks
