#include "model/observe/observation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "model/basis/portable_math.hpp"
#include "model/force/guide.hpp"

namespace cvtflow::model {

namespace {

[[nodiscard]] std::size_t index_of(int number) noexcept { return static_cast<std::size_t>(number); }

}  // namespace

Observer::Observer(const Variator& variator)
    : variator_(variator), scratch_(variator.layout()), slope_(index_of(variator.layout().pulley_begin())) {
    const ChainLayout& at = variator.layout();
    const std::size_t links = index_of(at.links);
    observation_.tension.resize(links);
    observation_.tip_axial.resize(tips_per_link * links);
    contacts_.resize(links);
    tail_.resize(index_of(at.size() - at.pulley_begin()));
}

void Observer::begin(double t) noexcept {
    observation_.time = t;
    observation_.guide = {};
    forces_known_ = false;
    state_ = nullptr;
    rigid_.emplace<std::monostate>();
}

const Observation& Observer::observe(double t, const double* state, const Phase* phases, const EvaluatedLinks* evaluated) noexcept {
    const ChainLayout& at = variator_.layout();
    Account& total = observation_.account;
    begin(t);
    state_ = state;
    pulleys_ = state + at.pulley_begin();
    if (at.pulley_size != 0) variator_.pulleys().motions(pulleys_, scratch_.sheaves);
    if (const RigidChain* chain = variator_.chain().rigid()) {
        const auto& now = rigid_.emplace<RigidInstantOf<double>>(chain->evaluate(state, scratch_.sheaves));
        total = now.forces.account;
        total.store(Energy::kinetic, now.forces.kinetic);
        observe_rigid(now);
    } else {
        observe_halves(state, phases, evaluated != nullptr ? *evaluated : evaluate_halves(state, phases));
    }
    if (at.pulley_size != 0) variator_.pulleys().account(pulleys_, total);
    return observation_;
}

const Observation& Observer::observe(double t, const RigidState& pins) noexcept {
    begin(t);
    pins.write_tail(tail_.data());
    pulleys_ = tail_.data();
    observation_.account = pins.forces.account;
    observe_rigid(rigid_.emplace<RigidInstantOf<float>>(pins.instant()));
    return observation_;
}

EvaluatedLinks Observer::evaluate_halves(const double* state, const Phase* phases) noexcept {
    const int links = variator_.layout().links;
    std::fill(scratch_.accounts.begin(), scratch_.accounts.end(), Account{});
    fill_window(variator_, state, scratch_);
    variator_.chain().observed_slopes({0, links, scratch_.window.data(), scratch_.sheaves, phases}, slope_.data(), scratch_.loads.data(),
                                      scratch_.accounts.data(), contacts_.data());
    variator_.chain().book_kinetic(state, links, scratch_.accounts.data());
    return {scratch_.loads.data(), scratch_.accounts.data(), contacts_.data()};
}

void Observer::observe_halves(const double* state, const Phase* phases, const EvaluatedLinks& evaluated) noexcept {
    const ChainLayout& at = variator_.layout();
    observation_.account = total_of({evaluated.accounts, index_of(account_parts * at.links)});
    seen_ = evaluated.contacts;
    sheave_forces_ = variator_.sheave_forces(phases, evaluated.loads);
    observe_links(state, phases);
    observe_strands(state, phases);
    if (at.pulley_size == 0) return;
    observe_radii(state, phases);
    observe_pulleys();
}

void Observer::observe_links(const double* state, const Phase* phases) noexcept {
    const ChainLayout& at = variator_.layout();
    Observation& o = observation_;
    o.touching = 0;
    o.deepest = 0.0;
    o.creep = {};
    double speed = 0.0;
    const bool guided = variator_.chain().coefficients().guide.present;
    for (int link = 0; link < at.links; ++link) {
        const LinkContact& contact = seen_[link];
        o.tension[index_of(link)] = contact.tension;
        const double* v = state + at.link_begin(link) + at.link_size();
        speed += portable_hypot(v[at.x(End::rear, 0)], v[at.y(End::rear, 0)]);
        if (guided) {
            const double* q = v - at.link_size();
            for (const End end : {End::rear, End::front})
                observe_guide(0.5, q[at.x(end, 0)], q[at.y(end, 0)], v[at.x(end, 0)], v[at.y(end, 0)]);
        }
        for (int tip = 0; tip < tips_per_link; ++tip) {
            o.tip_axial[index_of(tips_per_link * link + tip)] = contact.axial[tip];
            if (phases[tips_per_link * link + tip] == Phase::free) continue;
            ++o.touching;
            o.deepest = std::max(o.deepest, contact.depth[tip]);
            o.creep.hold[index_of(contact.shaft)] += contact.hold[tip];
            o.creep.drag[index_of(contact.shaft)] += contact.drag[tip];
            o.creep.power += contact.creep_power[tip];
        }
    }
    o.chain_speed = speed / at.links;
}

void Observer::observe_strands(const double* state, const Phase* phases) noexcept {
    const ChainLayout& at = variator_.layout();
    double sum[2] = {0.0, 0.0};
    int count[2] = {0, 0};
    for (int link = 0; link < at.links; ++link) {
        // A strand's inner links: their neighbours are loose as well.
        if (touches(phases, link) || touches(phases, at.previous(link)) || touches(phases, at.next(link))) continue;
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
        if (!touches(phases, pin) || !touches(phases, before)) continue;
        const double* rear = state + at.link_begin(pin);
        const double* front = state + at.link_begin(before);
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

void Observer::observe_rigid(const auto& now) noexcept {
    const auto& columns = now.columns;
    Observation& o = observation_;
    const auto *all = columns.plate.tension, *damping = columns.damping.stretch;
    for (int link = 0; link < columns.pins(); ++link) o.tension[index_of(link)] = all[link] - damping[link];
    for (int tip = 0; tip < tips_per_link; ++tip) {
        for (int link = 0; link < columns.pins(); ++link)
            o.tip_axial[index_of(tips_per_link * link + tip)] = now.of_tip(columns.tip.sheave_axial, link, tip);
    }
    if (variator_.chain().coefficients().guide.present) {
        const auto &at = columns.state_position.middle, &v = columns.state_velocity.middle;
        for (int pin = 0; pin < columns.pins(); ++pin) observe_guide(1.0, at.x[pin], at.y[pin], v.x[pin], v.y[pin]);
    }
    const RigidSums sums = now.sums();
    const auto mean = [](double sum, double count) { return count > 0.0 ? sum / count : 0.0; };
    o.chain_speed = sums.speed / columns.pins();
    o.touching = static_cast<int>(sums.touching);
    o.deepest = std::max(0.0, now.forces.reaction.deepest);
    o.tight = mean(sums.tension[0], sums.links[0]);
    o.slack = mean(sums.tension[1], sums.links[1]);
    sheave_forces_ = now.forces.reaction.sheaves;
    if (variator_.layout().pulley_size == 0) {
        o.tight = o.slack = mean(sums.tension[0] + sums.tension[1], sums.links[0] + sums.links[1]);
        return;
    }
    for (std::size_t k = 0; k < 2; ++k) {
        o.radius[k] = mean(sums.radius[k], sums.pins[k]);
        o.pin_speed[k] = mean(sums.turning[k], sums.pins[k]);
    }
    o.creep = {sums.hold, sums.drag, sums.creep_power};
    observe_pulleys();
}

const ForceObservation& Observer::forces() {
    if (forces_known_ || pulleys_ == nullptr) return forces_;
    if (const auto* in_doubles = std::get_if<1>(&rigid_))
        observe_forces(variator_.chain(), *in_doubles, forces_.chain);
    else if (const auto* of_step = std::get_if<2>(&rigid_))
        observe_forces(variator_.chain(), *of_step, forces_.chain);
    else
        observe_forces(variator_.chain(), state_, seen_, forces_.chain);
    if (variator_.layout().pulley_size != 0) {
        const PulleyModel& pulleys = variator_.pulleys();
        pulleys.motions(pulleys_, scratch_.sheaves);
        const Inputs inputs = pulleys.inputs().at(observation_.time, pulleys_);
        forces_.bearing = pulleys.bearings(pulleys_, inputs, sheave_forces_);
        const SheaveMotion* s = scratch_.sheaves;
        forces_.misalignment = 0.5 * (s[0].z + s[1].z) - 0.5 * (s[2].z + s[3].z);
    }
    forces_known_ = true;
    return forces_;
}

const Observation& Observer::observe_shafts(double t, const double* behind) noexcept {
    begin(t);
    pulleys_ = nullptr;
    if (variator_.layout().pulley_size != 0) read_shafts(behind);
    return observation_;
}

void Observer::read_shafts(const double* behind) noexcept {
    const PulleyModel& pulleys = variator_.pulleys();
    Observation& o = observation_;
    const Inputs inputs = pulleys.inputs().at(o.time, behind);
    o.work = input_powers(pulleys.coordinates(), behind, inputs);
    o.torque = {inputs.drive_torque, inputs.load_torque};
    o.drag = inputs.drag;
    o.clamping = inputs.clamping;
    o.hydraulics = pulleys.inputs().hydraulics(o.time, behind);
    o.hydraulic_energy = pulleys.inputs().hydraulic_energy(behind);
    o.control_limited = inputs.control_limited;
    o.at_floor = inputs.at_floor;
    o.control = pulleys.inputs().controlled(o.time, behind, inputs);
    for (int shaft = 0; shaft < 2; ++shaft) {
        const std::size_t k = index_of(shaft);
        o.speed[k] = pulleys.coordinates().shaft_speed(behind, shaft);
        o.angle[k] = behind[pulleys.coordinates().rotation(shaft)];
        o.sheave_position[k] = pulleys.coordinates().opening(behind, shaft);
    }
    o.ratio = o.speed[0] / o.speed[1];
}

void Observer::observe_pulleys() noexcept {
    Observation& o = observation_;
    read_shafts(pulleys_);
    for (std::size_t sheave = 0; sheave < 4; ++sheave) o.axial_force[sheave] = sheave_forces_[sheave][4];
    for (std::size_t k = 0; k < 2; ++k) o.chain_torque[k] = sheave_forces_[2 * k][5] + sheave_forces_[2 * k + 1][5];
    if (o.speed[0] < 0.0) {  // the driving sheaves pull the other strand
        std::swap(o.tight, o.slack);
        std::swap(o.guide[0], o.guide[1]);
    }
    observe_slip();
}

void Observer::observe_guide(double part, double x, double y, double vx, double vy) noexcept {
    const GuideCoefficients& guide = variator_.chain().coefficients().guide;
    const GuideContact<1> contact(guide, part, x, y, vx, vy);
    if (contact.share[0] == 0.0) return;
    GuideLoad& load = observation_.guide[y > 0.0 ? 0 : 1];
    load.force += contact.normal[0];
    if (std::abs(contact.offset[0]) > std::abs(load.deflection)) load.deflection = contact.offset[0];
}

/// A pulley that no tip holds turns freely.
void Observer::observe_slip() noexcept {
    Observation& o = observation_;
    const Creep& creep = o.creep;
    for (std::size_t k = 0; k < 2; ++k) o.free_speed[k] = o.speed[k] + (creep.hold[k] > 0.0 ? creep.drag[k] / creep.hold[k] : 0.0);
    const auto against = [&](const std::array<double, 2>& pins) {
        const double geared = o.speed[0] * pins[1];
        return geared != 0.0 ? 1.0 - pins[0] * o.speed[1] / geared : 0.0;
    };
    o.slip = against(o.pin_speed);
    o.friction_slip = against(o.free_speed);
    o.limit_use = 0.0;
    const SpeedProfile& limit = variator_.chain().coefficients().clamping_limit;
    for (std::size_t k = 0; k < 2; ++k) {
        const double bearable = limit.at(std::abs(o.speed[k] - o.pin_speed[k]) * o.radius[k]);
        if (bearable > 0.0) o.limit_use = std::max(o.limit_use, o.clamping[k] / bearable);
    }
    const double brought = std::max(0.0, o.work[0]) + std::max(0.0, o.work[1]);
    o.loss_slip = brought > 0.0 ? creep.power / brought : 0.0;
}

}  // namespace cvtflow::model
