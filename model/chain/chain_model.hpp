#pragma once
/// The chain as a function of ranges of links: accelerations, contact gaps, energies. Pure: no time step, no thread. Kernels take it for
/// its constants; model/variator/chain.hpp makes one with the kernels of an instruction set.

#include <memory>
#include <utility>

#include "model/basis/isa.hpp"
#include "model/chain/chain_range.hpp"
#include "model/machine/coefficients.hpp"
#include "model/machine/link_inertia.hpp"

namespace cvtflow::model {

class ChainModel;
class RigidChain;

/// The chain's functions of one order and one instruction set.
struct ChainKernels {
    void (*slopes)(const ChainModel&, const ChainRange&, double*, LinkLoad*, Account*) noexcept;
    void (*observed_slopes)(const ChainModel&, const ChainRange&, double*, LinkLoad*, Account*, LinkContact*) noexcept;
    void (*probe)(const ChainModel&, const double*, const SheaveMotion*, bool, TipProbe&) noexcept;
    void (*probe_links)(const ChainModel&, const double*, int, const SheaveMotion*, bool, TipProbe*) noexcept;
};

class ChainModel {
public:
    /// @param kernels of the instruction set   @param rigid of rigid pins, else nullptr
    ChainModel(Coefficients coefficients, const LinkInertia& inertia, Isa isa, const ChainKernels& kernels,
               std::shared_ptr<const RigidChain> rigid)
        : coefficients_(std::move(coefficients)), inertia_(inertia), isa_(isa), kernels_(kernels), rigid_(std::move(rigid)) {}

    [[nodiscard]] Isa isa() const noexcept { return isa_; }

    [[nodiscard]] const Coefficients& coefficients() const noexcept { return coefficients_; }
    [[nodiscard]] const ChainLayout& layout() const noexcept { return coefficients_.layout; }
    [[nodiscard]] const LinkInertia& inertia() const noexcept { return inertia_; }
    /// The chain of rigid pins, which is evaluated in one range and by one caller at a time; nullptr with pin halves.
    [[nodiscard]] const RigidChain* rigid() const noexcept { return rigid_.get(); }

    /// Slopes [v | acceleration] of the links of a range, link_block() numbers each, to slope + (link - first) link_block();
    /// reactions on the sheaves to loads[link - first] where a tip touches.
    void slopes(const ChainRange& range, double* slope, LinkLoad* loads) const noexcept {
        kernels_.slopes(*this, range, slope, loads, nullptr);
    }
    /// slopes(), with losses and stored energies of each link (joint of pin i booked on link i) to accounts[account_parts (link - first) +
    /// part]. Accounts must be cleared before.
    /// @param contacts what each link of the range carries, contacts[link - first]; nullptr: not needed
    void observed_slopes(const ChainRange& range, double* slope, LinkLoad* loads, Account* accounts,
                         LinkContact* contacts = nullptr) const noexcept {
        kernels_.observed_slopes(*this, range, slope, loads, accounts, contacts);
    }
    /// Depth of the four tips of one link, whatever their phase. `state` is the link's block; with rigid pins one more lies before it and
    /// two behind (NeighbourWindow).
    /// @param slip whether slip is computed: only the phases stick and slip need it
    void probe(const double* state, const SheaveMotion* sheaves, bool slip, TipProbe& probe) const noexcept {
        kernels_.probe(*this, state, sheaves, slip, probe);
    }
    /// probe(), bit by bit, for `links` neighbouring links. @param states their blocks (of rigid pins: with one more before and
    /// two behind)   @param probes [links]
    void probe_links(const double* states, int links, const SheaveMotion* sheaves, bool slip, TipProbe* probes) const noexcept {
        kernels_.probe_links(*this, states, links, sheaves, slip, probes);
    }
    /// The oil between tips and sheaves has another temperature: the lubricated law changes in place, for all that was made of this chain.
    /// Between steps only. temperature [K]
    void warm(const Parameters& parameters, double temperature) noexcept {
        if (coefficients_.tip.law != nullptr) model::warm(*coefficients_.tip.law, parameters, temperature);
    }
    /// Number of the shaft that a link belongs to: its middle lies nearer. state [unknowns]
    [[nodiscard]] int shaft_of(const double* state) const noexcept {
        const ChainLayout& at = layout();
        return state[at.x(End::rear, 0)] + state[at.x(End::front, 0)] < coefficients_.centre_distance ? 0 : 1;
    }

private:
    Coefficients coefficients_;
    LinkInertia inertia_;
    Isa isa_;
    ChainKernels kernels_;
    std::shared_ptr<const RigidChain> rigid_;
};

}  // namespace cvtflow::model
