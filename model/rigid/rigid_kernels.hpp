#pragma once
/// The loops over rigid pins: one set of functions per instruction set, with the same bits for all. (model/EQUATIONS.md section 11)

#include <array>

#include "model/basis/isa.hpp"
#include "model/force/account.hpp"
#include "model/force/pulley.hpp"
#include "model/rigid/rigid_coefficients.hpp"

namespace cvtflow::model {

/// Share of a step at whose velocities friction acts: ½ would take friction and velocities at one time, but leaves no damping of what
/// friction couples and the solution does not know; with 0.55 machines with stiff sheaves gain energy.
inline constexpr double friction_time = 0.7;

/// Step of the implicit friction [s]; zero: friction of the velocities as they are.
struct RigidKick {
    double step = 0.0;
    [[nodiscard]] constexpr bool implicit() const noexcept { return step > 0.0; }
    /// Time from the velocities before a step to those whose friction acts in it [s].
    [[nodiscard]] constexpr double until_friction() const noexcept { return friction_time * step; }
};

/// Reactions on the sheaves, extreme depths and radii (for faults).
struct RigidReaction {
    SheaveForces sheaves{};
    double deepest = -1e300;    ///< depth of a tip [m]
    double innermost = 1e300;   ///< radius of a pin, to 0.1 mm [m]
    double outermost = -1e300;  ///< radius of a pin that touches, to 0.1 mm [m]
};

/// Sums for an observation. Pairs: of pins at the driving and the driven shaft, or of links in the strand at y ≥ 0 and at y < 0.
struct RigidSums {
    double speed = 0.0;                    ///< speeds of all pins' middles in their plane [m/s]
    std::array<double, 2> radius{};        ///< distances of the pins between sheaves from the shaft's axis [m]
    std::array<double, 2> turning{};       ///< angular speeds of these pins about the axis [rad/s]
    std::array<double, 2> pins{};          ///< number of these pins
    std::array<double, 2> tension{};       ///< elastic tensions of the inner links of a strand [N]
    std::array<double, 2> links{};         ///< number of these links
    double touching = 0.0;                 ///< number of tips that press
    std::array<double, 2> hold{}, drag{};  ///< sums of Creep (model/observe/observation.hpp) [N·m·s], [N·m]
    double creep_power = 0.0;              ///< [W]
};

/// Each function reads and writes columns of all pins, and renews the copies of neighbours that it or the next one reads.
struct RigidKernels {
    /// Pitch lines by coordinates and velocities.
    void (*pitch_lines)(RigidColumns& columns) noexcept;
    /// Directions and offsets of the halves that roll on each other, from the pitch lines.
    void (*rolling_frames)(const RigidCoefficients& c, RigidColumns& columns) noexcept;
    /// Forces of links; adds energies and losses.
    void (*link_forces)(const RigidCoefficients& c, const RigidKick& kick, RigidColumns& columns, Account& account) noexcept;
    /// Bending of the pins, normal force and rolling resistance of their joints, and A g of the links' forces.
    void (*joint_forces)(const RigidCoefficients& c, const RigidKick& kick, RigidColumns& columns, Account& account) noexcept;
    /// Sum of the links' forces on each pin, per coordinate.
    void (*sum_link_forces)(RigidColumns& columns) noexcept;
    /// Filters the waves of stretch and yaw, in a step.
    void (*filter_waves)(const RigidCoefficients& c, const RigidKick& kick, RigidColumns& columns, Account& account) noexcept;
    /// Adds the forces of guides to those on the pins.
    void (*guide)(const RigidCoefficients& c, const RigidKick& kick, RigidColumns& columns, Account& account) noexcept;
    /// Normal forces of the tips, and their forces along the pins with the friction of the last step. The arguments but the last must live
    /// until `rub`. @param sheaves [4]
    using Press = void (*)(const RigidCoefficients& c, const SheaveMotion* sheaves, const RigidKick& kick, RigidColumns& columns) noexcept;
    Press press, press_now;  ///< in a step; at velocities as they are
    /// Friction of plates along the pins, which lengthen at the same time, and of the halves of a pin on each other.
    void (*plate_friction)(const RigidCoefficients& c, const RigidKick& kick, RigidColumns& columns, Account& account) noexcept;
    /// Friction of the tips that press() found, and the sums of their forces.
    using Rub = void (*)(const RigidCoefficients& c, RigidColumns& columns, RigidReaction& reaction, Account& account) noexcept;
    Rub rub, rub_now;
    /// Friction of the halves of a pin on each other, after the tips.
    void (*joint_friction)(const RigidCoefficients& c, const RigidKick& kick, RigidColumns& columns, Account& account) noexcept;
    /// Accelerations by the sum of all forces, then as `kick` over the step.
    double (*accelerate)(const RigidCoefficients& c, const RigidKick& kick, RigidColumns& columns) noexcept;
    /// Moves coordinates by velocities over a time [s].
    void (*drift)(double step, RigidColumns& columns) noexcept;
    /// Changes velocities by accelerations over a time [s]. @return ½ v·M v' of the pins' velocities before and after, which a leapfrog
    /// conserves in any linear oscillation [J]
    double (*kick)(const RigidCoefficients& c, double step, RigidColumns& columns) noexcept;
    /// Depths of the tips of pins 0 … 7 [m]. @param depth [tips][8]
    void (*depths)(const RigidCoefficients& c, const SheaveMotion* sheaves, RigidColumns& columns, double* depth) noexcept;
    /// Number of tips that began or ceased to press; those of pins that fill the last vector count.
    double (*contact_changes)(const RigidColumns& columns) noexcept;
    /// Sums over pins and tips. @param lead time by which velocities are ahead of coordinates [s]
    void (*observe)(const RigidCoefficients& c, double lead, const RigidColumns& columns, RigidSums& sums) noexcept;
};

}  // namespace cvtflow::model
