#pragma once
/// The theory of a belt. One pulley: a continuous belt with Coulomb friction in two directions between sheaves that tilt (Carbone,
/// Mangialardi, Mantriota 2005), here with the compliance of belt and pins. Equations: docs/validation.md. It shares with the model of the
/// chain only parameters and the curve of friction over the sliding speed. Both pulleys: a variator at a ratio, with its clamping force and
/// load, or shifting.

#include <array>
#include <memory>
#include <vector>

#include "model/law/friction.hpp"
#include "model/parameters/parameters.hpp"

namespace cvtflow::tasks {

/// Parts of the theory that can be left out, to measure the effect of each.
struct BeltParts {
    bool tilting_sheaves = true;   ///< sheaves tilt about the shaft: the groove opens as a sine over the arc
    bool yielding_pins = true;     ///< pins shorten and tips flatten under their axial force
    bool stretching_belt = true;   ///< plates and joints stretch
    bool crowned_flank = true;     ///< the flank's angle depends on the radius
    bool saturation_speed = true;  ///< friction grows over tip.friction.saturation_speed; without: a thousandth of that speed
    double vibration = 0.0;        ///< standard deviation of the pins' velocity across, which friction averages over [m/s]
    int nodes = 400;               ///< number per arc; at most 96 under a law of friction over the speed
};

/// A pulley that runs at constant radius, or whose radius grows.
struct BeltPulley {
    double radius;        ///< R [m]
    double wrap;          ///< α [rad]
    double speed;         ///< ω [rad/s]
    double growth = 0.0;  ///< dR/dt [m/s]
};

/// Values at an angle after the entry.
struct BeltNode {
    double angle;          ///< θ [rad]
    double tension;        ///< tension of the belt, centrifugal part included [N]
    double axial;          ///< s: axial force on one sheave per angle [N/rad]
    double inset;          ///< radius minus R [m]
    double along, across;  ///< sliding speed of the belt against the sheaves along the circumference, and outwards along the flank [m/s]
    double friction_per_speed;  ///< [N·s/(m·rad)]
};

/// Quantities of an arc that satisfies its boundary conditions.
struct BeltArc {
    std::vector<BeltNode> nodes;
    double clamping;             ///< S [N]
    double torque;               ///< torque of the belt on the pulley [N·m]
    double friction_speed;       ///< Ω°: speed of the pulley at which the same pins put no torque on it [rad/s]
    double sliding_power = 0.0;  ///< power lost by friction [W]
};

/// One pulley's equations.
class BeltArcSolver {
public:
    BeltArcSolver(const model::Parameters& p, const BeltPulley& pulley, const BeltParts& parts);

    /// Arc whose tension changes from `entry` to `exit` [N]. Throws std::domain_error where friction cannot carry that difference.
    [[nodiscard]] BeltArc between(double entry, double exit) const;
    /// Arc with this clamping force [N] whose tension grows by `difference` [N] (falls, if negative). Throws std::domain_error likewise.
    [[nodiscard]] BeltArc clamped(double clamping, double difference) const;

private:
    /// Entry tension [kN], creep against the pulley [1e-3], tilting moments over R towards the middle of the arc and 90° further [kN].
    struct Unknowns {
        double entry, creep, middle, side;
    };
    struct Sums {
        double clamping, difference, middle, side;  ///< [N]
    };
    /// Conditions of an arc: entry tension or clamping force, and difference of tensions [N].
    struct Ends {
        double first, difference;
        bool entry_given;
    };
    /// Forces per angle: friction along the circumference [N/rad], axial force on one sheave [N/rad], friction over sliding speed
    /// [N·s/(m·rad)].
    struct Contact {
        double along, axial, per_speed;
    };

    [[nodiscard]] double yielding_inset(double axial) const;
    [[nodiscard]] double coefficient(double speed) const;
    [[nodiscard]] Contact contact(double reduced, double along, double across, double pace) const;
    Sums sweep(const Unknowns& u, std::vector<BeltNode>* nodes) const;
    [[nodiscard]] Unknowns guess(const Ends& ends) const;
    [[nodiscard]] Unknowns converge(Unknowns u, const Ends& ends) const;
    [[nodiscard]] BeltArc arc(const Ends& ends) const;

    BeltPulley pulley_;
    double friction_, saturation_, sin_, cos_;
    std::shared_ptr<const model::TipLaw> law_;  ///< law of friction over the sliding speed; null: constant

    double weight_;   ///< mass per length times the square of the speed: centrifugal tension [N]
    double stretch_;  ///< strain per tension [1/N]
    double tilt_;     ///< inset per tilting moment over R [m/N]
    double hertz_;    ///< Hertz stiffness of a tip [N/m^1.5]
    double bar_;      ///< compliance of a half along its axis [m/N]
    double share_;    ///< angle of half a pin [rad]
    double vibration_;
    bool yielding_;
    int count_;
};

/// Operating point.
struct BeltPoint {
    double ratio;         ///< driven over driving radius
    double clamping;      ///< S_2 [N]
    double torque;        ///< torque of the load on the driven shaft [N·m]
    double speed;         ///< speed of the driving shaft [rad/s]
    double growth = 0.0;  ///< growth of the driving radius, dR_1/dt [m/s]
};

/// Result of the theory.
struct BeltDrive {
    std::array<BeltPulley, 2> pulley;
    std::array<BeltArc, 2> arc;
    double tight, slack;  ///< tensions [N]
    double thrust_ratio;  ///< S_1/S_2
    double slip;          ///< slip by friction, as the channel friction_slip (model/EQUATIONS.md, section 9)
    double shift;         ///< d ln(ratio)/dt [1/s]
};

/// Radii of a belt as long as the chain on those centres: {R_1, R_2} [m].
[[nodiscard]] std::array<double, 2> belt_radii(const model::Parameters& p, double ratio);

/// 2 μ S_2 R_2/cos β: friction of all contacts along the circumference [N·m].
[[nodiscard]] double belt_torque_limit(const model::Parameters& p, const BeltPoint& point);

/// Throws std::domain_error where a pulley cannot carry the load.
[[nodiscard]] BeltDrive solve_belt(const model::Parameters& p, const BeltPoint& point, const BeltParts& parts = {});

}  // namespace cvtflow::tasks
