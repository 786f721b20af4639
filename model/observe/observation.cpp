#include "model/observe/observation.hpp"

#include <algorithm>
#include <cmath>

#include "model/basis/portable_math.hpp"
#include "model/observe/chain_forces.hpp"
#include "model/rigid/rigid_chain.hpp"

namespace cvtflow::model {

Observer::Observer(const Variator& variator)
    : variator_(variator), scratch_(variator.layout()), slope_(static_cast<std::size_t>(variator.layout().size())) {
    const std::size_t links = static_cast<std::size_t>(variator.layout().links);
    observation_.tension.resize(links);
    observation_.tip_axial.resize(tips_per_link * links);
    contacts_.resize(links);
}

const Observation& Observer::observe(double t, const double* state, const Phase* phases) noexcept {
    const ChainLayout& at = variator_.layout();
    Observation& o = observation_;
    o.time = t;
    state_ = state;
    phases_ = phases;
    forces_known_ = false;
    if (at.pulley_size != 0) variator_.pulleys().motions(state + at.pulley_begin(), scratch_.sheaves);
    observe_chain(state, phases);
    observe_links(state, phases);
    observe_strands(state, phases);
    if (at.pulley_size != 0) {
        observe_radii(state, phases);
        observe_pulleys(t, state, phases);
    }
    o.account.store(Energy::kinetic, kinetic(state));
    return o;
}

void Observer::observe_chain(const double* state, const Phase* phases) noexcept {
    Account& total = observation_.account;
    if (const RigidChain* rigid = variator_.chain().rigid()) {
        rigid->evaluate(state, scratch_.sheaves);
        rigid->show_contacts(contacts_.data());
        total = rigid->forces().account;
        sheave_forces_ = rigid->forces().reaction.sheaves;
        return;
    }
    total = {};
    std::fill(scratch_.accounts.begin(), scratch_.accounts.end(), Account{});
    fill_window(variator_, state, scratch_);
    variator_.chain().observed_slopes({0, variator_.layout().links, scratch_.window.data(), scratch_.sheaves, phases}, slope_.data(),
                                      scratch_.loads.data(), scratch_.accounts.data(), contacts_.data());
    for (const Account& account : scratch_.accounts) {
        for (std::size_t kind = 0; kind < loss_kinds; ++kind) total.loss[kind] += account.loss[kind];
        for (std::size_t kind = 0; kind < energy_kinds; ++kind) total.energy[kind] += account.energy[kind];
    }
    sheave_forces_ = variator_.sheave_forces(phases, scratch_.loads.data());
}

const ForceObservation& Observer::forces() {
    if (forces_known_ || state_ == nullptr) return forces_;
    const ChainLayout& at = variator_.layout();
    observe_forces(variator_.chain(), state_, scratch_.sheaves, phases_, forces_.chain);
    if (at.pulley_size != 0) {
        const PulleyModel& pulleys = variator_.pulleys();
        const double* block = state_ + at.pulley_begin();
        const Inputs inputs = pulleys.inputs(observation_.time, block);
        forces_.bearing = pulleys.bearings(block, inputs, sheave_forces_);
        const SheaveMotion* s = scratch_.sheaves;
        forces_.misalignment = 0.5 * (s[0].z + s[1].z) - 0.5 * (s[2].z + s[3].z);
    }
    forces_known_ = true;
    return forces_;
}

void Observer::observe_links(const double* state, const Phase* phases) noexcept {
    const ChainLayout& at = variator_.layout();
    Observation& o = observation_;
    o.touching = 0;
    o.deepest = 0.0;
    double speed = 0.0;
    for (int link = 0; link < at.links; ++link) {
        const LinkContact& contact = contacts_[static_cast<std::size_t>(link)];
        o.tension[static_cast<std::size_t>(link)] = contact.tension;
        const double* v = state + at.link_begin(link) + at.link_size();
        speed += portable_hypot(v[at.x(End::rear, 0)], v[at.y(End::rear, 0)]);
        for (int tip = 0; tip < tips_per_link; ++tip) {
            o.tip_axial[static_cast<std::size_t>(tips_per_link * link + tip)] = contact.axial[tip];
            if (phases[tips_per_link * link + tip] == Phase::free) continue;
            ++o.touching;
            o.deepest = std::max(o.deepest, contact.depth[tip]);
        }
    }
    o.chain_speed = speed / at.links;
}

namespace {

/// Whether no tip of a link touches.
[[nodiscard]] bool loose(const Phase* phases, int link) noexcept {
    return std::all_of(phases + tips_per_link * link, phases + tips_per_link * (link + 1),
                       [](Phase phase) { return phase == Phase::free; });
}

}  // namespace

void Observer::observe_strands(const double* state, const Phase* phases) noexcept {
    const ChainLayout& at = variator_.layout();
    double sum[2] = {0.0, 0.0};
    int count[2] = {0, 0};
    for (int link = 0; link < at.links; ++link) {
        // A strand's inner links: their neighbours are loose as well.
        if (!loose(phases, link) || !loose(phases, at.previous(link)) || !loose(phases, at.next(link))) continue;
        const int strand = at.pulley_size != 0 && state[at.link_begin(link) + at.y(End::rear, 0)] < 0.0 ? 1 : 0;
        sum[strand] += observation_.tension[static_cast<std::size_t>(link)];
        ++count[strand];
    }
    observation_.tight = count[0] > 0 ? sum[0] / count[0] : 0.0;
    observation_.slack = count[1] > 0 ? sum[1] / count[1] : (at.pulley_size == 0 ? observation_.tight : 0.0);
}

void Observer::observe_radii(const double* state, const Phase* phases) noexcept {
    const ChainLayout& at = variator_.layout();
    const auto middle = [&](const double* rear, const double* front, int offset_rear, int offset_front) {
        return 0.5 * (rear[offset_rear] + front[offset_front]);
    };
    double radius[2] = {0.0, 0.0};
    double turning[2] = {0.0, 0.0};
    int count[2] = {0, 0};
    for (int pin = 0; pin < at.links; ++pin) {
        const int before = at.previous(pin);  // link of its front half's tips
        if (loose(phases, pin) || loose(phases, before)) continue;
        const double* rear = state + at.link_begin(pin);
        const double* front = state + at.link_begin(at.rigid ? pin : before);
        const int shaft = variator_.chain().shaft_of(rear);
        const double x =
            middle(rear, front, at.x(End::rear, 0), at.x(End::front, 0)) - shaft * variator_.chain().coefficients().centre_distance;
        const double y = middle(rear, front, at.y(End::rear, 0), at.y(End::front, 0));
        const double vx = middle(rear, front, at.link_size() + at.x(End::rear, 0), at.link_size() + at.x(End::front, 0));
        const double vy = middle(rear, front, at.link_size() + at.y(End::rear, 0), at.link_size() + at.y(End::front, 0));
        radius[shaft] += portable_hypot(x, y);
        turning[shaft] += (x * vy - y * vx) / (x * x + y * y);
        ++count[shaft];
    }
    for (std::size_t shaft = 0; shaft < 2; ++shaft) {
        observation_.radius[shaft] = count[shaft] > 0 ? radius[shaft] / count[shaft] : 0.0;
        observation_.pin_speed[shaft] = count[shaft] > 0 ? turning[shaft] / count[shaft] : 0.0;
    }
}

void Observer::observe_pulleys(double t, const double* state, const Phase* phases) noexcept {
    const ChainLayout& at = variator_.layout();
    const PulleyModel& pulleys = variator_.pulleys();
    const double* block = state + at.pulley_begin();
    Observation& o = observation_;
    const Inputs inputs = pulleys.inputs(t, block);
    const SheaveForces& forces = sheave_forces_;
    pulleys.slope(block, inputs, forces, slope_.data() + at.pulley_begin(), &o.account);
    o.work = pulleys.works(block, inputs);
    o.torque = {inputs.drive_torque, inputs.load_torque};
    o.clamping = inputs.clamping;
    o.hydraulics = pulleys.hydraulics(t, block);
    o.hydraulic_energy = pulleys.hydraulic_energy(block);
    o.control_limited = inputs.control_limited;
    for (std::size_t sheave = 0; sheave < 4; ++sheave) o.axial_force[sheave] = forces[sheave][4];
    for (int shaft = 0; shaft < 2; ++shaft) {
        const std::size_t k = static_cast<std::size_t>(shaft);
        o.speed[k] = pulleys.shaft_speed(block, shaft);
        o.angle[k] = block[pulleys.rotation(shaft)];
        o.sheave_position[k] = pulleys.clamped_position(block, shaft);
        o.chain_torque[k] = forces[2 * k][5] + forces[2 * k + 1][5];
    }
    o.ratio = o.speed[0] / o.speed[1];
    observe_slip(state, phases);
}

/// A pulley that no tip holds turns freely.
void Observer::observe_slip(const double* state, const Phase* phases) noexcept {
    Observation& o = observation_;
    const Creep creep = observe_creep(variator_.chain(), state, scratch_.sheaves, phases);
    for (std::size_t k = 0; k < 2; ++k) o.free_speed[k] = o.speed[k] + (creep.hold[k] > 0.0 ? creep.drag[k] / creep.hold[k] : 0.0);
    const auto against = [&](const std::array<double, 2>& pins) {
        const double geared = o.speed[0] * pins[1];
        return geared != 0.0 ? 1.0 - pins[0] * o.speed[1] / geared : 0.0;
    };
    o.slip = against(o.pin_speed);
    o.friction_slip = against(o.free_speed);
    o.creep_power = creep.power;
    o.limit_use = 0.0;
    const SpeedProfile& limit = variator_.chain().coefficients().clamping_limit;
    for (std::size_t k = 0; k < 2; ++k) {
        const double bearable = limit.at(std::abs(o.speed[k] - o.pin_speed[k]) * o.radius[k]);
        if (bearable > 0.0) o.limit_use = std::max(o.limit_use, o.clamping[k] / bearable);
    }
    const double brought = std::max(0.0, o.work[0]) + std::max(0.0, o.work[1]);
    o.loss_slip = brought > 0.0 ? o.creep_power / brought : 0.0;
}

double Observer::kinetic(const double* state) const noexcept {
    const ChainLayout& at = variator_.layout();
    const RigidChain* rigid = variator_.chain().rigid();
    double energy = rigid != nullptr ? rigid->kinetic() : 0.0;
    for (int link = 0; link < at.links && rigid == nullptr; ++link) {
        energy += kinetic_energy(variator_.chain().inertia(), state + at.link_begin(link) + at.link_size());
    }
    return at.pulley_size != 0 ? energy + variator_.pulleys().kinetic(state + at.pulley_begin()) : energy;
}

}  // namespace cvtflow::model
