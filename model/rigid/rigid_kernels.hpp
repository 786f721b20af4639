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

/// Functions over columns of all pins, in doubles of an instant, in floats of a step (rigid_step_kernels.cpp). Each renews the copies of
/// neighbours that it or the next one reads.
template <class Real>
struct RigidKernels {
    using Columns = RigidColumnsOf<Real>;

    // The parts of a step, in order. With a step of zero: forces of the velocities as they are.

    /// Moves coordinates by velocities over the step; then forces of links, bending and rolling of pins, filter of the waves, guides.
    void (*links)(const RigidCoefficients& c, const RigidKick& kick, Columns& columns, Account& account) noexcept;
    /// Normal forces of the tips, and their forces along the pins with the friction of the last step. The arguments but the last must live
    /// until `rub`. @param sheaves [4]
    void (*press)(const RigidCoefficients& c, const SheaveMotion* sheaves, const RigidKick& kick, Columns& columns) noexcept;
    /// Friction of plates along the pins, which lengthen at the same time, and of the halves of a pin on each other.
    void (*plates)(const RigidCoefficients& c, const RigidKick& kick, Columns& columns, Account& account) noexcept;
    /// Friction of the tips that press() found, and the sums of their forces.
    void (*rub)(const RigidCoefficients& c, Columns& columns, RigidReaction& reaction, Account& account) noexcept;
    /// Friction of the halves of a pin on each other, after the tips; accelerations by the sum of all forces; then as `shift` over the
    /// step.
    double (*kick)(const RigidCoefficients& c, const RigidKick& kick, Columns& columns, Account& account) noexcept;

    // Between steps.

    /// Changes velocities by accelerations over a time [s]. @return ½ v·M v' of the pins' velocities before and after, which a leapfrog
    /// conserves in any linear oscillation [J]
    double (*shift)(const RigidCoefficients& c, double step, Columns& columns) noexcept;
    /// Depths of the tips of pins 0 … 7 [m]. @param depth [tips][8]
    void (*depths)(const RigidCoefficients& c, const SheaveMotion* sheaves, Columns& columns, Real* depth) noexcept;
    /// Number of tips that began or ceased to press; those of pins that fill the last vector count.
    double (*contact_changes)(const Columns& columns) noexcept;
    /// Sums over pins and tips. @param lead time by which velocities are ahead of coordinates [s]
    void (*observe)(const RigidCoefficients& c, double lead, const Columns& columns, RigidSums& sums) noexcept;
};

}  // namespace cvtflow::model
