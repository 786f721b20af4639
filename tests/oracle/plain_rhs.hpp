#pragma once
/// The whole right-hand side of model/EQUATIONS.md: plain, slow, and independent of the production kernels.
/// It shares with model/ only the parameters, time tables, the ramp and the state layout.

#include "model/parameters/chain_layout.hpp"
#include "model/parameters/parameters.hpp"
#include "tests/oracle/vectors.hpp"

#include <array>
#include <span>
#include <vector>

namespace cvtflow::oracle {

template <class Number>
struct PowersOf {
    std::array<Number, model::loss_kinds> losses{};  ///< dissipated, by model::Loss [W]
    std::array<Number, model::work_kinds> works{};   ///< put in from outside, by model::Work [W]
};

template <class Number>
struct EnergiesOf {
    Number kinetic{};   ///< [J]
    Number inner{};     ///< extension and bending of halves [J]
    Number pack{};      ///< bending, shear and torsion of plate packs [J]
    Number plates{};    ///< [J]
    Number joints{};    ///< rolling contact and opening [J]
    Number tips{};      ///< [J]
    Number supports{};  ///< bearings and attachments [J]

    [[nodiscard]] Number potential() const { return inner + pack + plates + joints + tips + supports; }
};

/// `forces`: generalized forces of all coordinates, links' then pulleys', in the order of q [N, N·m], before the inertia solve.
template <class Number>
struct ResultOf {
    std::vector<Number> slope;
    PowersOf<Number> powers;
    EnergiesOf<Number> energies;
    std::vector<Number> forces;
};

using Powers = PowersOf<double>;
using Energies = EnergiesOf<double>;
using Result = ResultOf<double>;

/// Angles of the far ends of both shafts at t = 0 where couplings have taken over there: those at which no torque jumps [rad].
struct FarEnds {
    std::array<Real, 2> angle{};
};
FarEnds far_ends(const model::Parameters& parameters, std::span<const double> state, std::span<const model::Phase> phases);

/// `phases`: one per tip (model::tips_per_link per link); ignored when pulleys are absent.
/// `far`: none: couplings have not taken over.
Result right_hand_side(const model::Parameters& parameters, double t, std::span<const double> state, std::span<const model::Phase> phases,
                       const FarEnds* far = nullptr);

/// Right-hand side with the oracle's full precision, for numerical derivatives. Skips the inertia solve (slope left empty) on request.
ResultOf<Real> exact_right_hand_side(const model::Parameters& parameters, double t, std::span<const Real> state,
                                     std::span<const model::Phase> phases, bool with_slope = true, const FarEnds* far = nullptr);

}  // namespace cvtflow::oracle
