#pragma once
/// Constants of friction, derived once from a chain, in the precision of the velocities.

#include <array>
#include <memory>

#include "model/chain/chain_model.hpp"

namespace cvtflow::model {

/// Inverse of a mass matrix of a link, by its symmetries: both ends are alike, and so are both halves of the pins' length.
/// [[a, b], [b, a]] acts on the sum of both ends as a + b and on their difference as a - b; modes of even and of odd order do not couple.
template <class Number>
struct MirroredInverseOf {
    std::array<Number, max_lateral * max_lateral> sum{}, difference{};  ///< (a ± b)/2, rows max_lateral apart; where m + k is odd: 0
};
using MirroredInverse = MirroredInverseOf<double>;

/// Slower sliding counts as this in single precision: its square is still a float, and so is one over it [m/s].
inline constexpr double slowest_single = 1e-15;

/// Constants of friction in the precision of its velocities.
template <class Number>
struct FrictionNumbers {
    explicit FrictionNumbers(const ChainModel& chain);

    FrictionCurve joint, plate, tip;
    std::shared_ptr<const TipLaw> tip_law;                                       ///< nullptr: none
    std::array<Number, max_joint_lanes> joint_position{};                        ///< ξ [1]
    std::array<std::array<Number, max_joint_lanes>, max_lateral> joint_basis{};  ///< P_m(ξ)
    std::array<Number, max_plate_lanes> plate_position{};                        ///< ξ [1]
    MirroredInverseOf<Number> lateral, axial;                                    ///< of x, and of y; of z and e
};

}  // namespace cvtflow::model
