
#include "model/rigid/rigid_chain.hpp"

#include <algorithm>
#include <cmath>

#include "model/chain/chain_model.hpp"
#include "model/kernels/kernels.hpp"

namespace cvtflow::model {

namespace {

[[nodiscard]] std::size_t at_row(int number) noexcept { return static_cast<std::size_t>(number); }

/// Writes the reaction on all sheaves as loads of two links, one per shaft, which are added up like those of any others.
void share_reaction(const SheaveForces& sheaves, int links, LinkLoad* loads) noexcept {
    std::fill_n(loads, links, LinkLoad{});
    for (int sheave = 0; sheave < 4; ++sheave) {
        const std::array<double, 6>& f = sheaves[static_cast<std::size_t>(sheave)];
        const int side = sheave % 2;
        LinkLoad& to = loads[sheave / 2];
        to.shaft = sheave / 2;
        to.load.fx[side] = f[0];
        to.load.fy[side] = f[1];
        to.load.mx[side] = f[2];
        to.load.my[side] = f[3];
        to.load.fz[side] = f[4];
        to.load.mz[side] = f[5];
    }
}

void slopes(const ChainModel& model, const ChainRange& range, double* slope, LinkLoad* loads) noexcept {
    const RigidChain& chain = *model.rigid();
    const ChainLayout& at = model.layout();
    const int size = at.link_size();
    const double* blocks = range.window + at.halo() * at.link_block();
    const RigidInstant now = chain.evaluate(blocks, range.sheaves);
    for (int pin = 0; pin < at.links; ++pin) {
        double* to = slope + at.link_begin(pin);
        std::copy_n(blocks + at.link_begin(pin) + size, size, to);
        now.model.acceleration(now.columns, pin, to + size);
    }
    share_reaction(now.forces.reaction.sheaves, at.links, loads);
}

void observed_slopes(const ChainModel& model, const ChainRange& range, double* slope, LinkLoad* loads, Account* accounts,
                     LinkContact*) noexcept {
    slopes(model, range, slope, loads);
    const RigidChain& chain = *model.rigid();
    const Account& found = chain.last().forces.account;
    for (std::size_t kind = 0; kind < loss_kinds; ++kind) accounts->loss[kind] += found.loss[kind];
    for (std::size_t kind = 0; kind < energy_kinds; ++kind) accounts->energy[kind] += found.energy[kind];
}

void probe_links(const ChainModel& model, const double* states, int links, const SheaveMotion* sheaves, bool, TipProbe* found) noexcept {
    model.rigid()->probe(states, links, sheaves, found);
}

}  // namespace

ChainKernels RigidChain::kernels() noexcept { return {slopes, observed_slopes, probe_links}; }

RigidChain::RigidChain(const Parameters& parameters, Isa isa)
    : model_(parameters, isa), columns_(model_.columns()), strip_(2 * rigid_lanes) {}

RigidInstant RigidChain::evaluate(const double* blocks, const SheaveMotion* sheaves) const noexcept {
    model_.read(blocks, columns_);
    model_.accelerate(model_.layout().pulley_size != 0 ? sheaves : nullptr, columns_, forces_);
    return last();
}

/// Computes six links at a time: entry 0 of the strip is the pin before the first link, entries up to 8 are known, tips are those of 1 … 7.
void RigidChain::probe(const double* states, int links, const SheaveMotion* sheaves, TipProbe* probes) const noexcept {
    const ChainLayout& at = model_.layout();
    constexpr int links_at_once = rigid_lanes - 2;
    const auto x = strip_.state_position.all(), v = strip_.state_velocity.all();
    for (int first = 0; first < links; first += links_at_once) {
        const int count = std::min(links_at_once, links - first);
        for (int k = 0; k < 2 * rigid_coordinates; ++k) {
            const double scale = model_.scale(k % rigid_coordinates);
            const int place = rigid_place(at, k % rigid_coordinates) + (k < rigid_coordinates ? 0 : at.link_size());
            for (int pin = 0; pin < strip_.padded(); ++pin)
                (k < rigid_coordinates ? x[at_row(k)] : v[at_row(k - rigid_coordinates)])[pin] =
                    scale * states[(first + std::min(pin, count + 2) - 1) * at.link_block() + place];
        }
        alignas(64) double depth[rigid_tips][rigid_lanes];
        model_.kernels().depths(model_.coefficients(), sheaves, strip_, depth[0]);
        for (int link = 0; link < count; ++link) {
            const double* q = states + (first + link) * at.link_block();
            const double middle = model_.coefficients().middle, x = q[rigid_place(at, 0)], y = q[rigid_place(at, 1)];
            const double from_axis = x > middle ? x - 2.0 * middle : x;
            probes[first + link] = {{depth[2][link + 1], depth[3][link + 1], depth[0][link + 2], depth[1][link + 2]},
                                    {},
                                    std::sqrt(from_axis * from_axis + y * y)};
        }
    }
}

RigidModel::RigidModel(const Parameters& parameters, Isa isa)
    : parameters_(parameters),
      layout_(layout_of(parameters)),
      coefficients_(parameters),
      kernels_(kernels_of(isa).rigid(), kernels_of(isa).rigid_step()) {}

RigidColumns RigidModel::columns() const {
    RigidColumns columns(layout_.links);
    coefficients_.fill(parameters_, columns);
    return columns;
}

void RigidModel::accelerate(const SheaveMotion* sheaves, RigidColumns& columns, RigidForces& f) const noexcept {
    const RigidKernels<double>& kernel = kernels();
    const RigidKick kick;
    std::fill_n(columns.tip.moment - 1, columns.padded() + 2, 0.0);
    kernel.links(coefficients_, kick, columns, f.account);
    if (sheaves != nullptr) kernel.press(coefficients_, sheaves, kick, columns);
    kernel.plates(coefficients_, kick, columns, f.account);
    f.reaction = {};
    if (sheaves != nullptr) kernel.rub(coefficients_, columns, f.reaction, f.account);
    f.kinetic = kernel.kick(coefficients_, kick, columns, f.account);
}

void RigidModel::read(const double* blocks, RigidColumns& columns) const noexcept {
    for (int k = 0; k < rigid_coordinates; ++k) {
        double *x = columns.state_position.all()[at_row(k)], *v = columns.state_velocity.all()[at_row(k)];
        const double* from = blocks + rigid_place(layout_, k);
        for (int pin = 0; pin < layout_.links; ++pin, from += layout_.link_block()) {
            x[pin] = scale(k) * from[0];
            v[pin] = scale(k) * from[layout_.link_size()];
        }
    }
}

void RigidModel::acceleration(const RigidColumns& columns, int pin, double* of_pin) const noexcept {
    const auto acceleration = columns.acceleration.all();
    for (int k = 0; k < rigid_coordinates; ++k) of_pin[rigid_place(layout_, k)] = acceleration[at_row(k)][pin] / scale(k);
}

RigidState::RigidState(const RigidModel& of)
    : model(of),
      columns(of.layout().links),
      tail(static_cast<std::size_t>(2 * of.layout().pulley_size + of.layout().controls), 0.0),
      tail_slope(tail.size(), 0.0),
      ledger(of.layout().ledger ? static_cast<std::size_t>(of.layout().size() - of.layout().ledger_begin()) : 0, 0.0) {
    columns.assign(of.columns());
}

void RigidState::read(const double* y, const RigidInstant& now) {
    const ChainLayout& at = model.layout();
    lead = 0.0;
    columns.assign(now.columns);
    forces = now.forces;
    std::copy_n(y + at.pulley_begin(), tail.size(), tail.begin());
    std::copy_n(y + (at.size() - static_cast<int>(ledger.size())), ledger.size(), ledger.begin());
}

void RigidState::write(double* y) const noexcept {
    const ChainLayout& at = model.layout();
    for (int k = 0; k < rigid_coordinates; ++k) {
        const double *x = columns.state_position.all()[at_row(k)], *v = columns.state_velocity.all()[at_row(k)];
        const float* acceleration = columns.acceleration.all()[at_row(k)];
        double* to = y + rigid_place(at, k);
        for (int pin = 0; pin < at.links; ++pin, to += at.link_block()) {
            to[0] = x[pin] / model.scale(k);
            to[at.link_size()] = (v[pin] - lead * acceleration[pin]) / model.scale(k);
        }
    }
    write_tail(y + at.pulley_begin());
}

void RigidState::write_tail(double* behind) const noexcept {
    std::copy(tail.begin(), tail.end(), behind);
    for (std::size_t k = static_cast<std::size_t>(model.layout().pulley_size), end = kicked_end(); k < end; ++k)
        behind[k] = tail[k] - lead * tail_slope[k];
    std::copy(ledger.begin(), ledger.end(), behind + tail.size());
}

std::size_t RigidState::kicked_end() const noexcept {
    return tail.size() - (model.layout().hydraulic() ? static_cast<std::size_t>(hydraulic_unknowns) : 0);
}

double RigidState::acceleration_energy() const noexcept {
    const RigidCoefficients& c = model.coefficients();
    double sum = 0.0;
    for (int k = 0; k < rigid_coordinates; ++k) {
        const float* a = columns.acceleration.all()[at_row(k)];
        for (int pin = 0; pin < c.pins; ++pin) sum += 0.5 * c.inertia(k) * a[pin] * a[pin];
    }
    return sum;
}

std::size_t RigidState::bytes() const noexcept {
    return sizeof(*this) + columns.bytes() + (tail.size() + tail_slope.size() + ledger.size()) * sizeof(double);
}

}  // namespace cvtflow::model
