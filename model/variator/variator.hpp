#pragma once
/// The whole variator: chain and pulleys, and how they meet. Links are evaluated in ranges; the pulleys close an evaluation. Chains and
/// their friction are made here with the kernels of an instruction set.

#include <vector>

#include "model/basis/columns.hpp"
#include "model/chain/chain_model.hpp"
#include "model/force/pulley.hpp"
#include "model/kernels/available_isas.hpp"

namespace cvtflow::model {

class FrictionOperator;

/// @param isa which kernels run; results do not depend on it
/// @throws std::invalid_argument if the instruction set is not compiled in
[[nodiscard]] ChainModel make_chain(const Parameters& parameters, Isa isa = chosen_isa());

/// Friction of a chain, which must outlive it, with the kernels of the chain's instruction set.
[[nodiscard]] FrictionOperator make_friction(const ChainModel& chain);

/// Links whose reactions are added up together.
inline constexpr int links_per_sum = 4;

/// Reactions of a group of links on the sheaves of a shaft.
struct SheaveSum {
    SheaveLoad load{};
    int shaft = 0;      ///< shaft of the first link that touches
    bool both = false;  ///< some links touch the other shaft: another sum has their reactions
};

class Variator {
public:
    /// @param isa which kernels run; results do not depend on it
    explicit Variator(const Parameters& parameters, Isa isa = chosen_isa()) : chain_(make_chain(parameters, isa)), pulleys_(parameters) {}

    /// Whether they differ in nothing but inputs, control's gains and what else can change without another machine.
    [[nodiscard]] static bool same_machine(const Parameters& a, const Parameters& b);
    /// Becomes the variator of other parameters, inputs released. Allocates nothing if the machine stays the same: chain, detail, pulleys'
    /// geometry.
    /// @param before its parameters so far
    void adopt(const Parameters& before, const Parameters& parameters);

    [[nodiscard]] const ChainLayout& layout() const noexcept { return chain_.layout(); }
    [[nodiscard]] const ChainModel& chain() const noexcept { return chain_; }
    [[nodiscard]] const PulleyModel& pulleys() const noexcept { return pulleys_; }

    /// Puts values in place of the inputs' tables; between steps only.
    void hold(const HeldInputs& held) noexcept { pulleys_.torques().hold(held); }
    /// ChainModel::warm(). temperature [K]
    void warm(const Parameters& parameters, double temperature) noexcept { chain_.warm(parameters, temperature); }
    /// Couplings and hydraulics take over (ShaftTorques::couple). t [s], tail [unknowns behind the links]
    void couple(double t, const double* tail) noexcept { pulleys_.torques().couple(t, tail); }

    /// Groups of links whose reactions are summed first, so that sums do not depend on segments.
    [[nodiscard]] int sums() const noexcept { return (layout().links + links_per_sum - 1) / links_per_sum; }
    /// Reactions of the links of one group, in the order of their numbers. phases, loads: of all links   @param other those on the
    /// other shaft, written only if links touch both
    void add_up(int group, const Phase* phases, const LinkLoad* loads, SheaveSum& sum, SheaveSum& other) const noexcept;
    /// Forces of the chain on the sheaves from the sums of all groups, in their order. Sums of groups that touch nowhere are not read:
    /// another processor may have written them. phases: of all links, as for add_up()   @param sums [2 sums()], of other shafts behind
    [[nodiscard]] SheaveForces sheave_forces(const Phase* phases, const SheaveSum* sums) const noexcept;
    /// Forces of the chain on the sheaves from the links' reactions.
    [[nodiscard]] SheaveForces sheave_forces(const Phase* phases, const LinkLoad* loads) const noexcept;

    /// Slope of everything behind the links (pulleys, control, ledger). `tail` and `tail_slope` begin at pulley_begin().
    /// `accounts` ([links * account_parts], from observed_slopes) is read only with a ledger.
    void close(double t, const double* tail, const SheaveForces& chain, const Account* accounts, double* tail_slope) const noexcept;

private:
    ChainModel chain_;
    PulleyModel pulleys_;
};

/// Memory of one serial evaluation.
struct EvaluationScratch {
    explicit EvaluationScratch(const ChainLayout& layout);
    LineVector<double> window;
    std::vector<LinkLoad> loads;
    std::vector<Account> accounts;
    SheaveMotion sheaves[4]{};
};

/// Copies a whole state into the scratch window: all links, with the layout's halo on each side. state [unknowns]
void fill_window(const Variator& variator, const double* state, EvaluationScratch& scratch) noexcept;

/// dy/dt at (t, state) with frozen phases: plain serial evaluation with the production kernels. state, slope: [layout.size()].
void right_hand_side(const Variator& variator, double t, const double* state, const Phase* phases, double* slope,
                     EvaluationScratch& scratch) noexcept;

}  // namespace cvtflow::model
