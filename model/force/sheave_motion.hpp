#pragma once
/// Position and motion of a sheave: all that a tip needs to know of the pulleys, elastic or rigid.

namespace cvtflow::model {

struct SheaveMotion {
    double x, y, z;                 ///< O, centre of the flank plane, displaced [m]
    double tilt_x, tilt_y;          ///< τ [rad]
    double vx, vy, vz;              ///< [m/s]
    double spin_x, spin_y, spin_z;  ///< τ_x', τ_y', φ' [rad/s]
};

/// Forces of a link's tips on the two sheaves of its pulley; index 0 is the sheave at -z.
struct SheaveLoad {
    double fx[2], fy[2], fz[2];  ///< [N]
    double mx[2], my[2], mz[2];  ///< generalized, on τ_x, τ_y, φ [N·m]
};

}  // namespace cvtflow::model
