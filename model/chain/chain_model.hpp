#pragma once
/// The chain as a function of ranges of links: accelerations, contact gaps, energies. Pure: no time step, no thread. Kernels take it for
/// its constants; make_chain() (model/variator/variator.hpp) makes one with the kernels of an instruction set.
///
/// A *window* holds the states of links first-1 … last (one neighbour on each side), contiguous, link_block() numbers each: all that the
/// evaluation of a range [first, last) of links depends on. With rigid pins it holds ChainLayout::halo() of them on each side.

#include <memory>
#include <utility>

#include "model/basis/isa.hpp"
#include "model/force/account.hpp"
#include "model/force/sheave_motion.hpp"
#include "model/machine/coefficients.hpp"
#include "model/machine/link_inertia.hpp"
#include "model/parameters/chain_layout.hpp"

namespace cvtflow::model {

/// Reaction of a link's tips on the sheaves of its pulley. Only written for links with a touching tip.
struct LinkLoad {
    SheaveLoad load;
    int shaft;  ///< 0 or 1: whose sheaves
};

/// A range of links and where its inputs are.
struct ChainRange {
    int first, last;              ///< [first, last)
    const double* window;         ///< states of links first-1 … last, or more by the layout's halo [m, m/s]
    const SheaveMotion* sheaves;  ///< [4] number 2 shaft + side; unused if the scene has no pulleys
    const Phase* phases;          ///< [links * 4], of the whole chain
    int shift = 1;                ///< column of a link in fields of contacts: its number + shift
    bool room = false;            ///< no other range shares these fields, and they have room for a group of lanes behind the range
};

/// Contact of one link's tips with its sheaves, for transitions and faults.
struct TipProbe {
    double depth[tips_per_link];  ///< δ [m], negative: gap
    double slip[tips_per_link];   ///< |v_t| [m/s], 0 if not requested
    double radius;                ///< distance of the link's middle from its shaft's axis [m]
};

/// Forces of a link, for observation. Tips are zero where none of the link's touches.
struct LinkContact {
    double tension = 0.0;                   ///< sum of its plates' elastic tensions [N]
    int shaft = 0;                          ///< whose sheaves they touch
    double depth[tips_per_link] = {};       ///< δ [m], negative: gap
    double normal[tips_per_link] = {};      ///< N [N]
    double axial[tips_per_link] = {};       ///< force of each tip on its sheave along z [N]
    double tangential[tips_per_link] = {};  ///< force along the circumference, in the sense of positive rotation [N]
    double radial[tips_per_link] = {};      ///< away from the shaft's axis [N]
    double radius[tips_per_link] = {};      ///< distance of the contact from that axis [m]
    double sliding[tips_per_link] = {};     ///< speed along the sheave's surface [m/s]
    double power[tips_per_link] = {};       ///< lost by friction [W]
    double hold[tips_per_link] = {}, drag[tips_per_link] = {}, creep_power[tips_per_link] = {};  ///< members of Creep [N·m·s], [N·m], [W]
};

/// The block of one link with the neighbours that contact of rigid pins depends on: one before, two behind. With pin halves it is the block
/// itself.
class NeighbourWindow {
public:
    /// @param state of the whole chain [unknowns]
    [[nodiscard]] const double* of(const ChainLayout& layout, const double* state, int link) noexcept;

private:
    static constexpr int before = 1, blocks = before + 3;
    double numbers_[blocks * max_link_block / 2];
};

class ChainModel;
class RigidChain;

/// The chain's functions of one instruction set.
struct ChainKernels {
    void (*slopes)(const ChainModel&, const ChainRange&, double*, LinkLoad*) noexcept;
    void (*observed_slopes)(const ChainModel&, const ChainRange&, double*, LinkLoad*, Account*, LinkContact*) noexcept;
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
    void slopes(const ChainRange& range, double* slope, LinkLoad* loads) const noexcept { kernels_.slopes(*this, range, slope, loads); }
    /// slopes(), with losses and stored energies of each link (joint of pin i booked on link i) to accounts[account_parts (link - first) +
    /// part]. Accounts must be cleared before. Without slopes of pin halves if slope is nullptr.
    /// @param contacts what each link of the range carries, contacts[link - first]; nullptr: not needed
    void observed_slopes(const ChainRange& range, double* slope, LinkLoad* loads, Account* accounts,
                         LinkContact* contacts = nullptr) const noexcept {
        kernels_.observed_slopes(*this, range, slope, loads, accounts, contacts);
    }
    /// Kinetic energy of each of `links` neighbouring links to its account, account_parts apart. @param states their blocks
    void book_kinetic(const double* states, int links, Account* accounts) const noexcept;
    /// Depth of the four tips of one link, whatever their phase. `state` is the link's block; with rigid pins one more lies before it and
    /// two behind (NeighbourWindow).
    /// @param slip whether slip is computed: only the phases stick and slip need it
    void probe(const double* state, const SheaveMotion* sheaves, bool slip, TipProbe& probe) const noexcept {
        probe_links(state, 1, sheaves, slip, &probe);
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
