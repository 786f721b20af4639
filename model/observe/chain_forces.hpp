#pragma once
/// Forces inside the chain at one instant: what each tip, plate, joint and pin half carries. (model/EQUATIONS.md section 9)

#include <vector>

#include "model/variator/chain_model.hpp"

namespace cvtflow::model {

struct ChainForces {
    std::vector<double> tip_normal;  ///< [4 links] N of the contact [N]
    std::vector<double>
        tip_tangential;               ///< [4 links] of the tip on its sheave, in the sense of positive rotation about the shaft's axis [N]
    std::vector<double> tip_radial;   ///< [4 links] of the tip on its sheave, away from the shaft's axis [N]
    std::vector<double> tip_sliding;  ///< [4 links] speed along its sheave's surface [m/s]
    std::vector<double> tip_power;    ///< [4 links] lost by friction [W]
    std::vector<double> tip_radius;   ///< [4 links] of its contact about the shaft's axis [m]
    std::vector<double> plate_tension;   ///< [plates_per_link links] elastic and damping tension; link by link [N]
    std::vector<double> joint_normal;    ///< [links] pressing of the two halves of a pin on one another [N]
    std::vector<double> joint_friction;  ///< [links] along the rolling profile, on the front half of the link before [N]
    std::vector<double> joint_axial;     ///< [links] friction along the pin, on the front half of the link before [N]
    std::vector<double> bending_travel;  ///< [2 links] bending moment in the middle of a half, in the direction of travel [N·m]
    std::vector<double> bending_height;  ///< [2 links] the same along the link's height [N·m]
    std::vector<double> half_axial;      ///< [2 links] axial force of a half, tension is positive [N]
    int plates_per_link = 0;             ///< as they are resolved: each, or lumped
};

/// Plates of a link as they are resolved.
[[nodiscard]] int plates_per_link(const ChainModel& chain) noexcept;

/// Evaluates all of them. Serial, about the work of an evaluation of the chain.
/// @param sheaves [4], unused without pulleys   @param forces memory of the last call is used again
void observe_forces(const ChainModel& chain, const double* state, const SheaveMotion* sheaves, const Phase* phases, ChainForces& forces);

}  // namespace cvtflow::model
