#pragma once
/// Rigid pins, written a second time and plainly: energies, deflections and sliding velocities as functions of coordinates, whose
/// derivatives are differences. (model/EQUATIONS.md section 11)

#include <vector>

#include "model/parameters/parameters.hpp"

namespace cvtflow::model::test {

/// The same machine with rigid pins.
[[nodiscard]] Parameters with_rigid_pins(Parameters parameters);

/// Accelerations of all coordinates and the powers of an instant.
struct PlainMotion {
    std::vector<double> acceleration;  ///< [5 pins + pulleys]
    double energy = 0.0;               ///< potential, without that of supports [J]
    double lost = 0.0;                 ///< by the chain [W]
};

/// Forces of the chain alone: no springs, dampers and inputs of the pulleys.
/// @param coordinates, velocities [5 pins + pulleys]: x…, y…, z…, p…, q…, pulleys
/// @param inertia [pulleys]
[[nodiscard]] PlainMotion plain_motion(const Parameters& parameters, const std::vector<double>& coordinates,
                                       const std::vector<double>& velocities, const std::vector<double>& inertia);

}  // namespace cvtflow::model::test
