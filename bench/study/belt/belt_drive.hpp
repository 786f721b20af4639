#pragma once
/// Both pulleys of the belt theory (belt_arc.hpp): a variator at a ratio, with its clamping force and load, or shifting.

#include <array>

#include "bench/study/belt/belt_arc.hpp"

namespace cvtflow::bench {

/// Operating point.
struct BeltPoint {
    double ratio;         ///< driven over driving radius
    double clamping;      ///< S_2 [N]
    double torque;        ///< of the load on the driven shaft [N·m]
    double speed;         ///< of the driving shaft [rad/s]
    double growth = 0.0;  ///< of the driving radius, dR_1/dt [m/s]
};

/// Result of the theory.
struct BeltDrive {
    std::array<BeltPulley, 2> pulley;
    std::array<BeltArc, 2> arc;
    double tight, slack;  ///< tensions [N]
    double thrust_ratio;  ///< S_1/S_2
    double slip;          ///< by friction, as the channel friction_slip (model/EQUATIONS.md, section 9)
    double shift;         ///< d ln(ratio)/dt [1/s]
};

/// Radii of a belt as long as the chain on those centres: {R_1, R_2} [m].
[[nodiscard]] std::array<double, 2> belt_radii(const model::Parameters& p, double ratio);

/// 2 μ S_2 R_2/cos β: friction of all contacts along the circumference [N·m].
[[nodiscard]] double belt_torque_limit(const model::Parameters& p, const BeltPoint& point);

/// Throws std::domain_error where a pulley cannot carry the load.
[[nodiscard]] BeltDrive solve_belt(const model::Parameters& p, const BeltPoint& point, const BeltParts& parts = {});

}  // namespace cvtflow::bench
