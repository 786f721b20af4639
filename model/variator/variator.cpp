
#include "model/variator/variator.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <tuple>
#include <utility>

#include "model/contact/friction_operator.hpp"
#include "model/force/tips.hpp"
#include "model/kernels/kernels.hpp"
#include "model/rigid/rigid_chain.hpp"

namespace cvtflow::model {

namespace {

void add(const SheaveLoad& load, SheaveLoad& total) noexcept {
    for (int side = 0; side < 2; ++side) {
        total.fx[side] += load.fx[side];
        total.fy[side] += load.fy[side];
        total.fz[side] += load.fz[side];
        total.mx[side] += load.mx[side];
        total.my[side] += load.my[side];
        total.mz[side] += load.mz[side];
    }
}

using ShaftLoads = std::array<SheaveLoad, 2>;

void add(const SheaveSum& sum, const SheaveSum& other, ShaftLoads& total) noexcept {
    const auto shaft = static_cast<std::size_t>(sum.shaft);
    add(sum.load, total[shaft]);
    if (sum.both) add(other.load, total[1 - shaft]);
}

[[nodiscard]] SheaveForces forces_of(const ShaftLoads& loads) noexcept {
    SheaveForces forces;
    for (std::size_t sheave = 0; sheave < forces.size(); ++sheave) {
        const SheaveLoad& load = loads[sheave / 2];
        const std::size_t side = sheave % 2;
        forces[sheave] = {load.fx[side], load.fy[side], load.mx[side], load.my[side], load.fz[side], load.mz[side]};
    }
    return forces;
}

}  // namespace

bool Variator::same_machine(const Parameters& a, const Parameters& b) {
    const auto machine = [](const Parameters& of) {
        const double place_of_guides = of.guide.present() ? of.start.ratio : 0.0;
        return std::tuple_cat(std::tie(of.detail, of.chain, of.half, of.plate, of.joint, of.tip, of.oil, of.wear, of.pulley,
                                       of.imperfection, of.guide, of.control.enabled, of.control.driven, of.hydraulics.mode, of.ledger),
                              std::tuple(place_of_guides));
    };
    return machine(a) == machine(b);
}

void Variator::adopt(const Parameters& before, const Parameters& p) {
    if (!same_machine(before, p)) chain_ = make_chain(p, chain_.isa());
    pulleys_.adopt(p);
}

void Variator::add_up(int group, const Phase* phases, const LinkLoad* loads, SheaveSum& sum, SheaveSum& other) const noexcept {
    sum = {};
    bool any = false;
    const int last = std::min(layout().links, links_per_sum * (group + 1));
    for (int link = links_per_sum * group; link < last; ++link) {
        if (!layout().rigid && !touches(phases, link)) continue;
        const int shaft = loads[link].shaft;
        if (!std::exchange(any, true)) sum.shaft = shaft;
        if (shaft != sum.shaft && !std::exchange(sum.both, true)) other = {};
        add(loads[link].load, shaft == sum.shaft ? sum.load : other.load);
    }
}

SheaveForces Variator::sheave_forces(const Phase* phases, const SheaveSum* sums) const noexcept {
    ShaftLoads total{};
    for (int group = 0; group < this->sums(); ++group) {
        bool adds = layout().rigid;
        for (int link = links_per_sum * group; link < std::min(layout().links, links_per_sum * (group + 1)); ++link)
            adds |= touches(phases, link);
        if (adds) add(sums[group], sums[this->sums() + group], total);
    }
    return forces_of(total);
}

SheaveForces Variator::sheave_forces(const Phase* phases, const LinkLoad* loads) const noexcept {
    ShaftLoads total{};
    SheaveSum sum, other;
    for (int group = 0; group < sums(); ++group) {
        add_up(group, phases, loads, sum, other);
        add(sum, other, total);
    }
    return forces_of(total);
}

void Variator::close(double t, const double* tail, const SheaveForces& chain, const Account* accounts, double* tail_slope) const noexcept {
    const ChainLayout& at = layout();
    Account total;
    WorkRates works{};
    if (at.pulley_size != 0) {
        const Inputs inputs = pulleys_.inputs().at(t, tail);
        pulleys_.slope(tail, inputs, chain, tail_slope, at.ledger ? &total : nullptr);
        std::copy_n(inputs.control_rate.begin(), at.controls, tail_slope + 2 * at.pulley_size);
        works = input_powers(pulleys_.coordinates(), tail, inputs);
    }
    if (!at.ledger) return;
    for (int part = 0; part < account_parts * at.links; ++part) {
        for (std::size_t kind = 0; kind < loss_kinds; ++kind) total.loss[kind] += accounts[part].loss[kind];
    }
    double* ledger = tail_slope + at.ledger_begin() - at.pulley_begin();
    std::memcpy(ledger, total.loss.data(), sizeof total.loss);
    std::memcpy(ledger + loss_kinds, works.data(), sizeof works);
}

EvaluationScratch::EvaluationScratch(const ChainLayout& layout)
    : window(static_cast<std::size_t>((layout.links + 2 * layout.halo()) * layout.link_block())),
      loads(static_cast<std::size_t>(layout.links)),
      accounts(static_cast<std::size_t>(account_parts * layout.links)) {}

void fill_window(const Variator& variator, const double* state, EvaluationScratch& scratch) noexcept {
    const ChainLayout& at = variator.layout();
    const std::size_t block = static_cast<std::size_t>(at.link_block());
    double* window = scratch.window.data();
    const auto copy = [&](int link, int links, int place) {
        std::memcpy(window + static_cast<std::size_t>(place) * block, state + at.link_begin(link),
                    static_cast<std::size_t>(links) * block * sizeof(double));
    };
    copy(0, at.links, at.halo());
    for (int k = 0; k < at.halo(); ++k) {
        copy(at.wrapped(k - at.halo()), 1, k);
        copy(at.wrapped(k), 1, at.halo() + at.links + k);
    }
}

void right_hand_side(const Variator& variator, double t, const double* state, const Phase* phases, double* slope,
                     EvaluationScratch& scratch) noexcept {
    const ChainLayout& at = variator.layout();
    fill_window(variator, state, scratch);
    if (at.pulley_size != 0) variator.pulleys().motions(state + at.pulley_begin(), scratch.sheaves);
    const ChainRange range{0, at.links, scratch.window.data(), scratch.sheaves, phases};
    if (at.ledger) {
        for (Account& account : scratch.accounts) account = {};
        variator.chain().observed_slopes(range, slope, scratch.loads.data(), scratch.accounts.data());
    } else {
        variator.chain().slopes(range, slope, scratch.loads.data());
    }
    variator.close(t, state + at.pulley_begin(), variator.sheave_forces(phases, scratch.loads.data()), scratch.accounts.data(),
                   slope + at.pulley_begin());
}

/// Rigid pins and the chain share one friction law of the tips, which warm() changes in place.
ChainModel make_chain(const Parameters& parameters, Isa isa) {
    Coefficients coefficients(parameters);
    const LinkInertia inertia = link_inertia(parameters);
    if (parameters.detail.pins != PinDetail::rigid) return {std::move(coefficients), inertia, isa, kernels_of(isa).chain(), nullptr};
    auto rigid = std::make_shared<const RigidChain>(parameters, isa);
    coefficients.tip.law = rigid->model().coefficients().tip_law;
    return {std::move(coefficients), inertia, isa, RigidChain::kernels(), std::move(rigid)};
}

FrictionOperator make_friction(const ChainModel& chain) { return {chain, kernels_of(chain.isa()).friction()}; }

}  // namespace cvtflow::model
