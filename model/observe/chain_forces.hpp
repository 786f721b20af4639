#pragma once
/// Forces inside the chain at one instant: those of each tip, plate, joint and pin half. (model/EQUATIONS.md section 9)

#include <array>
#include <vector>

#include "model/chain/chain_model.hpp"
#include "model/machine/coefficients.hpp"
#include "model/rigid/rigid_chain.hpp"

namespace cvtflow::model {

struct ChainForces {
    std::vector<double> tip_normal;      ///< [4 links] normal force [N]
    std::vector<double> tip_tangential;  ///< [4 links] force of the tip on its sheave along positive rotation about the shaft's axis [N]
    std::vector<double> tip_radial;      ///< [4 links] force of the tip on its sheave away from the shaft's axis [N]
    std::vector<double> tip_sliding;     ///< [4 links] speed along its sheave's surface [m/s]
    std::vector<double> tip_power;       ///< [4 links] power lost by friction [W]
    std::vector<double> tip_radius;      ///< [4 links] distance of the contact from the shaft's axis [m]
    std::vector<double> plate_tension;   ///< [plates_per_link links] elastic and damping tension; link by link [N]
    std::vector<double> joint_normal;    ///< [links] normal force between the two halves of a pin [N]
    std::vector<double> joint_friction;  ///< [links] friction along the rolling profile, on the front half of the link before [N]
    std::vector<double> joint_axial;     ///< [links] friction along the pin, on the front half of the link before [N]
    std::vector<double> bending_travel;  ///< [2 links] bending moment in the middle of a half, in the direction of travel [N·m]
    std::vector<double> bending_height;  ///< [2 links] bending moment in the middle of a half, along the link's height [N·m]
    std::vector<double> half_axial;      ///< [2 links] axial force of a half, tension is positive [N]
    int plates_per_link = 0;             ///< plates as resolved: each, or lumped
};

/// Number of plates of a link as resolved.
[[nodiscard]] int plates_per_link(const ChainModel& chain) noexcept;

/// Forces of halves. Serial. state [unknowns]
/// @param contacts results of ChainModel::observed_slopes for that state [links]   @param forces reuses its memory
void observe_forces(const ChainModel& chain, const double* state, const LinkContact* contacts, ChainForces& forces);
/// Forces of rigid pins.
template <class Real>
void observe_forces(const ChainModel& chain, const RigidInstantOf<Real>& now, ChainForces& forces);

/// Layout of the states that halves_of() writes.
[[nodiscard]] ChainLayout halves_layout(ChainLayout layout) noexcept;

/// Writes the links of a state as those of halves, in halves_layout(); copies them where pins are halves. state, halves [unknowns]
void halves_of(const Coefficients& coefficients, const double* state, std::vector<double>& halves);

}  // namespace cvtflow::model
