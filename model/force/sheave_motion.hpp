#pragma once
/// Where a sheave is and how it moves: all that a tip needs to know of the pulleys, elastic or rigid.

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

    /// A force [N] on the sheave of a side, at an arm from its origin [m].
    void add(int side, double x, double y, double z, double arm_x, double arm_y, double arm_z) noexcept {
        fx[side] += x;
        fy[side] += y;
        fz[side] += z;
        mx[side] += arm_y * z - arm_z * y;
        my[side] += arm_z * x - arm_x * z;
        mz[side] += arm_x * y - arm_y * x;
    }
};

}  // namespace cvtflow::model
